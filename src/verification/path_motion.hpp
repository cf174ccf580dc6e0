// Motion of joints and base along an approach as stored: cubic Hermite segments between samples,
// and the base pose integrated from the momentum equation by `reference`.
#pragma once

#include <cstddef>

#include <stillbase/plan/plan.hpp>

namespace stillbase::verification {

/// One segment, read as a polynomial phi(s) = a + b s + c s^2 + d s^3, s = t - t0 in [0, h].
class HermiteSegment {
 public:
  /// Between the samples i and i + 1.
  HermiteSegment(const Approach& approach, std::size_t i);

  double begin() const { return t0_; }
  double duration() const { return h_; }
  Eigen::VectorXd position(double s) const { return a_ + s * (b_ + s * (c_ + s * d_)); }
  Eigen::VectorXd velocity(double s) const { return b_ + s * (2 * c_ + 3 * s * d_); }
  Eigen::VectorXd acceleration(double s) const { return 2 * c_ + 6 * s * d_; }

  /// Exact extremes over the segment, per joint.
  struct Extremes {
    Eigen::VectorXd lowest, highest;  ///< position
    Eigen::VectorXd rate;             ///< largest |velocity|
    Eigen::VectorXd acceleration;     ///< largest |acceleration|: at an end, as it is linear
  };
  Extremes extremes() const;

 private:
  double t0_, h_;
  Eigen::VectorXd a_, b_, c_, d_;
};

/// Base velocity of a robot without momentum: Omega = -H_b^-1 H_bphi phidot.
Vector6d drifting_base_velocity(const RobotModel& robot, const Eigen::VectorXd& phi,
                                const Eigen::VectorXd& phidot);

/// Pose of the base after [s0, s1] of a segment, from the pose at s0. Classical Runge-Kutta on
/// position and Euler parameters, in equal steps of at most a quarter of the segment, within which
/// no joint moves further than `max_travel` (rad or m).
Pose drifted_base(const RobotModel& robot, const HermiteSegment& segment, double s0, double s1,
                  const Pose& from, double max_travel);

}  // namespace stillbase::verification
