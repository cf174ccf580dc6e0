// How good a point is, computed without the solver that found it.
//
// Assumptions: those of problem.hpp. The residual is of first order: a saddle point or a maximum
// has residual zero as well; the reduced Hessian tells them apart. Constraint qualification is not
// checked; where it fails, a minimum may have a large residual.
#pragma once

#include <optional>
#include <stillbase/nlp/problem.hpp>

namespace stillbase::nlp {

struct CertificateOptions {
  /// A bound counts as active when x or g is within this of it (variables and constraints are of
  /// order one). Interior point methods stop at a distance of mu / multiplier, mu about 1e-11: 1e-6
  /// sees every bound whose multiplier exceeds 1e-5.
  double activity_tolerance = 1e-6;
  /// Also compute the reduced Hessian, where the problem has a Hessian: one call of
  /// lagrangian_hessian().
  bool second_order = false;
};

struct Certificate {
  /// max |grad f + J^T multipliers + bound_multipliers| / max(objective_scale, max |grad f|).
  double kkt_residual = kInfinity;
  /// Largest distance of any variable or constraint from its range, in its own unit.
  double max_violation = kInfinity;
  /// Largest |multiplier| times distance from the active bound.
  double complementarity = kInfinity;
  /// How far a violated point is from a local minimum of V = 1/2 sum violation^2 in the box:
  /// |projected grad V| / (|violation| |J of the violated rows|), in [0, 1]; 0 without violation.
  double violation_slope = 0.0;
  /// One per constraint (m): >= 0 where only the upper bound is active, <= 0 where only the lower
  /// one is, any sign for an equation, 0 where none is.
  Eigen::VectorXd multipliers;
  Eigen::VectorXd bound_multipliers;  ///< one per variable (N), same signs
  /// Smallest eigenvalue of Z' (Hessian of f + multipliers . g) Z, Z an orthonormal basis of the
  /// directions that keep every active constraint and bound to first order (rank by QR). Positive
  /// at a point with residual zero: a strict local minimum along them; negative: not a minimum.
  /// Empty when it was not asked for, the problem has no Hessian, it is not finite, or no direction
  /// is left.
  std::optional<double> reduced_hessian_min_eigenvalue;
};

/// KKT residual with multipliers by least squares under their sign conditions: equations are
/// projected out by a rank-revealing QR, the active inequalities solved by non-negative least
/// squares (Lawson and Hanson, Solving Least Squares Problems, 1974, algorithm NNLS).
/// x (N) and `at_x`, the problem's evaluate() there; all finite, else every number is infinite and
/// the multipliers are zero.
[[nodiscard]] Certificate certify(const Problem& problem, const Eigen::VectorXd& x,
                                  const Evaluation& at_x, const CertificateOptions& options = {});

/// The same with one evaluation of the problem at x.
[[nodiscard]] Certificate certify(const Problem& problem, const Eigen::VectorXd& x,
                                  const CertificateOptions& options = {});

/// min |A y - b| over y >= 0. A (r x k), b (r); returns y (k). Rank-deficient A is allowed.
[[nodiscard]] Eigen::VectorXd solve_nonnegative_least_squares(const Eigen::MatrixXd& A,
                                                              const Eigen::VectorXd& b);

}  // namespace stillbase::nlp
