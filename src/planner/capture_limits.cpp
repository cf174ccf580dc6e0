#include "planner/capture_limits.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include <stillbase/core/constants.hpp>

#include "plan/exclusion_words.hpp"

namespace stillbase {

namespace {

/// An axis that has none but for rounding: of the whole, and of what the whole is a difference of.
constexpr double kNoMomentum = 1e-9;
constexpr double kAtStop = 1e-12;  ///< of half the range of a joint
constexpr std::array<const char*, 3> kAxes{"x", "y", "z"};

std::string position_unit(const Joint& joint) { return joint.is_prismatic() ? "m" : "rad"; }
std::string rate_unit(const Joint& joint) { return joint.is_prismatic() ? "m/s" : "rad/s"; }
std::string torque_unit(const Joint& joint) { return joint.is_prismatic() ? "N" : "N m"; }

/// Keeps, of several places of one limit, the one that uses most.
class Most {
 public:
  void take(const LimitUse& use) {
    if (!most_ || use.part() > most_->part()) most_ = use;
  }
  void give(std::vector<LimitUse>& out) const {
    if (most_) out.push_back(*most_);
  }

 private:
  std::optional<LimitUse> most_;
};

/// From the first joint to the hand, against the arm stretched out.
void add_reach(const RobotModel& robot, const JointVectord& phi, std::vector<LimitUse>& out) {
  const Kinematics<double> kinematics = compute_kinematics(robot, phi);
  std::optional<Vector3d> first;
  double longest = robot.p_hand.norm();
  for (int k = 0; k < robot.num_bodies(); ++k) {
    const auto i = static_cast<std::size_t>(k);
    if (!robot.moves_hand[i]) continue;
    const Joint& joint = robot.tree()[i];
    if (first) longest += joint.p.norm();
    if (joint.is_prismatic()) longest += std::max(std::abs(joint.lower), std::abs(joint.upper));
    if (!first) first = kinematics.o[i];
  }
  if (!first || !std::isfinite(longest) || !(longest > 0)) return;
  out.push_back({CaptureLimit::Reach, robot.hand, (kinematics.r_bh - *first).norm(), longest, "m"});
}

/// Joints against their limits; a joint without one is left out.
/// @param values n, largest sizes
void add_joints(const RobotModel& robot, CaptureLimit limit, const JointVectord& values,
                double Joint::*of_joint, std::string (*unit)(const Joint&),
                std::vector<LimitUse>& out) {
  Most most;
  for (int k = 0; k < robot.n(); ++k) {
    const Joint& joint = robot.joints[static_cast<std::size_t>(k)];
    const double allowed = joint.*of_joint;
    if (!std::isfinite(allowed) || !(allowed > 0)) continue;
    most.take({limit, joint.name, std::abs(values[k]), allowed, unit(joint)});
  }
  most.give(out);
}

/// Distances from the middle of each joint's range.
void add_stops(const RobotModel& robot, const JointVectord& lowest, const JointVectord& highest,
               std::vector<LimitUse>& out) {
  Most most;
  for (int k = 0; k < robot.n(); ++k) {
    const Joint& joint = robot.joints[static_cast<std::size_t>(k)];
    const double middle = (joint.lower + joint.upper) / 2;
    const double half = (joint.upper - joint.lower) / 2;
    if (!std::isfinite(half) || !(half > 0)) continue;
    const double gap = std::min(lowest[k] - joint.lower, joint.upper - highest[k]);
    // A joint that rests at its stop is there but for rounding.
    const double far = std::abs(gap) <= kAtStop * half
                           ? half
                           : std::max(std::abs(lowest[k] - middle), std::abs(highest[k] - middle));
    most.take({CaptureLimit::JointStop, joint.name, far, half, position_unit(joint)});
  }
  most.give(out);
}

/// @param nothing N m s, of an axis: rounding
void add_wheels(const PostImpactSpec& spec, const ManagedMomentum& managed, double nothing,
                const SimulationSummary* summary, std::vector<LimitUse>& out) {
  const WheelSpec& wheels = spec.wheels;
  if (!wheels.exist()) return;
  const auto controller = chosen_controller(spec);
  // Under another controller the momentum stays where it is, thrusters take it elsewhere.
  const bool wheels_take_it = controller && !spec.thrusters.exist() &&
                              (controller->kind == ControllerKind::RnsHandback ||
                               controller->kind == ControllerKind::Detumble);
  Most torque, momentum;
  for (int i = 0; i < 3; ++i) {
    const std::string axis = kAxes[static_cast<std::size_t>(i)];
    const bool is_there = wheels.torque[i] > 0;
    double held = std::abs(wheels.preset[i]);
    if (summary != nullptr && is_there) {
      torque.take({CaptureLimit::WheelTorque, axis, summary->peak_wheel_torques[i],
                   wheels.torque[i], "N m"});
      held = std::max(held, summary->peak_wheel_momenta[i]);
    }
    if (wheels_take_it) held = std::max(held, std::abs(wheels.preset[i] + managed.angular[i]));
    if (!is_there && held <= nothing) continue;
    const double capacity = is_there ? wheels.momentum[i] : 0;
    if (capacity < kAnyWheelMomentum) {
      momentum.take({CaptureLimit::WheelMomentum, axis, held, capacity, "N m s"});
    }
  }
  torque.give(out);
  momentum.give(out);
}

/// The contact in its window; under detumble the time until the momentum is taken in the horizon.
void add_time(const CaptureProblem& problem, const Configuration& configuration,
              const ManagedMomentum& managed, std::vector<LimitUse>& out) {
  Most most;
  const VariableSpec& variables = problem.variables;
  const double half = (variables.contact_time_upper - variables.contact_time_lower) / 2;
  if (half > 0) {
    const double middle = variables.contact_time_lower + half;
    const double off = std::abs(configuration.contact_time - middle);
    most.take({CaptureLimit::TimeWindow, "contact_time", off, half, "s"});
  }
  const PostImpactSpec& spec = problem.post_impact;
  const auto controller = chosen_controller(spec);
  if (managed.remaining && controller->kind == ControllerKind::Detumble) {
    // What is left takes its part of the least time, if that is known. Where the momentum is taken,
    // the joints still move.
    const double size = managed.angular.norm();
    const double part = std::max(kAtRest, size > 0 ? *managed.remaining / size : 0);
    const double least = managed.least_time.value_or(0);
    const double beyond = part * (least > 0 ? least : spec.horizon);
    const double needed = managed.rest_time.value_or(spec.horizon + beyond);
    most.take({CaptureLimit::TimeWindow, "horizon", needed, spec.horizon, "s"});
  }
  most.give(out);
}

std::optional<HeldLimit> longest_held(const RobotModel& robot, const LoadTimes& times) {
  HeldLimit longest;
  const auto take = [&](CaptureLimit limit, const std::string& place, double time) {
    if (time > longest.time) longest = {limit, place, time};
  };
  for (int i = 0; i < 3; ++i) {
    take(CaptureLimit::WheelTorque, kAxes[static_cast<std::size_t>(i)], times.wheel_torques[i]);
  }
  take(CaptureLimit::GripForce, robot.hand, times.grip_force);
  take(CaptureLimit::GripMoment, robot.hand, times.grip_moment);
  for (int k = 0; k < robot.n(); ++k) {
    const std::string& joint = robot.joints[static_cast<std::size_t>(k)].name;
    take(CaptureLimit::JointRate, joint, times.joint_rates[k]);
    take(CaptureLimit::JointTorque, joint, times.joint_torques[k]);
  }
  if (longest.time > 0) return longest;
  return std::nullopt;
}

}  // namespace

ManagedMomentum account_for_momentum(const CaptureProblem& problem,
                                     const Configuration& configuration,
                                     const ImpactSummary& impact, const ContactCase& subject,
                                     const AfterContact* run) {
  const PostImpactSpec& spec = problem.post_impact;
  const RobotModel& robot = problem.robot;
  ManagedMomentum managed;
  managed.angular = impact.total;
  managed.linear = impact.Fbar.head<3>();
  const bool is_latch = subject.law == ContactLaw::Latch && subject.target;
  if (is_latch && is_in_contact(subject)) {
    const Vector3d v = configuration.base.orientation.conjugate() * subject.target->state.velocity;
    managed.linear = subject.target->body.mass * v;
  }
  const double arm = compute_kinematics(robot, configuration.phi).r_bh.norm();
  const double nothing = kNoMomentum * (managed.angular.norm() + managed.linear.norm() * arm +
                                        impact.Fbar.tail<3>().norm());
  if (spec.wheels.exist()) {
    double least = 0;
    for (int i = 0; i < 3; ++i) {
      const double h = std::abs(managed.angular[i]);
      if (h > nothing) least = std::max(least, h / spec.wheels.torque[i]);
    }
    if (std::isfinite(least)) managed.least_time = least;
  }
  const SimulationSummary* const summary = run == nullptr ? nullptr : &run->simulation.summary;
  if (summary != nullptr) {
    managed.remaining = run->simulation.trace.back().total.norm();
    managed.rest_time = summary->rest_time;
    const auto controller = chosen_controller(spec);
    if (controller && controller->kind == ControllerKind::Detumble) {
      managed.longest_held = longest_held(robot, summary->near_limit);
    }
  }

  std::vector<LimitUse>& limits = managed.limits;
  const JointVectord& phi = configuration.phi;
  add_reach(robot, phi, limits);
  add_joints(robot, CaptureLimit::JointRate,
             summary == nullptr ? impact.phidot_after() : summary->peak_joint_rates,
             &Joint::max_velocity, rate_unit, limits);
  if (summary != nullptr) {
    add_joints(robot, CaptureLimit::JointTorque, summary->peak_demanded_torques, &Joint::max_effort,
               torque_unit, limits);
  }
  add_stops(robot, summary == nullptr ? phi : summary->lowest_positions,
            summary == nullptr ? phi : summary->highest_positions, limits);
  if (summary != nullptr && run->is_held) {
    if (spec.grip.force) {
      limits.push_back(
          {CaptureLimit::GripForce, robot.hand, summary->peak_grip_force, *spec.grip.force, "N"});
    }
    if (spec.grip.moment) {
      limits.push_back({CaptureLimit::GripMoment, robot.hand, summary->peak_grip_moment,
                        *spec.grip.moment, "N m"});
    }
  }
  add_wheels(spec, managed, nothing, summary, limits);
  add_time(problem, configuration, managed, limits);
  std::stable_sort(limits.begin(), limits.end(),
                   [](const LimitUse& a, const LimitUse& b) { return a.part() > b.part(); });
  return managed;
}

bool is_bound(const ManagedMomentum& managed, double horizon) {
  constexpr double kNearLeast = 1.05;
  const auto& held = managed.longest_held;
  const double time = managed.rest_time.value_or(horizon);
  if (!held || held->time < 0.5 * time) return false;
  const bool is_wheel = held->limit == CaptureLimit::WheelTorque && managed.least_time;
  return !is_wheel || time <= kNearLeast * *managed.least_time;
}

bool is_demand_on_grasp(const LimitUse& use) {
  return use.limit == CaptureLimit::GripForce || use.limit == CaptureLimit::GripMoment ||
         use.limit == CaptureLimit::WheelMomentum;
}

bool has_no_wheel(const LimitUse& use) {
  return use.limit == CaptureLimit::WheelMomentum && use.most <= 0;
}

std::string limit_words(const LimitUse& use) {
  std::string name = to_string(use.limit);
  std::replace(name.begin(), name.end(), '_', ' ');
  return fmt::format("{} of {}: {:.4g} {}{}", name, use.place, use.value, use.unit,
                     exclusion::of_most(use));
}

}  // namespace stillbase
