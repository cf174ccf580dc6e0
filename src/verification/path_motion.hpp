// Motion of joints and base along an approach as stored: cubic Hermite segments between samples,
// and the base pose integrated from the momentum equation by `reference`.
#pragma once

#include <cstddef>
#include <vector>

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
  /// Largest |velocity| within [s0, s1], exact, per joint.
  Eigen::VectorXd peak_rates(double s0, double s1) const;

 private:
  double t0_, h_;
  Eigen::VectorXd a_, b_, c_, d_;
};

/// Base velocity per joint rate of a robot without momentum, -H_b^-1 H_bphi, 6 x n.
Eigen::MatrixXd base_response(const RobotModel& robot, const Eigen::VectorXd& phi);

/// Base velocity of a robot without momentum: Omega = -H_b^-1 H_bphi phidot.
Vector6d drifting_base_velocity(const RobotModel& robot, const Eigen::VectorXd& phi,
                                const Eigen::VectorXd& phidot);

/// Motion of the base along one segment.
class BaseTrack {
 public:
  /// A base that is held.
  BaseTrack(const HermiteSegment& segment, const Pose& held);
  /// A base that floats without momentum. Classical Runge-Kutta on position and Euler parameters,
  /// in equal steps of at most a quarter of the segment, within which no joint moves further than
  /// `max_travel` (rad or m).
  /// @throws std::invalid_argument for more than 10 000 steps
  BaseTrack(const RobotModel& robot, const HermiteSegment& segment, const Pose& from,
            double max_travel);

  /// At s in [0, h] of the segment: between steps the cubic through poses and their rates, whose
  /// error is of the order of that of a step.
  Pose pose(double s) const;

  /// How far the base may move in N.
  struct Travel {
    double translation = 0;  ///< of B's origin, m
    double rotation = 0;     ///< rad
  };
  /// Bound on the motion from any instant of [s0, s1] during which joint k moves by `travel[k]` at
  /// most: the sum of these times the largest response of the base at the steps in and around the
  /// interval, and a tenth. From one step to the next the response changes by less than that.
  Travel bound(double s0, double s1, const Eigen::VectorXd& travel) const;

 private:
  struct Node {
    Pose pose;
    Vector3d velocity;          ///< d/ds of the position
    Eigen::Vector4d spin;       ///< d/ds of the Euler parameters
    Eigen::Matrix2Xd response;  ///< norms of its linear and angular parts, per joint
  };
  double index(double s) const;  ///< s in steps, within [0, last]

  double step_;
  std::vector<Node> nodes_;
};

/// Pose of the base after a segment, from the pose at its begin: see BaseTrack.
Pose drifted_base(const RobotModel& robot, const HermiteSegment& segment, const Pose& from,
                  double max_travel);

}  // namespace stillbase::verification
