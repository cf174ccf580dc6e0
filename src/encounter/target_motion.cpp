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

/// How long before the contact the approach may look for the target, s.
double reach_back(const CaptureProblem& problem) {
  return problem.approach.max_duration + problem.approach.wait + 1;
}

}  // namespace

double motion_horizon(const CaptureProblem& problem) {
  const VariableSpec& variables = problem.variables;
  const double time = problem.target_state.time;
  const double latest = std::max(std::abs(variables.contact_time_upper - time),
                                 std::abs(variables.contact_time_lower - time)) +
                        problem.uncertainty.contact_time;
  const double after = problem.hand_motion.moves() ? kLongestAbort : 0;
  return std::max(latest + after, reach_back(problem)) + 1;
}

std::optional<TargetMotion> encounter_motion(const CaptureProblem& problem, const Vector3d& hand_N,
                                             const Eigen::Quaterniond& R_NB, double contact_time) {
  if (!problem.target) return std::nullopt;
  if (!problem.impulse.direction) {
    return TargetMotion(*problem.target, problem.target_state, motion_horizon(problem));
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
  return TargetMotion(*problem.target, state, reach_back(problem));
}

std::optional<TargetMotion> encounter_motion(const CaptureProblem& problem,
                                             const Configuration& configuration) {
  return encounter_motion(problem, hand_in_N(problem, configuration),
                          configuration.base.orientation, configuration.contact_time);
}

std::optional<TargetState> target_at_contact(const CaptureProblem& problem,
                                             const Configuration& configuration) {
  return target_at_contact(problem, encounter_motion(problem, configuration), configuration);
}

std::optional<TargetState> target_at_contact(const CaptureProblem& problem,
                                             const std::optional<TargetMotion>& motion,
                                             const Configuration& configuration) {
  if (!motion) return std::nullopt;
  TargetState state = motion->state(configuration.contact_time);
  if (!problem.variables.feature.empty()) {
    state.pose.position =
        hand_in_N(problem, configuration) - state.pose.orientation * chosen_feature(problem).point;
  }
  return state;
}

}  // namespace stillbase
