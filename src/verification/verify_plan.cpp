#include <stillbase/verification/verification.hpp>

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "verification/checks.hpp"
#include "verification/target_prediction.hpp"

namespace stillbase {
namespace verification {
namespace {

bool is_finite(const Pose& pose) {
  return pose.position.allFinite() && pose.orientation.coeffs().allFinite();
}

/// Finite, and the orientation of unit length.
bool is_pose(const Pose& pose) {
  return is_finite(pose) && std::abs(pose.orientation.norm() - 1) <= 1e-9;
}

bool fits(const JointVectord& x, int n) { return x.size() == n && x.allFinite(); }

bool has_sizes(const JointResistance& resistance, int n) {
  switch (resistance.model) {
    case ResistanceModel::RotorInertia:
      return fits(resistance.rotor_inertia, n);
    case ResistanceModel::Servo:
      return fits(resistance.stiffness, n) && fits(resistance.damping, n);
    case ResistanceModel::Locked:
      return static_cast<int>(resistance.locked.size()) == n;
    case ResistanceModel::Free:
      break;
  }
  return true;
}

void demand_problem(const CaptureProblem& problem, Objections& objections) {
  const int n = problem.robot.n();
  objections.demand(n > 0, "the robot has no joints");
  objections.demand(fits(problem.start, n), "problem.start");
  objections.demand(static_cast<int>(problem.variables.joints.size()) == n, "problem.variables");
  objections.demand(is_finite(problem.base), "problem.base");
  objections.demand(!problem.approach.enabled || fits(problem.approach.acceleration_limit, n),
                    "problem.approach.acceleration_limit");
  objections.demand(has_sizes(problem.resistance, n), "problem.resistance");
}

void demand_configuration(const Configuration& at, const CaptureProblem& problem,
                          const std::string& name, Objections& objections) {
  const VariableSpec& variables = problem.variables;
  objections.demand(fits(at.phi, problem.robot.n()), name + ".joint_positions");
  objections.demand(is_pose(at.base), name + ".base_pose");
  objections.demand(std::isfinite(at.contact_time), name + ".contact_time");
  const bool known = at.feature.empty() ? variables.features.empty()
                                        : at.feature == variables.feature ||
                                              std::count(variables.features.begin(),
                                                         variables.features.end(), at.feature) > 0;
  objections.demand(known, name + ".feature");
}

void demand_approach(const Approach& approach, int n, Objections& objections) {
  const std::size_t count = approach.times.size();
  objections.demand(
      count >= 1 && approach.joint_positions.size() == count &&
          approach.joint_velocities.size() == count &&
          approach.joint_accelerations.size() == count && approach.joint_torques.size() == count &&
          approach.base_poses.size() == count && approach.base_velocities.size() == count,
      "approach: lists of different length");
  if (!objections.none()) return;
  for (std::size_t i = 0; i < count; ++i) {
    const std::string at = fmt::format("approach sample {}: ", i);
    objections.demand(fits(approach.joint_positions[i], n), at + "joint_positions");
    objections.demand(fits(approach.joint_velocities[i], n), at + "joint_velocities");
    objections.demand(fits(approach.joint_accelerations[i], n), at + "joint_accelerations");
    objections.demand(fits(approach.joint_torques[i], n), at + "joint_torques");
    objections.demand(is_pose(approach.base_poses[i]), at + "base_pose");
    objections.demand(approach.base_velocities[i].allFinite(), at + "base_velocity");
    objections.demand(
        std::isfinite(approach.times[i]) && (i == 0 || approach.times[i] > approach.times[i - 1]),
        at + "times must increase");
  }
}

void demand_boxes(const std::vector<JointBox>& boxes, int n, Objections& objections) {
  const auto is_interval = [](const std::optional<Ends>& ends) {
    return !ends || (std::isfinite(ends->lower) && std::isfinite(ends->upper));
  };
  for (const JointBox& box : boxes) {
    objections.demand(fits(box.lower, n) && fits(box.upper, n) && is_interval(box.base_angle) &&
                          is_interval(box.contact_time),
                      "certificate.proof: boxes");
  }
}

}  // namespace

Objections structural_objections(const Plan& plan) {
  Objections objections;
  demand_problem(plan.problem, objections);
  const int n = plan.problem.robot.n();
  demand_configuration(plan.configuration, plan.problem, "configuration", objections);
  for (std::size_t i = 0; i < plan.candidates.size(); ++i) {
    demand_configuration(plan.candidates[i].configuration, plan.problem,
                         fmt::format("candidates[{}]", i), objections);
  }
  for (std::size_t i = 0; i < plan.families.size(); ++i) {
    for (const Configuration& point : plan.families[i].points) {
      demand_configuration(point, plan.problem, fmt::format("families[{}].points", i), objections);
    }
  }
  demand_boxes(plan.certificate.proof.solutions, n, objections);
  demand_boxes(plan.certificate.proof.undecided, n, objections);
  if (plan.problem.approach.enabled && plan.approach.status == ApproachStatus::Found) {
    demand_approach(plan.approach, n, objections);
  }
  return objections;
}

int Context::cone_samples() const {
  return simulates_turn(problem) ? std::min(options.simulated_cone_samples, options.cone_samples)
                                 : options.cone_samples;
}

double Context::objective_tolerance() const {
  return verification::objective_tolerance(problem, options.recompute_tolerance);
}

ClaimList check_plan(const Plan& plan, const VerifyOptions& options,
                     const std::function<void(const Context&, ClaimList&)>& checks) {
  ClaimList claims;
  const Objections objections = structural_objections(plan);
  claims.none_wrong("plan_is_complete", objections, "sizes fit and numbers are finite");
  Objections unsolved;
  unsolved.demand(plan.status != PlanStatus::Infeasible, "infeasible");
  claims.none_wrong("plan_has_solution", unsolved, "the planner found a configuration");
  if (!objections.none()) return claims;

  std::optional<Situation> situation;
  claims.run("target_motion", options.stop, [&] {
    const bool moves =
        plan.approach.status == ApproachStatus::Found && plan.problem.approach.enabled;
    situation.emplace(plan.problem, plan.configuration,
                      moves ? plan.approach.times.front() : plan.configuration.contact_time);
  });
  if (!situation) return claims;
  Objections missing;
  missing.demand(situation->event.missing.empty(), situation->event.missing);
  claims.none_wrong("contact", missing, "the problem states direction and feature of the contact");
  if (claims.all_pass()) checks({plan, options, *situation, situation->problem}, claims);
  return claims;
}

}  // namespace verification

Verification verify_plan(const Plan& plan, const VerifyOptions& options) {
  using namespace verification;
  std::vector<ControllerReport> reports;
  const ClaimList claims = check_plan(plan, options, [&](const Context& context, ClaimList& list) {
    const auto run = [&](ClaimGroup group, const char* name, auto&& checks) {
      list.begin(group);
      list.run(name, options.stop, [&] { checks(context, list); });
    };
    run(ClaimGroup::Constraints, "configuration",
        [](const Context& c, ClaimList& l) { check_configuration(c.situation, c.options, l); });
    run(ClaimGroup::Physics, "target_prediction", check_target_prediction);
    run(ClaimGroup::Physics, "impact", check_impact);
    run(ClaimGroup::Physics, "direction_cone", check_direction_cone);
    run(ClaimGroup::Physics, "objective", check_objective);
    run(ClaimGroup::Constraints, "constraints", check_constraints);
    run(ClaimGroup::Approach, "approach", check_approach);
    if (!options.post_impact) return;
    run(ClaimGroup::AfterContact, "post_impact",
        [&](const Context& c, ClaimList& l) { check_post_impact(c, l, reports); });
  });
  Verification result = claims.result(options.stop);
  result.reports = std::move(reports);
  return result;
}

}  // namespace stillbase
