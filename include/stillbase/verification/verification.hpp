// The verdict on a plan, claim by claim, by other code than the planner's.
//
// Everything is recomputed from the plan alone: kinematics, inertia, impact and floating base by
// `reference`, the target by `target`, bodies in the way by `collision`, the time after the impact
// by `simulation`. Nothing of the planner (`capture`, `approach`) and nothing that it computes with
// (`dynamics`, `impact`) decides a claim about the plan, so a planner with a wrong sign is refused.
//
// Recomputed numbers are compared component by component, relative to the component plus a
// hundredth of the quantity's own size: with the default tolerance of 1e-10 a relative change of
// 1e-6 in any number is found, while components that are zero but for rounding may differ.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <stillbase/core/interrupt.hpp>
#include <stillbase/plan/plan.hpp>

namespace stillbase {

/// One thing that the plan says or that the problem asks, judged.
struct Claim {
  std::string name;
  std::optional<double> value;  ///< finite; empty: could not be evaluated (then it failed)
  double limit = 0;             ///< what the value is held against; the detail says how
  std::string unit;             ///< "1" for ratios and counts
  bool pass = false;
  std::string detail;  ///< what was compared, or why it could not be evaluated
};

/// What the base and the joints do after the impact under one controller. Facts, not verdicts: the
/// first controller of the problem has claims of its own.
struct ControllerReport {
  std::string controller;
  bool finished = false;              ///< the simulation reached the horizon
  double horizon = 0;                 ///< s after the impact
  double residual_base_rate = 0;      ///< |omega| at the horizon, rad/s
  double peak_base_rate = 0;          ///< rad/s
  double attitude_turned = 0;         ///< largest turn away from the attitude at the impact, rad
  double peak_joint_rate = 0;         ///< max over time of the largest |phidot_k|, rad/s (m/s)
  double residual_joint_rate = 0;     ///< |phidot| at the horizon
  double peak_joint_torque = 0;       ///< N m (N)
  double linear_momentum_drift = 0;   ///< in N, relative, by `reference`
  double angular_momentum_drift = 0;  ///< in N, about the system centroid, relative, by `reference`
  std::vector<std::string> limits_met;  ///< "joint 3 torque at 0.12 s"
  std::string detail;                   ///< why it did not finish
};

struct Verification {
  bool pass = false;         ///< every claim passed and there is at least one
  bool interrupted = false;  ///< stopped before the end, with no verdict (`pass` is false)
  std::vector<Claim> claims;
  std::vector<ControllerReport> reports;  ///< in the problem's order
};

struct VerifyOptions {
  double recompute_tolerance = 1e-10;     ///< relative; two implementations agree to about 1e-13
  double hand_position_tolerance = 1e-8;  ///< m; ten times what the search leaves open
  double hand_angle_tolerance = 1e-8;     ///< rad
  double constraint_tolerance = 1e-8;     ///< violations of the listed constraints, in their units
  double base_path_tolerance = 1e-6;      ///< m and rad, stored base poses against integrated ones
  double base_step_tolerance = 1e-9;      ///< m and rad, the same from one stored pose to the next
  double momentum_tolerance = 1e-9;       ///< relative, approach and post-impact
  double limit_slack = 1e-6;              ///< relative excess of rate and acceleration limits
  double cone_tolerance = 1e-6;           ///< relative, excess of a sampled worst case
  /// Relative, worst cases of which no direction is stated against maxima that were found anew.
  double worst_case_tolerance = 1e-8;
  int cone_samples = 4000;  ///< directions before the local refinement
  /// Part of the problem's resolution between two postures that are checked for collisions.
  double path_refinement = 0.25;
  double max_target_step = 0.005;  ///< m, how far the target may move between two checks
  bool post_impact = true;         ///< false: leave out the simulation (its claims are absent)
  StopCondition stop;              ///< when reached, what is left counts as not evaluated
};

/// Judges a plan. Never throws for what a plan says: a claim that cannot be evaluated has failed,
/// with the reason in its detail.
[[nodiscard]] Verification verify_plan(const Plan& plan, const VerifyOptions& options = {});

}  // namespace stillbase
