// Free motion as a table of attitudes: what a TargetMotion shares with its copies. Where estimates
// follow each other, one table takes them in turn, without allocation.
#pragma once

#include <vector>

#include <stillbase/target/prediction.hpp>

#include "target/rotation_series.hpp"

namespace stillbase {

/// Free motion of a body from an estimate, within a horizon on either side of it.
struct MotionTable {
  TargetBody body;
  /// Rotation between nodes, rad. With a step of order 8 the local error is below the rounding
  /// error.
  double angle_per_node = 0.05;

  TargetState estimate = {};
  double horizon = 0;  ///< s
  /// At estimate.time + (i - middle) * spacing; empty when the rate is constant in N.
  std::vector<Eigen::Quaterniond> nodes = {};
  std::vector<RotationSeries> series = {};  ///< at the nodes, after expand()
  double spacing = 0;
  int middle = 0;
  Vector3d constant_rate = Vector3d::Zero();     ///< in N
  Matrix3d inverse_inertia = Matrix3d::Zero();   ///< in T
  Vector3d angular_momentum = Vector3d::Zero();  ///< in N

  /// Takes an estimate. No allocation where reserve() had as much rotation as the horizon has.
  /// @throws std::invalid_argument as TargetMotion; the table is then as it was
  void restart(const TargetState& from, double new_horizon);
  /// Makes series of the nodes, unless there are very many. One costs as much as a few calls of
  /// state() without it, which then are cheap.
  void expand();
  /// Room for a rotation (rad) by largest_rate() within the horizon.
  void reserve(double rotation);
  /// Bound of |omega| over all times, rad/s: I_min |omega|^2 <= omega' I omega, twice the energy.
  double largest_rate(const TargetState& from) const;

  /// @throws std::out_of_range outside the horizon
  TargetState state(double time) const;
  ContactState contact(const ContactFeature& feature, double time) const;

 private:
  Eigen::Quaterniond orientation(double dt) const;
  Vector3d angular_velocity(const Eigen::Quaterniond& q) const;
};

/// The state of an estimate with an error put on it: with_error() without its body.
TargetState with_error(const TargetState& estimate, const EstimateVector& error);

}  // namespace stillbase
