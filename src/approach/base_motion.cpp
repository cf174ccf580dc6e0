#include "approach/base_motion.hpp"

#include <algorithm>
#include <cmath>

#include <stillbase/collision/scene.hpp>

#include "dynamics/free_base.hpp"

namespace stillbase {

namespace {

/// exp of a twist [v; omega] that is constant in the moving frame.
Pose pose_exp(const Vector6d& xi) {
  const Vector3d v = xi.head<3>(), omega = xi.tail<3>();
  return {rotation_right_jacobian(-omega) * v, rotation_exp(omega)};
}

double difference(const Pose& a, const Pose& b) {
  return std::max((a.position - b.position).norm(),
                  rotation_log(a.orientation.conjugate() * b.orientation).norm());
}

constexpr double kSegmentTolerance = 1e-10;  ///< m, rad; a path has a few hundred segments
constexpr int kMaxHalvings = 12;

}  // namespace

Vector6d base_velocity(const RobotModel& robot, const JointMotion& motion) {
  return free_base_velocity(robot, motion.phi, motion.phidot);
}

// Iserles, Munthe-Kaas, Norsett, Zanna, Lie-group methods, 2000: two Gauss points and one bracket.
// The sign of the bracket is that of T' = T A (twist in the moving frame).
Pose base_step(const RobotModel& robot, const JointPath& path, std::size_t i, double t0,
               double t1) {
  const double h = t1 - t0, middle = (t0 + t1) / 2, offset = h * std::sqrt(3.0) / 6;
  const Vector6d a = base_velocity(robot, motion_on_segment(path, i, middle - offset));
  const Vector6d b = base_velocity(robot, motion_on_segment(path, i, middle + offset));
  const Vector3d va = a.head<3>(), wa = a.tail<3>(), vb = b.head<3>(), wb = b.tail<3>();
  Vector6d bracket;
  bracket << wa.cross(vb) + va.cross(wb), wa.cross(wb);
  return pose_exp((h / 2) * (a + b) + (h * h * std::sqrt(3.0) / 12) * bracket);
}

Pose base_displacement(const RobotModel& robot, const JointPath& path, std::size_t i,
                       double tolerance) {
  const double begin = path.times[i], duration = path.times[i + 1] - begin;
  Pose coarse = base_step(robot, path, i, begin, path.times[i + 1]);
  for (int halvings = 1; halvings <= kMaxHalvings; ++halvings) {
    const int steps = 1 << halvings;
    Pose fine;
    for (int s = 0; s < steps; ++s) {
      fine = fine * base_step(robot, path, i, begin + duration * s / steps,
                              begin + duration * (s + 1) / steps);
    }
    // Fourth order: the finer one is about 15 times better than the difference says.
    if (difference(coarse, fine) <= tolerance) return fine;
    coarse = fine;
  }
  return coarse;
}

std::vector<Pose> base_poses(const RobotModel& robot, const JointPath& path, BaseMode mode,
                             const Pose& end) {
  std::vector<Pose> poses(path.times.size(), end);
  if (mode == BaseMode::Held) return poses;
  for (std::size_t i = path.segments(); i-- > 0;) {
    poses[i] = poses[i + 1] * base_displacement(robot, path, i, kSegmentTolerance).inverse();
  }
  return poses;
}

std::vector<Pose> base_poses_from(const RobotModel& robot, const JointPath& path,
                                  const Pose& begin) {
  std::vector<Pose> poses(path.times.size(), begin);
  for (std::size_t i = 0; i < path.segments(); ++i) {
    poses[i + 1] = poses[i] * base_displacement(robot, path, i, kSegmentTolerance);
  }
  return poses;
}

Vector3d system_centroid(const RobotModel& robot, const Kinematics<double>& kinematics) {
  Vector3d sum = Vector3d::Zero();  // the base body's centroid is B's origin
  for (int k = 0; k < kinematics.n; ++k) sum += robot.bodies[k].mass * kinematics.c[k];
  return sum / robot.total_mass();
}

JointVectord centroid_levers(const RobotModel& robot) {
  JointVectord levers = JointVectord::Zero(robot.n());
  for (int b = 0; b < robot.num_bodies(); ++b) {
    const Body& body = robot.bodies[b];
    levers += body.mass / robot.total_mass() * motion_bound(robot, b, body.centroid.norm()).lever;
  }
  return levers;
}

}  // namespace stillbase
