// The target: a rigid body in free motion with contact features on its surface.
//
// Target frame T: origin at the centroid. The centroid moves straight in the inertial frame N, the
// rotation is torque-free (Euler's equations).
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <stillbase/robot/robot_model.hpp>

namespace stillbase {

/// A place on the target for a contact, fixed in T.
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

  Matrix3d inverse_inertia() const;  ///< zero for a point mass
};

/// Inverse mass that a free body shows at a contact point along n, 1/kg:
///   n' W_t n = 1/m + (r x n)' I^-1 (r x n).
/// @param inverse_inertia I^-1 about the centroid; zero for a point mass
/// @param r contact point from the centroid, m; n unit; both in the axes of I
double target_inverse_mass(double mass, const Matrix3d& inverse_inertia, const Vector3d& r,
                           const Vector3d& n);

/// Motion at one instant.
struct TargetState {
  double time = 0;                               ///< s
  Pose pose;                                     ///< T_NT
  Vector3d linear_velocity = Vector3d::Zero();   ///< of the centroid, in N, m/s
  Vector3d angular_velocity = Vector3d::Zero();  ///< in N, rad/s
};

/// A contact feature at one instant, in N.
struct ContactState {
  Vector3d point, normal, velocity;  ///< m, unit, m/s (of the material point)
  Vector3d r;                        ///< point from the target's centroid, m
};

/// Free motion from an estimate at time t0. Immutable; copies share their table.
///
/// Attitude and rate are integrated once, at construction, over [t0 - horizon, t0 + horizon]. The
/// nodes are so dense that a power series at the nearest one, or one high-order step where there
/// are very many, reaches any time: evaluation costs the same for every time and is smooth in it.
/// Energy and angular momentum are conserved to 1e-10 over 1000 s.
class TargetMotion {
 public:
  /// @param horizon s on either side of estimate.time within which times may be asked for
  /// @throws std::invalid_argument for a horizon that is not finite and positive, or a target that
  ///   rotates by more than 500 000 rad within it
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
