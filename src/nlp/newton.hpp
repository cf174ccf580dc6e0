// Newton's method on the first-order conditions, for the last digits of a minimum. A solver that
// compares values stops where they no longer change: at a distance of about the square root of
// their rounding.
#pragma once

#include <stillbase/nlp/certificate.hpp>

namespace stillbase::nlp {

struct NewtonOptions {
  int steps = 4;
  double finished = 1e-9;       ///< KKT residual after which no step follows
  double longest = 1e-2;        ///< step: farther away other bounds are active
  double difference = 1e-5;     ///< step of the differences, where there is no Hessian
  double flat = 1e-9;           ///< of the largest curvature: along less the point stays
  double max_violation = 1e-9;  ///< of a constraint at the end
};

/// The point of the smallest KKT residual on the way: x itself where no step lowers it, or where
/// the curvature along the active constraints is negative. Bounds with a multiplier stay active.
/// @param curved the functions are linear in the variables from this one on
[[nodiscard]] Eigen::VectorXd end_by_newton(const Problem& problem, const Eigen::VectorXd& x,
                                            Eigen::Index curved, const NewtonOptions& options = {});

}  // namespace stillbase::nlp
