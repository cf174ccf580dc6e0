// Measures over the residual velocity by this room's formulas: the quadratic form |y|^2 in the
// relative velocity by polarisation, the covariance by integrations of its own, the worst case with
// a bound that proves it.
#pragma once

#include "verification/recomputation.hpp"

namespace stillbase::verification {

/// The residual velocity at a configuration, and the objective as a function of the velocity.
struct ResidualCase {
  /// Vbar, nominal, [v; omega] of target less hand, at the hand, in B.
  Vector6d velocity = Vector6d::Zero();
  double size = 0;  ///< of the velocities of target and hand, of which Vbar is the difference
  Matrix6d covariance = Matrix6d::Zero();  ///< in B
  double deviations = 0;                   ///< k
  /// Probability of a negative closing speed; a latch that moves along has hold of the target.
  double separating = 0;
  /// |y|^2 = V' form V + 2 linear' V and a constant, y the terms of the objective below each other,
  /// for any V, also one that separates. Of a hand at rest the form alone.
  Matrix6d form = Matrix6d::Zero();
  Vector6d linear = Vector6d::Zero();
  double nominal = 0;  ///< |y|^2 at Vbar by the contact law itself: the form has its rounding

  double square(const Vector6d& V) const {
    const Vector6d d = V - velocity;
    return nominal + d.dot(form * d + 2 * slope(velocity));
  }
  /// Half the gradient of the square.
  Vector6d slope(const Vector6d& V) const { return form * V + linear; }
  /// E|y|^2 = |y|^2 at Vbar + tr(form Sigma).
  double mean_square() const { return nominal + (form * covariance).trace(); }
  /// Symmetric root of the covariance.
  Matrix6d root() const;
  /// Vbar + k root() s: the ellipsoid for |s| <= 1.
  Vector6d at(const Vector6d& s) const;
  /// Of V within the ellipsoid: at most 1. Directions without variance have none.
  double distance(const Vector6d& V) const;
};
/// @pre the problem states a residual velocity, and the event is complete
ResidualCase residual_case(const Situation& situation);

/// The largest |y|^2 over the ellipsoid: a place, and what no place exceeds.
struct LargestSquare {
  Vector6d velocity = Vector6d::Zero();  ///< where, in B
  double value = 0;                      ///< there
  double bound = 0;                      ///< of all others, by duality
};
LargestSquare largest_square(const ResidualCase& residual);

/// The local maxima of |y|^2 over the ellipsoid, each as s of ResidualCase::at(), the largest
/// first; perhaps saddles behind them.
std::vector<Vector6d> local_maxima(const ResidualCase& residual);
/// Whether |y|^2 falls clearly from a maximum s in all directions along the ellipsoid: equally bad
/// velocities that form a curve, or nearly do, have no gradient.
bool is_isolated(const ResidualCase& residual, const Vector6d& s);

}  // namespace stillbase::verification
