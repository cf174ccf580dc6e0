#include "verification/clearance.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include <stillbase/core/linear_algebra.hpp>

#include "verification/path_motion.hpp"

namespace stillbase::verification {
namespace {

/// The scene's view of a posture, filled from the reference kinematics.
Kinematics<double> kinematics_at(const RobotModel& robot, const Eigen::VectorXd& phi) {
  Kinematics<double> kinematics;
  kinematics.n = robot.num_bodies();
  for (auto* points : {&kinematics.o, &kinematics.c}) points->resize(robot.bodies.size());
  kinematics.R.resize(robot.bodies.size());
  const std::vector<Pose> poses = reference::body_poses(robot, phi);
  for (std::size_t k = 0; k < poses.size(); ++k) {
    kinematics.R[k] = poses[k].orientation.toRotationMatrix();
    kinematics.o[k] = poses[k].position;
    kinematics.c[k] = poses[k] * robot.bodies[k].centroid;
  }
  const Pose hand_body = robot.hand_body == kBase ? Pose{} : poses[robot.hand_body];
  kinematics.R_hand = hand_body.orientation.toRotationMatrix() * robot.R_hand;
  kinematics.r_bh = hand_body * robot.p_hand;
  return kinematics;
}

struct Extent {
  double operator()(const Sphere& s) const { return s.radius; }
  double operator()(const Capsule& c) const { return c.radius + c.length / 2; }
  double operator()(const Cylinder& c) const { return std::hypot(c.radius, c.length / 2); }
  double operator()(const Box& b) const { return b.size.norm() / 2; }
  double operator()(const ConvexMesh& m) const {
    double extent = 0;
    for (const Vector3d& v : m.vertices) extent = std::max(extent, v.norm());
    return extent;
  }
};

/// Largest speed of any point of the target, m/s.
double target_speed(const TargetBody& body, const TargetState& state) {
  double reach = 0;
  for (const TargetShape& shape : body.shapes) {
    reach = std::max(reach, shape.pose.position.norm() + std::visit(Extent{}, shape.geometry));
  }
  return state.linear_velocity.norm() + reach * state.angular_velocity.norm();
}

/// Bound of the target's speed and angular rate at any time, m/s + rad/s: the rate is at most the
/// angular momentum over the smallest principal moment.
double target_travel_rate(const TargetMotion& motion, double time) {
  const TargetState state = motion.state(time);
  double rate = state.angular_velocity.norm();
  if (!motion.body().is_point_mass && rate > 0) {
    const Matrix3d& inertia = motion.body().inertia;
    const Vector3d omega_T = state.pose.orientation.conjugate() * state.angular_velocity;
    rate = (inertia * omega_T).norm() / principal_moments(inertia)[0];
  }
  return state.linear_velocity.norm() + rate;
}

}  // namespace

PathClearance path_clearance(const Context& context, const std::vector<Pose>& poses) {
  const CaptureProblem& problem = context.problem;
  const VerifyOptions& options = context.options;
  const Approach& approach = context.plan.approach;
  const TargetMotion* motion = context.situation.target();
  const std::size_t segments = approach.times.size() - 1;
  PathClearance result;
  std::optional<CollisionScene> scene;
  try {
    scene.emplace(problem);
  } catch (const std::exception& error) {
    result.detail = error.what();
    return result;
  }

  const auto keep_smaller = [](std::optional<double>& least,
                               const std::optional<Proximity>& nearest) {
    if (nearest && (!least || nearest->distance < *least)) least = nearest->distance;
  };
  const auto target_at = [&](double time) {
    return motion == nullptr ? std::nullopt : std::optional(motion->state(time).pose);
  };
  auto look_as_stated = [&](const Eigen::VectorXd& phi, const Pose& base, double time) {
    const std::optional<Pose> target = target_at(time);
    keep_smaller(result.distance_as_stated, scene->nearest(kinematics_at(problem.robot, phi), base,
                                                           target ? &*target : nullptr, false));
  };
  auto look = [&](const Eigen::VectorXd& phi, const Pose& base, double time) {
    ++result.instants;
    const std::optional<Pose> target = target_at(time);
    const Pose* at = target ? &*target : nullptr;
    const Kinematics<double> kinematics = kinematics_at(problem.robot, phi);
    keep_smaller(result.distance_of_path, scene->nearest(kinematics, base, at, false));
    const auto nearest = scene->nearest(kinematics, base, at);
    if (!nearest || (result.distance && nearest->distance >= *result.distance)) return;
    result.distance = nearest->distance;
    result.time = time;
    result.detail = to_string(*nearest);
  };

  const double travel = problem.approach.resolution * options.path_refinement;
  const bool floats = problem.approach.base != BaseMode::Held;
  for (std::size_t i = 0; i < segments; ++i) {
    if (options.stop.reached()) {
      result.detail = fmt::format("stopped at {:.3f} s", approach.times[i]);
      return result;
    }
    const HermiteSegment segment(approach, i);
    const double h = segment.duration();
    double steps = std::ceil(h * segment.extremes().rate.maxCoeff() / travel);
    if (motion != nullptr) {
      const double speed = target_speed(motion->body(), motion->state(segment.begin()));
      steps = std::max(steps, std::ceil(h * speed / options.max_target_step));
    }
    const int count = std::max(1, static_cast<int>(std::min(steps, 1e6)));
    Pose base = poses[i];
    for (int j = 0; j < count; ++j) {
      const double s = h * j / count;
      look(segment.position(s), base, segment.begin() + s);
      if (floats && j + 1 < count) {
        base = drifted_base(problem.robot, segment, s, h * (j + 1) / count, base, travel);
      }
    }
  }
  look(approach.joint_positions.back(), poses.back(), approach.times.back());

  const double stated_step = problem.approach.resolution / 2;
  for (std::size_t i = 0; i < segments; ++i) {
    const HermiteSegment segment(approach, i);
    const double h = segment.duration();
    const double length = (segment.extremes().rate * h).norm();
    const bool waits = length == 0 && i + 1 == segments;
    double ratio = length / stated_step;
    if (waits && motion != nullptr) {
      ratio = target_travel_rate(*motion, approach.times.back()) * h / stated_step;
    }
    const int count = static_cast<int>(std::clamp(std::ceil(ratio), 1.0, 10000.0));
    for (int j = 0; j < count; ++j) {
      const double s = h * j / count;
      const Pose base =
          floats && j > 0 ? drifted_base(problem.robot, segment, 0, s, poses[i], travel) : poses[i];
      look_as_stated(segment.position(s), base, segment.begin() + s);
    }
  }
  look_as_stated(approach.joint_positions.back(), poses.back(), approach.times.back());
  result.complete = true;
  return result;
}

std::optional<Proximity> contact_collision(const CaptureProblem& problem,
                                           const CollisionScene& scene,
                                           const Configuration& configuration) {
  const Kinematics<double> kinematics = kinematics_at(problem.robot, configuration.phi);
  const auto motion = target_motion(problem, configuration, configuration.base * kinematics.r_bh,
                                    configuration.contact_time);
  std::optional<Pose> target;
  if (motion) target = motion->state(configuration.contact_time).pose;
  return scene.first_hit(kinematics, configuration.base, target ? &*target : nullptr);
}

}  // namespace stillbase::verification
