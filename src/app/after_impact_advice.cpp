#include "app/after_impact_advice.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include <stillbase/core/constants.hpp>
#include <stillbase/planner/post_impact.hpp>

#include "app/words.hpp"
#include "plan/exclusion_words.hpp"
#include "planner/capture_limits.hpp"

namespace stillbase::app {

namespace {

const char* const kSlowerTarget = "a target that turns or comes slower (target.state)";
/// On what is used of a limit: a wheel that is nearly full rests late.
constexpr double kRoom = 1.1;

/// Per axis, N m s; an axis without a wheel holds nothing.
Vector3d capacity_of(const WheelSpec& wheels) {
  return (wheels.torque.array() > 0).select(wheels.momentum, Vector3d::Zero());
}

/// Whether an axis has momentum to take and no wheel.
bool lacks_wheel(const WheelSpec& wheels, const Vector3d& angular) {
  constexpr double kNoMomentum = 1e-9;
  const double least = kNoMomentum * angular.norm();
  return ((wheels.torque.array() == 0) && (angular.array().abs() > least)).any();
}

/// The limit of the grasp or the horizon that is exceeded; null: none is.
const LimitUse* exceeded_use(const ManagedMomentum& managed) {
  const auto at =
      std::find_if(managed.limits.begin(), managed.limits.end(), [](const LimitUse& use) {
        const bool is_of_grasp = use.limit == CaptureLimit::GripForce ||
                                 use.limit == CaptureLimit::GripMoment ||
                                 use.limit == CaptureLimit::WheelMomentum;
        return (is_of_grasp || use.place == "horizon") && is_exceeded(use);
      });
  return at == managed.limits.end() ? nullptr : &*at;
}

/// Simulates changes of `post_impact` in the plan's configuration.
class Trials {
 public:
  Trials(const Plan& plan, const StopCondition& stop) : plan_(plan), stop_(stop) {}

  const PostImpactSpec& spec() const { return plan_.problem.post_impact; }

  /// What fails with it; empty: nothing.
  std::string failure(const PostImpactSpec& changed) const {
    return post_impact_failure(changed_to(changed), plan_.configuration, plan_.impact, stop_);
  }
  bool helps(const PostImpactSpec& changed) const { return failure(changed).empty(); }
  /// Of the whole motion to the horizon, whatever it exceeds.
  SimulationSummary motion() const {
    return simulate_post_impact(plan_.problem, plan_.configuration, plan_.impact,
                                spec().controllers.front(), stop_)
        .simulation.summary;
  }

 private:
  CaptureProblem changed_to(const PostImpactSpec& changed) const {
    CaptureProblem problem = plan_.problem;
    problem.post_impact = changed;
    return problem;
  }

  const Plan& plan_;
  const StopCondition& stop_;
};

/// A change, and what fails next where it does not help alone.
std::string with_next(const std::string& change, const std::string& next) {
  return next.empty() ? change : fmt::format("{}, and then: {}", change, next);
}

/// Longer horizons one after the other; empty: with none.
std::string longer_horizon(const Trials& trials, double needed) {
  constexpr double kLonger = 1.25;
  constexpr int kMany = 8;
  PostImpactSpec changed = trials.spec();
  changed.horizon = rounded_up(needed);
  std::string before;
  for (int i = 0; i < kMany; ++i, changed.horizon = rounded_up(kLonger * changed.horizon)) {
    const std::string failure = trials.failure(changed);
    if (failure.empty()) {
      return fmt::format("post_impact.horizon of {:.3g} s, now {:.3g} s", changed.horizon,
                         trials.spec().horizon);
    }
    if (failure == before) break;  // what fails does not wait for the horizon
    before = failure;
  }
  return "";
}

/// Wheels with twice and four times the torque, and weaker ones.
std::string other_torque(const Trials& trials) {
  for (const double factor : {2.0, 4.0, 0.5, 0.25}) {
    PostImpactSpec changed = trials.spec();
    changed.wheels.torque *= factor;
    if (changed.wheels.exist() && trials.helps(changed)) {
      return fmt::format("post_impact.wheels.torque of {} N m, now {}",
                         vector_words(changed.wheels.torque),
                         vector_words(trials.spec().wheels.torque));
    }
  }
  return "";
}

std::string other_controller(const Trials& trials) {
  for (const std::string& name : trials.spec().controllers) {
    PostImpactSpec changed = trials.spec();
    changed.controllers = {name};
    if (name != trials.spec().controllers.front() && trials.helps(changed)) {
      return fmt::format("{} as the first of post_impact.controllers", name);
    }
  }
  return "";
}

/// What is asked of the base, where nothing else fails: as little as the motion keeps.
std::string other_limits(const Trials& trials) {
  const PostImpactSpec& stated = trials.spec();
  PostImpactSpec changed = stated;
  changed.residual_base_rate_max = changed.attitude_change_max = kInfinity;
  if (!trials.helps(changed)) return "";
  changed = stated;
  const SimulationSummary motion = trials.motion();
  std::vector<std::string> words;
  const auto widen = [&](double PostImpactSpec::*limit, double needed, const std::string& key,
                         const char* unit) {
    if (needed <= stated.*limit) return;
    const double in_degrees = rounded_up(std::max(needed * kDegrees, kZeroSize));
    changed.*limit = in_degrees / kDegrees;
    words.push_back(fmt::format("post_impact.{} of {:.3g} {}, now {:.3g} {}", key, in_degrees, unit,
                                stated.*limit * kDegrees, unit));
  };
  widen(&PostImpactSpec::attitude_change_max, motion.attitude_turned, "attitude_change_max", "deg");
  widen(&PostImpactSpec::residual_base_rate_max, motion.residual_base_rate,
        "residual_base_rate_max", "deg/s");
  if (words.empty() || !trials.helps(changed)) return "";
  return fmt::format("{}", fmt::join(words, ", with "));
}

std::string shorter_horizon(const Trials& trials) {
  for (const double factor : {0.8, 0.5, 0.25}) {
    PostImpactSpec changed = trials.spec();
    changed.horizon *= factor;
    if (trials.helps(changed)) {
      return fmt::format("post_impact.horizon of {:.3g} s, now {:.3g} s", changed.horizon,
                         trials.spec().horizon);
    }
  }
  return "";
}

/// The grip twice as strong, and again, from a little above its load on; empty: none is enough, or
/// the load is far from what it bears. A controller that keeps to the grip brakes harder with it.
std::string stronger_grip(const Trials& trials, const LimitUse& use) {
  constexpr double kNear = 0.9;
  constexpr int kMany = 14;
  const bool is_force = use.limit == CaptureLimit::GripForce;
  if (!is_force && use.limit != CaptureLimit::GripMoment) return "";
  if (use.part() < kNear) return "";
  PostImpactSpec changed = trials.spec();
  double& borne = *(is_force ? changed.grip.force : changed.grip.moment);
  const double first = rounded_up(kRoom * use.value);
  std::string next;
  borne = first;
  for (int i = 0; i < kMany; ++i, borne = rounded_up(2 * borne)) {
    const std::string failure = trials.failure(changed);
    if (i == 0) next = failure;
    if (!failure.empty()) continue;
    const std::string words =
        fmt::format("post_impact.grip.{} of {:.3g} {}, now {:.3g} {}",
                    is_force ? "force" : "moment", borne, use.unit, use.most, use.unit);
    return next.empty() ? words
                        : fmt::format("{} (with {:.3g} {}: {})", words, first, use.unit, next);
  }
  return "";
}

/// Axes that have none get a wheel with the largest torque of the others.
std::string larger_wheels(const Trials& trials, const Vector3d& angular) {
  const WheelSpec& stated = trials.spec().wheels;
  const Vector3d held = (stated.preset + angular).cwiseAbs();
  PostImpactSpec changed = trials.spec();
  WheelSpec& wheels = changed.wheels;
  wheels.momentum = stated.momentum.cwiseMax(kRoom * held);
  std::vector<std::string> words;
  if (lacks_wheel(stated, angular)) {
    const double most = stated.torque.maxCoeff();
    wheels.torque = (stated.torque.array() > 0).select(stated.torque, most);
    words.push_back(fmt::format("post_impact.wheels.torque of {} N m, now {}",
                                vector_words(wheels.torque), vector_words(stated.torque)));
  }
  if ((held.array() > stated.momentum.array()).any()) {
    words.push_back(fmt::format("post_impact.wheels.capacity above {} N m s, now {}",
                                vector_words(held.cwiseMax(stated.momentum)),
                                vector_words(stated.momentum)));
  }
  return with_next(fmt::format("{}", fmt::join(words, ", with ")), trials.failure(changed));
}

/// A preset of the other sign lets a wheel take up to twice its capacity.
std::string preset_wheels(const Trials& trials, const Vector3d& angular) {
  PostImpactSpec changed = trials.spec();
  WheelSpec& wheels = changed.wheels;
  const Vector3d capacity = capacity_of(wheels);
  const Vector3d beyond = (angular.cwiseAbs() - capacity).cwiseMax(0);
  if ((beyond.array() > capacity.array()).any()) {
    return "a preset is not enough: with one a wheel takes at most twice its capacity";
  }
  wheels.preset.setZero();
  for (int i = 0; i < 3; ++i) {
    if (beyond[i] > 0) wheels.preset[i] = std::copysign(beyond[i], -angular[i]);
  }
  return with_next(
      fmt::format("post_impact.wheels.preset of {} N m s", vector_words(wheels.preset)),
      trials.failure(changed));
}

/// Whether the wheels may hold momentum before the contact: it would turn what turns by then.
bool takes_preset(const CaptureProblem& problem) {
  const ApproachSpec& approach = problem.approach;
  return !problem.hand_motion.moves() && !(approach.enabled && approach.base == BaseMode::Floating);
}

/// The joint limit of this kind of which most is used, where it is exceeded; null: it is not.
const LimitUse* exceeded_joint(const Plan& plan, CaptureLimit limit) {
  if (!plan.managed_momentum) return nullptr;
  for (const LimitUse& use : plan.managed_momentum->limits) {
    if (use.limit == limit && is_exceeded(use)) return &use;
  }
  return nullptr;
}

/// `robot.limits` of a joint, where its drive is better than the robot says.
std::string drive_words(const LimitUse& use, const std::string& key) {
  const double scale = use.unit == "rad/s" ? kDegrees : 1;
  const std::string unit = use.unit == "rad/s" ? "deg/s" : use.unit;
  return fmt::format("robot.limits.{}.{} above {:.3g} {}, now {:.3g} {}, where its drive has it",
                     use.place, key, rounded_up(scale * use.value), unit, scale * use.most, unit);
}

/// What a new search could do about the joints.
std::string joint_words(const Plan& plan, bool stops) {
  std::string text;
  if (stops) text += ", a larger constraints.joint_limit_margin";
  if (const LimitUse* rate = exceeded_joint(plan, CaptureLimit::JointRate)) {
    const ConstraintSpec& constraints = plan.problem.constraints;
    text += constraints.joint_rate_max.size() > 0 ? ", a smaller constraints.joint_rate_max"
            : constraints.joint_rate_scale        ? ", a smaller constraints.joint_rate_scale"
                                                  : ", constraints.joint_rate_scale of 1 or less "
                                                    "(of the limits, right after the impact)";
    text += ", " + drive_words(*rate, "rate");
  }
  if (const LimitUse* torque = exceeded_joint(plan, CaptureLimit::JointTorque)) {
    text += ", " + drive_words(*torque, torque->unit == "N" ? "force" : "torque");
  }
  return text;
}

}  // namespace

std::string after_impact_words(const Plan& plan, const std::string& failure,
                               const StopCondition& stop) {
  if (failure != exclusion::kAttitude && failure != exclusion::kBaseRate) return failure;
  const PostImpactSpec& spec = plan.problem.post_impact;
  const SimulationSummary motion = Trials(plan, stop).motion();
  std::vector<std::string> words;
  const auto add = [&](const std::string& name, double value, double most, const char* unit) {
    if (value > most) {
      words.push_back(
          fmt::format("{} {} {} of {:.3g} {}", name, size_words(value), unit, most, unit));
    }
  };
  add("attitude change of the base", motion.attitude_turned * kDegrees,
      spec.attitude_change_max * kDegrees, "deg");
  add("base rate at the horizon", motion.residual_base_rate * kDegrees,
      spec.residual_base_rate_max * kDegrees, "deg/s");
  return words.empty() ? failure : fmt::format("{}", fmt::join(words, ", "));
}

std::string after_impact_advice(const Plan& plan, const std::string& failure,
                                const StopCondition& stop) {
  const Trials trials(plan, stop);
  const auto& managed = plan.managed_momentum;
  std::vector<std::string> advice;
  const auto add = [&](std::string words) {
    if (!words.empty()) advice.push_back(std::move(words));
  };
  std::string untried = kSlowerTarget;
  const LimitUse* use = managed ? exceeded_use(*managed) : nullptr;
  if (use != nullptr && use->limit == CaptureLimit::WheelMomentum) {
    add(larger_wheels(trials, managed->angular));
    if (!lacks_wheel(trials.spec().wheels, managed->angular) && takes_preset(plan.problem)) {
      add(preset_wheels(trials, managed->angular));
    }
  } else {
    for (const LimitUse& one : managed ? managed->limits : std::vector<LimitUse>{}) {
      add(stronger_grip(trials, one));
    }
    const bool is_late = use != nullptr && use->place == "horizon";
    if (is_late) add(longer_horizon(trials, use->value));
    if (use == nullptr) add(shorter_horizon(trials));
    untried += joint_words(plan, failure.ends_with(exclusion::kStop));
    add(other_torque(trials));
    add(other_controller(trials));
    add(other_limits(trials));
  }
  if (advice.empty()) advice.emplace_back("in this configuration nothing tried in post_impact");
  return fmt::format("{}; with a new search: {}", fmt::join(advice, "; "), untried);
}

}  // namespace stillbase::app
