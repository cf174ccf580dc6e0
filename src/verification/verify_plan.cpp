#include <stillbase/verification/verification.hpp>

#include <algorithm>
#include <cmath>
#include <exception>

#include <fmt/format.h>

#include "verification/checks.hpp"

namespace stillbase {
namespace verification {
namespace {

bool is_finite(const Pose& pose) {
  return pose.position.allFinite() && pose.orientation.coeffs().allFinite();
}

class Objections {
 public:
  void demand(bool holds, const std::string& what) {
    if (!holds) list_.push_back(what);
  }
  bool none() const { return list_.empty(); }
  std::vector<std::string> take() { return std::move(list_); }

 private:
  std::vector<std::string> list_;
};

void look_at_problem(const CaptureProblem& problem, Objections& objections) {
  const int n = problem.robot.n();
  auto fits = [n](const JointVectord& x) { return x.size() == n && x.allFinite(); };
  objections.demand(n > 0, "the robot has no joints");
  objections.demand(fits(problem.start), "problem.start");
  objections.demand(static_cast<int>(problem.variables.joints.size()) == n, "problem.variables");
  objections.demand(is_finite(problem.base), "problem.base");
  objections.demand(!problem.approach.enabled || fits(problem.approach.acceleration_limit),
                    "problem.approach.acceleration_limit");
  const JointResistance& resistance = problem.resistance;
  switch (resistance.model) {
    case ResistanceModel::RotorInertia:
      objections.demand(fits(resistance.rotor_inertia), "problem.resistance");
      break;
    case ResistanceModel::Servo:
      objections.demand(fits(resistance.stiffness) && fits(resistance.damping),
                        "problem.resistance");
      break;
    case ResistanceModel::Locked:
      objections.demand(static_cast<int>(resistance.locked.size()) == n, "problem.resistance");
      break;
    case ResistanceModel::Free:
      break;
  }
}

void look_at_configuration(const Configuration& at, const CaptureProblem& problem,
                           const std::string& name, Objections& objections) {
  const int n = problem.robot.n();
  const VariableSpec& variables = problem.variables;
  objections.demand(at.phi.size() == n && at.phi.allFinite(), name + ".joint_positions");
  objections.demand(is_finite(at.base) && std::abs(at.base.orientation.norm() - 1) <= 1e-9,
                    name + ".base_pose");
  objections.demand(std::isfinite(at.contact_time), name + ".contact_time");
  const bool known = at.feature.empty() ? variables.features.empty()
                                        : at.feature == variables.feature ||
                                              std::count(variables.features.begin(),
                                                         variables.features.end(), at.feature) > 0;
  objections.demand(known, name + ".feature");
}

void look_at_approach(const Approach& approach, int n, Objections& objections) {
  const std::size_t count = approach.times.size();
  objections.demand(
      count >= 1 && approach.joint_positions.size() == count &&
          approach.joint_velocities.size() == count &&
          approach.joint_accelerations.size() == count && approach.joint_torques.size() == count &&
          approach.base_poses.size() == count && approach.base_velocities.size() == count,
      "approach: lists of different length");
  if (!objections.none()) return;
  for (std::size_t i = 0; i < count; ++i) {
    const std::string at = fmt::format("approach sample {}", i);
    const JointVectord &phi = approach.joint_positions[i], &phidot = approach.joint_velocities[i];
    objections.demand(phi.size() == n && phi.allFinite(), at + ": joint_positions");
    objections.demand(phidot.size() == n && phidot.allFinite(), at + ": joint_velocities");
    const JointVectord& phiddot = approach.joint_accelerations[i];
    objections.demand(phiddot.size() == n && phiddot.allFinite(), at + ": joint_accelerations");
    const JointVectord& torques = approach.joint_torques[i];
    objections.demand(torques.size() == n && torques.allFinite(), at + ": joint_torques");
    objections.demand(is_finite(approach.base_poses[i]) &&
                          std::abs(approach.base_poses[i].orientation.norm() - 1) <= 1e-9,
                      at + ": base_pose");
    objections.demand(approach.base_velocities[i].allFinite(), at + ": base_velocity");
    objections.demand(
        std::isfinite(approach.times[i]) && (i == 0 || approach.times[i] > approach.times[i - 1]),
        at + ": times must increase");
  }
}

}  // namespace

std::vector<std::string> structural_objections(const Plan& plan) {
  Objections objections;
  look_at_problem(plan.problem, objections);
  const int n = plan.problem.robot.n();
  look_at_configuration(plan.configuration, plan.problem, "configuration", objections);
  for (std::size_t i = 0; i < plan.candidates.size(); ++i) {
    look_at_configuration(plan.candidates[i].configuration, plan.problem,
                          fmt::format("candidates[{}]", i), objections);
  }
  for (std::size_t i = 0; i < plan.families.size(); ++i) {
    for (const Configuration& point : plan.families[i].points) {
      look_at_configuration(point, plan.problem, fmt::format("families[{}].points", i), objections);
    }
  }
  for (const auto* boxes : {&plan.certificate.proof.solutions, &plan.certificate.proof.undecided}) {
    for (const JointBox& box : *boxes) {
      objections.demand(box.lower.size() == n && box.upper.size() == n && box.lower.allFinite() &&
                            box.upper.allFinite(),
                        "certificate.proof: boxes");
      for (const std::optional<Ends>& ends : {box.base_angle, box.contact_time}) {
        objections.demand(!ends || (std::isfinite(ends->lower) && std::isfinite(ends->upper)),
                          "certificate.proof: boxes");
      }
    }
  }
  if (plan.problem.approach.enabled && plan.approach.status == ApproachStatus::Found) {
    look_at_approach(plan.approach, n, objections);
  }
  return objections.take();
}

}  // namespace verification

Verification verify_plan(const Plan& plan, const VerifyOptions& options) {
  using namespace verification;
  ClaimList claims;
  Verification result;
  const CaptureProblem problem = problem_at(plan.problem, plan.configuration);

  // A group of claims that breaks off counts as failed, and the others are still judged.
  auto group = [&](const std::string& name, auto&& check) {
    if (options.stop.reached()) {
      claims.not_evaluated(name, 0, "1", "stopped before it");
      return;
    }
    try {
      check();
    } catch (const std::exception& error) {
      claims.not_evaluated(name, 0, "1", error.what());
    }
  };

  const std::vector<std::string> objections = structural_objections(plan);
  claims.none_wrong("plan_is_complete", objections, "sizes fit and numbers are finite");
  const bool solved = plan.status != PlanStatus::Infeasible;
  claims.none_wrong("plan_has_solution",
                    solved ? std::vector<std::string>{} : std::vector<std::string>{"infeasible"},
                    "the planner found a configuration");
  if (objections.empty()) {
    const PostureResponse response = posture_response(problem, plan.configuration.phi);
    std::optional<TargetMotion> motion;
    group("target_motion", [&] {
      const bool moves = plan.approach.status == ApproachStatus::Found && problem.approach.enabled;
      motion = target_motion(problem, plan.configuration,
                             plan.configuration.base * Vector3d(response.dynamics.hand_position),
                             moves ? plan.approach.times.front() : plan.configuration.contact_time);
    });
    const Context context{plan, problem, options, motion ? &*motion : nullptr};
    ContactEvent event;
    group("contact", [&] {
      event = contact_event(problem, context.motion, plan.configuration);
      claims.none_wrong("contact",
                        event.missing.empty() ? std::vector<std::string>{}
                                              : std::vector<std::string>{event.missing},
                        "the problem says how the target is met");
    });
    if (claims.all_pass()) {
      group("configuration", [&] { check_configuration(context, event, response, claims); });
      group("impact", [&] { check_impact(context, event, response, claims); });
      group("direction_cone", [&] { check_direction_cone(context, claims); });
      group("objective", [&] { check_objective(context, event, response, claims); });
      group("constraints", [&] { check_constraints(context, event, response, claims); });
      group("candidates", [&] { check_candidates(context, claims); });
      group("families", [&] { check_families(context, claims); });
      group("proof", [&] {
        check_bound(context, claims);
        check_proof(context, claims);
      });
      group("consistency", [&] { check_consistency(context, claims); });
      group("approach", [&] { check_approach(context, claims); });
      if (options.post_impact) {
        group("post_impact",
              [&] { check_post_impact(context, event, response, claims, result.reports); });
      }
    }
  }
  result.claims = claims.claims();
  result.pass = claims.all_pass();
  // What failed may have failed because it was cut short.
  result.interrupted = !result.pass && options.stop.reached();
  return result;
}

}  // namespace stillbase
