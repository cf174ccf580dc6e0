// Does a plan work? Verification recomputes it by other code than the planner's.
//
// Everything is recomputed from the plan alone: kinematics, inertia, impact and floating base by
// `reference`, the target by `target`, the motion after the impact by `simulation`. Which bodies
// may touch is asked of `collision`; distances along the path come from support functions of our
// own, and both codes must agree on them. No function of the planner, and none that the planner
// computes with, judges a plan alone. So a plan of a planner with a wrong sign fails.
//
// Recomputed numbers are compared component by component, relative to the component plus a
// hundredth of the quantity's own size. With the default tolerance of 1e-10 a relative change of
// 1e-6 in any number is found, while components that are zero but for rounding may differ.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <stillbase/core/interrupt.hpp>
#include <stillbase/plan/plan.hpp>
#include <stillbase/plan/prover.hpp>

namespace stillbase {

/// What a check is about.
enum class ClaimGroup {
  Inputs,        ///< files, shape of the plan, what the other checks need
  Physics,       ///< impulse, jump, momenta, objective
  Constraints,   ///< what the problem allows at the contact
  Approach,      ///< path, base motion, torques, clearance
  AfterContact,  ///< motion under the first controller, fate of the target
  Audit,         ///< candidates, optimum, proofs: see audit/audit.hpp
  SearchRecord   ///< what only the search knows: checked by repeating it
};
std::string to_string(ClaimGroup group);

/// One statement of the plan or demand of the problem, checked.
struct Claim {
  std::string name;
  std::optional<double> value;  ///< finite; empty: could not be evaluated
  double limit = 0;             ///< what the value is held against; the detail says how
  std::string unit;             ///< "1" for ratios and counts
  bool pass = false;
  std::string detail;  ///< what was compared, or why it could not be evaluated
  ClaimGroup group = ClaimGroup::Inputs;
  /// False: it could not be checked, for the reason in `detail`. @pre then `pass` is false.
  bool is_checked = true;

  bool fails() const { return is_checked && !pass; }
};

/// What the base and the joints do after the impact under one controller. Only the first controller
/// of the problem has checks of its own.
struct ControllerReport {
  std::string controller;
  bool finished = false;              ///< the simulation reached the horizon
  double horizon = 0;                 ///< s after the impact
  double residual_base_rate = 0;      ///< |omega| at the horizon, rad/s
  double peak_base_rate = 0;          ///< rad/s
  double attitude_turned = 0;         ///< largest change of attitude since the impact, rad
  double peak_joint_rate = 0;         ///< max over time of the largest |phidot_k|, rad/s (m/s)
  double residual_joint_rate = 0;     ///< |phidot| at the horizon
  double peak_joint_torque = 0;       ///< within the torque limits, N m (N)
  double peak_demanded_torque = 0;    ///< that the controller asks for, N m (N)
  double linear_momentum_drift = 0;   ///< in N, relative, by `reference`
  double angular_momentum_drift = 0;  ///< in N, about the system centroid, relative, by `reference`
  std::vector<std::string> limits_met;  ///< "joint 3 torque at 0.12 s"
  std::string detail;                   ///< why it did not finish
};

struct Verification {
  bool pass = false;         ///< no check failed and at least one passed
  bool interrupted = false;  ///< stopped before the end, without a verdict (`pass` is false)
  /// The problem file was compared; false: only the plan's own copy of the problem is there.
  bool is_against_file = false;
  std::vector<Claim> claims;
  std::vector<ControllerReport> reports;  ///< in the problem's order
};

/// No check fails and at least one passes.
bool all_hold(const std::vector<Claim>& claims);

struct VerifyOptions {
  double recompute_tolerance = 1e-10;     ///< relative; two implementations agree to about 1e-13
  double hand_position_tolerance = 1e-8;  ///< m; ten times what the search leaves open
  double hand_angle_tolerance = 1e-8;     ///< rad
  double constraint_tolerance = 1e-8;     ///< violations of the listed constraints, in their units
  double base_path_tolerance = 1e-6;      ///< m and rad, stored base poses against integrated ones
  double base_step_tolerance = 1e-9;      ///< m and rad, the same from one stored pose to the next
  double momentum_tolerance = 1e-9;       ///< relative, approach and post-impact
  /// m, rad and relative rates: the motion after the contact against its second integration, whose
  /// steps may each be wrong by the other number.
  double second_integration_tolerance = 1e-6;
  double second_integration_step_error = 1e-10;
  /// Relative, per radian turned: the target's predicted motion against its second integration.
  double prediction_tolerance = 1e-9;
  double limit_slack = 1e-6;     ///< relative excess of rate and acceleration limits
  double cone_tolerance = 1e-6;  ///< relative, excess of a sampled worst case
  /// Relative, worst cases stated without a direction against maxima that were searched for.
  double worst_case_tolerance = 1e-8;
  int cone_samples = 4000;  ///< directions before the local refinement
  /// Directions before the local refinement where each of them is simulated.
  int simulated_cone_samples = 60;
  /// m: the smallest distance along the approach is found and proven between the samples up to so
  /// much, or to half of it where it is smaller.
  double clearance_gap = 1e-4;
  bool post_impact = true;  ///< false: no simulation, and none of its checks
  /// Repeats what the plan says to be proven; null: that stays unverified.
  const Prover* prover = default_prover();
  StopCondition stop;  ///< when reached, the remaining checks count as not evaluated
};

/// Verifies a plan. Never throws for what a plan says: a check that cannot be evaluated fails, with
/// the reason in its detail.
[[nodiscard]] Verification verify_plan(const Plan& plan, const VerifyOptions& options = {});

}  // namespace stillbase
