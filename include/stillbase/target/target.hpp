// The tumbling object: a rigid body in free motion with contact features on its surface.
//
// Target frame T: origin at the centroid. Straight motion of the centroid in the inertial frame N,
// torque-free rotation (Euler's equations).
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <stillbase/robot/robot_model.hpp>

namespace stillbase {

/// A place that may be hit or grasped, fixed to the target.
struct ContactFeature {
  std::string name;
  Vector3d point = Vector3d::Zero();    ///< in T, m
  Vector3d normal = Vector3d::UnitX();  ///< outward unit normal in T
};

struct TargetShape {
  Pose pose;  ///< shape frame in T
  Geometry geometry;
};

struct TargetBody {
  std::string name;
  double mass = 0;                      ///< kg, > 0
  Matrix3d inertia = Matrix3d::Zero();  ///< about the centroid in T, kg m^2; zero for a point mass
  bool is_point_mass = false;
  std::vector<TargetShape> shapes;
  std::vector<ContactFeature> features;
};

/// Motion at one instant.
struct TargetState {
  double time = 0;                               ///< s
  Pose pose;                                     ///< T_NT
  Vector3d linear_velocity = Vector3d::Zero();   ///< of the centroid, in N, m/s
  Vector3d angular_velocity = Vector3d::Zero();  ///< in N, rad/s
};

/// A contact feature at one instant, in N, with time derivatives for the search.
struct ContactState {
  Vector3d point, normal, velocity;  ///< m, unit, m/s (of the material point)
  Vector3d r;                        ///< point from the target's centroid, m
  Vector3d point_rate, normal_rate,
      velocity_rate;  ///< d/dt of the above: velocity, omega x normal, acceleration
};

/// Prediction of the free motion from an estimate at time t0. Immutable; copies share their table.
///
/// Attitude and rate are integrated once, at construction, over [t0 - horizon, t0 + horizon] to
/// nodes from which any time is one short high-order step away: evaluation costs the same for every
/// time and is smooth in it. Energy and angular momentum are conserved to 1e-10 over 1000 s.
class TargetMotion {
 public:
  /// @param horizon s on either side of estimate.time within which times may be asked for
  /// @throws std::invalid_argument for a horizon that is not finite and positive
  TargetMotion(TargetBody body, const TargetState& estimate, double horizon);

  const TargetBody& body() const;
  /// @throws std::out_of_range outside the horizon
  TargetState state(double time) const;
  ContactState contact(const ContactFeature& feature, double time) const;

 private:
  struct Table;
  std::shared_ptr<const Table> table_;
};

}  // namespace stillbase
