// Largest value of a convex quadratic over the unit ball: the trust-region problem turned round.
#pragma once

#include <vector>

#include <stillbase/core/types.hpp>

namespace stillbase {

/// The local maxima of 1/2 s' P s + q' s over |s| <= 1, P positive semidefinite, the largest first.
///
/// All are on the sphere, where (mu E - P) s = q. The global maximum has mu >= lambda_max(P); at
/// most one other has a mu between the two largest eigenvalues (Martinez, "Local minimizers of
/// quadratic functions on Euclidean balls and spheres", 1994). In the hard case, q normal to the
/// eigenvectors of lambda_max and the rest of s shorter than one, both lie at mu = lambda_max: s
/// and its reflection are equal maxima (of an eigenspace of more dimensions two of many).
/// @return one or two unit vectors; any one where P and q vanish
std::vector<Vector6d> maxima_over_ball(const Matrix6d& P, const Vector6d& q);

}  // namespace stillbase
