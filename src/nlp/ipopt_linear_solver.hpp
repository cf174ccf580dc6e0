// A linear solver of our own behind Ipopt.
//
// Ipopt (3.11, as Debian builds it) takes routines of HSL's MA27 from outside, by HSLLoader.h.
// These have the calls of MA27 and factorise densely (dense_ldl.hpp): the systems of a capture
// problem have some tens of rows, for which MUMPS spends its time on bookkeeping. They keep nothing
// between calls but in Ipopt's own arrays.
#pragma once

namespace stillbase::nlp {

/// Whether Ipopt's "ma27" is ours, from now on in this process. Not where this release of Ipopt
/// takes none, or where the program has loaded an MA27 before.
bool provides_linear_solver();

}  // namespace stillbase::nlp
