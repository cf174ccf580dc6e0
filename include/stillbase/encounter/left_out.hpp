// What a problem states and its search leaves out: remarks of a check, warnings of a plan.
#pragma once

#include <string>
#include <vector>

#include <stillbase/core/constants.hpp>
#include <stillbase/plan/problem.hpp>

namespace stillbase {

/// A covariance of the target's estimate that a sticking contact or a latch does not use.
inline constexpr const char* kUnusedCovarianceRule = "unused-covariance";
/// Something uncertain that the mean over the residual velocity does not count.
inline constexpr const char* kNotInMeasureRule = "not-in-measure";

/// A stated covariance of the relative velocity below that of the target's estimate.
inline constexpr const char* kNarrowResidualRule = "narrow-residual";

/// Beside a residual velocity a contact along the normal has its impulse along the nominal one,
/// which the target's estimate leaves open.
inline constexpr const char* kFixedNormalRule = "fixed-normal";
/// rad with a probability of 95 %: what an impulse along the nominal normal may be off by.
inline constexpr double kKnownNormal = kPi / 180;

/// A hand that moves or latches, and an estimate that leaves open where the contact is. A trial
/// has its contact wherever the feature is.
inline constexpr const char* kWideEstimateRule = "wide-estimate";
inline constexpr double kMostRadius = 0.1;  ///< m with a probability of 95 %: the size of a gripper
/// rad with a probability of 95 %: half of what a gripper's jaws or a cone of a latch take up.
inline constexpr double kMostTilt = 30 * kPi / 180;

struct LeftOut {
  std::string code;          ///< the rule: one of these, or kNarrowConeRule
  std::string section, key;  ///< that the message is about: "uncertainty", "target_mass"
  std::string message;       ///< in words, with numbers

  std::string path() const { return section + "." + key; }
};

/// What the problem states of the uncertainty and its measure does not count:
/// - a cone that is narrower than the covariance of the target's estimate implies (narrow_cone());
/// - a stated covariance of the residual velocity that is smaller in some direction, at one of nine
///   instants of the window, than the one that follows from that estimate;
/// - that covariance, where the contact has no cone and no residual velocity is stated;
/// - the error of the normal beside a residual velocity of a contact along the normal;
/// - where the contact is, for a hand that moves or latches;
/// - beside a residual velocity whose expectation is minimised: half ranges and samples.
/// @pre the problem is consistent
std::vector<LeftOut> left_out(const CaptureProblem& problem);

}  // namespace stillbase
