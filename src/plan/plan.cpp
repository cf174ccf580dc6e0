#include <stillbase/plan/plan.hpp>

#include <algorithm>

namespace stillbase {

// Names in the order of the enumerations.
std::string to_string(PlanStatus status) {
  static constexpr const char* kNames[] = {"optimal", "feasible", "infeasible", "limit"};
  return kNames[static_cast<int>(status)];
}

std::string to_string(CaptureLimit limit) {
  constexpr const char* kNames[] = {"reach",        "joint_rate",     "joint_torque",
                                    "joint_stop",   "grip_force",     "grip_moment",
                                    "wheel_torque", "wheel_momentum", "time_window"};
  return kNames[static_cast<int>(limit)];
}

std::string to_string(ProofStatus status) {
  static constexpr const char* kNames[] = {"not_applicable", "complete", "undecided"};
  return kNames[static_cast<int>(status)];
}

std::string to_string(ApproachStatus status) {
  static constexpr const char* kNames[] = {
      "found",        "not_requested",    "start_invalid",
      "goal_invalid", "goal_unreachable", "unreachable_in_base_mode",
      "hit_early",    "time_out",         "interrupted",
      "too_slow",     "base_drift_open",  "stopped"};
  return kNames[static_cast<int>(status)];
}

std::optional<double> gap_to_bound(const Plan& plan) {
  const Proof& proof = plan.certificate.proof;
  if (!proof.lower_bound) return std::nullopt;
  double least = kInfinity;
  if (*proof.lower_bound > 0) {
    for (const Candidate& candidate : plan.candidates) {
      if (candidate.max_violation <= kFeasibilityTolerance) {
        least = std::min(least, candidate.value);
      }
    }
  } else {
    for (const int c : proof.candidates) {
      if (c >= 0) least = std::min(least, plan.candidates[static_cast<std::size_t>(c)].objective);
    }
  }
  if (least == kInfinity) return std::nullopt;
  return least - *proof.lower_bound;
}

}  // namespace stillbase
