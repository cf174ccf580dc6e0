#include <stillbase/encounter/target_motion.hpp>

#include <algorithm>
#include <cmath>

#include <stillbase/dynamics/kinematics.hpp>
#include <stillbase/plan/feature.hpp>

namespace stillbase {

namespace {

Vector3d hand_in_N(const CaptureProblem& problem, const Configuration& configuration) {
  return configuration.base * compute_kinematics<double>(problem.robot, configuration.phi).r_bh;
}

}  // namespace

std::optional<TargetMotion> encounter_motion(const CaptureProblem& problem, const Vector3d& hand_N,
                                             const Eigen::Quaterniond& R_NB, double contact_time) {
  if (!problem.target) return std::nullopt;
  const double reach = problem.approach.max_duration + problem.approach.wait + 1;
  if (!problem.impulse.direction) {
    const double latest =
        std::max(std::abs(problem.variables.contact_time_upper - problem.target_state.time),
                 std::abs(problem.variables.contact_time_lower - problem.target_state.time)) +
        problem.uncertainty.contact_time;
    return TargetMotion(*problem.target, problem.target_state, std::max(latest, reach) + 1);
  }
  const Vector3d n = problem.impulse.direction_frame == Frame::Base
                         ? Vector3d(R_NB * *problem.impulse.direction)
                         : *problem.impulse.direction;
  TargetState state;
  state.time = contact_time;
  state.linear_velocity = problem.impulse.closing_speed * n;
  Vector3d contact_point = Vector3d::Zero();  // in T
  if (!problem.variables.feature.empty()) {
    const ContactFeature& feature = chosen_feature(problem);
    state.pose.orientation = rotation_between(feature.normal, n);
    contact_point = state.pose.orientation * feature.point;
  } else {
    double radius = 0;
    for (const TargetShape& shape : problem.target->shapes) {
      if (const auto* sphere = std::get_if<Sphere>(&shape.geometry)) {
        radius = std::max(radius, sphere->radius);
      }
    }
    contact_point = radius * n;
  }
  state.pose.position = hand_N - contact_point;
  return TargetMotion(*problem.target, state, reach);
}

std::optional<TargetMotion> encounter_motion(const CaptureProblem& problem,
                                             const Configuration& configuration) {
  return encounter_motion(problem, hand_in_N(problem, configuration),
                          configuration.base.orientation, configuration.contact_time);
}

std::optional<TargetState> target_at_contact(const CaptureProblem& problem,
                                             const Configuration& configuration) {
  const auto motion = encounter_motion(problem, configuration);
  if (!motion) return std::nullopt;
  TargetState state = motion->state(configuration.contact_time);
  if (!problem.variables.feature.empty()) {
    state.pose.position =
        hand_in_N(problem, configuration) - state.pose.orientation * chosen_feature(problem).point;
  }
  return state;
}

}  // namespace stillbase
