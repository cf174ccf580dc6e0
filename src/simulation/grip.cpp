#include <stillbase/simulation/grip.hpp>

#include <cstddef>

namespace stillbase {
namespace {

/// Motion of a point of a body against N, in B axes: derivatives are those of N.
struct PointMotion {
  Vector3d omega, acceleration, dot_omega;

  /// The acceleration of the body's point that lies by d beside this one.
  Vector3d beside(const Vector3d& d) const {
    return acceleration + dot_omega.cross(d) + omega.cross(omega.cross(d));
  }
};

/// A point of the body that carries the hand, from the base along the joints. @param at the point
PointMotion hand_body_motion(const RobotModel& robot, const Kinematics<double>& kinematics,
                             const PlantState& state, const PlantAcceleration& acceleration,
                             const Vector3d& at) {
  const Vector3d v = state.Omega.head<3>(), omega = state.Omega.tail<3>();
  PointMotion motion{omega, acceleration.dot_Omega.head<3>() + omega.cross(v),
                     acceleration.dot_Omega.tail<3>()};
  Vector3d point = Vector3d::Zero();
  for (int k = 0; k < robot.num_bodies(); ++k) {
    const auto i = static_cast<std::size_t>(k);
    if (!robot.moves_hand[i]) continue;
    const double ratio = robot.is_coupled() ? robot.couplings[i].ratio : 1;
    const double rate = ratio * state.phidot[robot.coordinate(k)];
    const double change = ratio * acceleration.phiddot[robot.coordinate(k)];
    const Vector3d z = kinematics.z(k);
    motion.acceleration = motion.beside(kinematics.o[i] - point);
    point = kinematics.o[i];
    if (robot.tree()[i].is_prismatic()) {
      motion.acceleration += change * z + 2 * rate * motion.omega.cross(z);
    } else {
      motion.dot_omega += change * z + rate * motion.omega.cross(z);
      motion.omega += rate * z;
    }
  }
  motion.acceleration = motion.beside(at - point);
  return motion;
}

}  // namespace

Vector6d grip_wrench(const HeldTarget& held, const RobotModel& robot,
                     const Kinematics<double>& kinematics, const PlantState& state,
                     const PlantAcceleration& acceleration) {
  const Vector3d arm = kinematics.R_hand * held.hand_target.position;  // hand to centroid
  const PointMotion centroid =
      hand_body_motion(robot, kinematics, state, acceleration, kinematics.r_bh + arm);
  const Matrix3d R_BT = kinematics.R_hand * held.hand_target.orientation.toRotationMatrix();
  const Matrix3d inertia = R_BT * held.body.inertia * R_BT.transpose();
  const Vector3d f = held.body.mass * centroid.acceleration;
  const Vector3d spin = inertia * centroid.omega;
  const Vector3d rate = inertia * centroid.dot_omega + centroid.omega.cross(spin);
  Vector6d wrench;
  wrench << f, rate + arm.cross(f);
  return wrench;
}

}  // namespace stillbase
