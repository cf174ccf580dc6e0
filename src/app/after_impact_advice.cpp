#include "app/after_impact_advice.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "app/words.hpp"

namespace stillbase::app {

namespace {

const char* const kSlowerTarget = "a target that turns or comes slower (target.state)";

/// Per axis, N m s; an axis without a wheel holds nothing.
Vector3d capacity_of(const WheelSpec& wheels) {
  return (wheels.torque.array() > 0).select(wheels.momentum, Vector3d::Zero());
}

/// A preset of the other sign lets a wheel take up to twice its capacity, if it fills in time.
std::string preset_words(const WheelSpec& wheels, const Vector3d& angular, double wait) {
  const Vector3d capacity = capacity_of(wheels);
  const Vector3d beyond = (angular.cwiseAbs() - capacity).cwiseMax(0);
  if ((beyond.array() > capacity.array()).any()) {
    return "a preset is not enough: with one a wheel takes at most twice its capacity";
  }
  double needed = 0;
  Vector3d preset = Vector3d::Zero();
  for (int i = 0; i < 3; ++i) {
    if (beyond[i] == 0) continue;
    preset[i] = std::copysign(beyond[i], -angular[i]);
    needed = std::max(needed, beyond[i] / wheels.torque[i]);
  }
  std::string text = fmt::format("post_impact.wheels.preset of {} N m s", vector_words(preset));
  if (needed > wait) text += fmt::format(" with approach.wait above {:.4g} s", needed);
  return text;
}

std::string wheel_words(const CaptureProblem& problem, const Vector3d& angular) {
  const WheelSpec& wheels = problem.post_impact.wheels;
  const Vector3d capacity = capacity_of(wheels);
  const Vector3d held = (wheels.preset + angular).cwiseAbs();
  return fmt::format("post_impact.wheels.capacity above {} N m s, now {}; {}; {}",
                     vector_words(held.cwiseMax(capacity)), vector_words(capacity),
                     preset_words(wheels, angular, problem.approach.wait), kSlowerTarget);
}

/// The limit that decides, where it is one of the grasp or the horizon; null: another one.
const LimitUse* exceeded_use(const ManagedMomentum& managed) {
  constexpr double kRounding = 1e-6;
  const auto at =
      std::find_if(managed.limits.begin(), managed.limits.end(), [](const LimitUse& use) {
        const bool is_of_grasp = use.limit == CaptureLimit::GripForce ||
                                 use.limit == CaptureLimit::GripMoment ||
                                 use.limit == CaptureLimit::WheelMomentum;
        return (is_of_grasp || use.place == "horizon") && use.part() > 1 + kRounding;
      });
  return at == managed.limits.end() ? nullptr : &*at;
}

}  // namespace

std::string after_impact_advice(const Plan& plan) {
  const PostImpactSpec& spec = plan.problem.post_impact;
  const auto& managed = plan.managed_momentum;
  if (const LimitUse* use = managed ? exceeded_use(*managed) : nullptr) {
    switch (use->limit) {
      case CaptureLimit::WheelMomentum:
        return wheel_words(plan.problem, managed->angular);
      case CaptureLimit::GripForce:
      case CaptureLimit::GripMoment:
        return fmt::format(
            "post_impact.grip.{} above {:.4g} {}, the load when it was exceeded; {}; less "
            "post_impact.wheels.torque or smaller gains",
            use->limit == CaptureLimit::GripForce ? "force" : "moment", use->value, use->unit,
            kSlowerTarget);
      default:
        return fmt::format(
            "post_impact.horizon of about {:.3g} s, now {:.3g} s; more post_impact.wheels.torque, "
            "now {} N m",
            use->value, use->most, vector_words(spec.wheels.torque));
    }
  }
  return fmt::format(
      "another first one of post_impact.controllers; a larger constraints.joint_limit_margin; a "
      "shorter post_impact.horizon, now {:.3g} s; larger limits ({})",
      spec.horizon, limit_words(spec));
}

}  // namespace stillbase::app
