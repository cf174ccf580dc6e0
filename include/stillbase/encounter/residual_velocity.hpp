// How well the relative velocity of target and hand is known at the contact.
//
// The covariance Sigma of V = [v; omega], target minus hand, at the hand's origin: stated, or that
// of the target's estimate carried to the contact plus the hand's tracking error. Measures need a
// square root L of it, L L' = Sigma, that is smooth in the contact time.
//
// Assumptions: the errors are Gaussian of mean zero; those of the hand are independent of those of
// the estimate, and the same along every axis. The nominal velocity Vbar is no part of this: it is
// that of the encounter, whatever target and hand do there.
#pragma once

#include <array>
#include <vector>

#include <stillbase/plan/problem.hpp>

namespace stillbase {

/// L over the window of contact times, in the axes of the target T.
///
/// A stated covariance has its symmetric root; one in N rotates with the target. A carried one has
/// its Cholesky factor, angular part first, a vanishing pivot giving a column of zeros. What
/// changes in time is a Chebyshev series whose last coefficients are below 1e-11 of the largest.
class ResidualRoot {
 public:
  /// @pre the problem states a residual velocity, and its impulse follows from the motion of its
  ///   target
  /// @throws std::invalid_argument when the target rotates too far to be predicted, or a carried
  ///   covariance is too close to a singular one to be followed over the window
  explicit ResidualRoot(const CaptureProblem& problem);

  /// L at a time of the window; its derivatives over time. @param order 0, 1 or 2
  Matrix6d at(double time, int order = 0) const;
  /// L s without the other entries of L.
  Vector6d applied(const Vector6d& s, double time, int order = 0) const;
  /// In T, m^2/s^2, m rad/s^2, rad^2/s^2.
  Matrix6d covariance(double time) const;

 private:
  double argument(double time) const;  ///< of the series, in [-1, 1]

  double middle_ = 0, half_ = 1;                 ///< of the window, s
  std::array<std::vector<Matrix6d>, 3> series_;  ///< Chebyshev coefficients of the derivatives
};

}  // namespace stillbase
