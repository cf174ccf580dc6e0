// With its hash recomputed, a plan with one number off by a millionth is still refused: by
// recomputation.
#include <catch2/catch.hpp>

#include <functional>

#include <stillbase/audit/audit.hpp>

#include "verification/example_plans.hpp"

using namespace stillbase;
using namespace stillbase::verification_test;

namespace {

constexpr double kFactor = 1 + 1e-6;

struct Mutation {
  std::string name;
  std::function<void(Plan&)> apply;
};

// Changes a posture, pose or time in all its copies in the plan, so that no comparison of copies
// finds the change.
void configure(Plan& plan, const std::function<void(Configuration&)>& change) {
  change(plan.configuration);
  for (Candidate& candidate : plan.candidates) change(candidate.configuration);
  change(plan.nominal_optimum->configuration);
  Approach& a = plan.approach;
  for (const std::size_t i : {a.times.size() - 2, a.times.size() - 1}) {
    a.joint_positions[i] = plan.configuration.phi;
    a.base_poses[i] = plan.configuration.base;
  }
  a.times.back() = plan.configuration.contact_time;
  a.path_length = chord_length(a);
}

template <class V>
void add_components(std::vector<Mutation>& mutations, const std::string& name, int size,
                    V&& component) {
  for (int i = 0; i < size; ++i) {
    mutations.push_back({name + "[" + std::to_string(i) + "]",
                         [component, i](Plan& plan) { component(plan, i) *= kFactor; }});
  }
}

std::vector<Mutation> all_mutations(const Plan& plan) {
  std::vector<Mutation> m;
  for (int k = 0; k < 7; ++k) {
    m.push_back({"configuration.phi[" + std::to_string(k) + "]",
                 [k](Plan& p) { configure(p, [k](Configuration& c) { c.phi(k) *= kFactor; }); }});
  }
  for (int i = 0; i < 3; ++i) {
    m.push_back({"configuration.base.position[" + std::to_string(i) + "]", [i](Plan& p) {
                   configure(p, [i](Configuration& c) { c.base.position(i) *= kFactor; });
                 }});
  }
  for (int i = 0; i < 4; ++i) {
    m.push_back({"configuration.base.orientation[" + std::to_string(i) + "]", [i](Plan& p) {
                   configure(p, [i](Configuration& c) {
                     c.base.orientation.coeffs()(i) *= kFactor;
                     c.base.orientation.normalize();
                   });
                   p.problem.base = p.configuration.base;  // so that only the hand differs
                 }});
  }
  m.push_back({"configuration.contact_time", [](Plan& p) {
                 configure(p, [](Configuration& c) { c.contact_time *= kFactor; });
                 p.problem.variables.contact_time_upper = p.configuration.contact_time;
               }});

  add_components(m, "Fbar", 3, [](Plan& p, int i) -> double& { return p.impact.Fbar(i); });
  add_components(m, "Delta_Omega", 6,
                 [](Plan& p, int i) -> double& { return p.impact.Delta_Omega(i); });
  add_components(m, "Delta_phidot", 7,
                 [](Plan& p, int i) -> double& { return p.impact.Delta_phidot(i); });
  add_components(m, "Delta_phidot_rns", 7,
                 [](Plan& p, int i) -> double& { return p.impact.Delta_phidot_rns(i); });
  add_components(m, "Delta_phidot_orthogonal", 7,
                 [](Plan& p, int i) -> double& { return p.impact.Delta_phidot_orthogonal(i); });
  add_components(m, "total", 3, [](Plan& p, int i) -> double& { return p.impact.total(i); });
  add_components(m, "base", 3, [](Plan& p, int i) -> double& { return p.impact.base(i); });
  add_components(m, "coupling", 3, [](Plan& p, int i) -> double& { return p.impact.coupling(i); });
  add_components(m, "judgement", 3, [](Plan& p, int i) -> double& {
    CaseJudgement& j = p.impact.judgement;
    return i == 0 ? j.total : i == 1 ? j.base : j.coupling;
  });
  add_components(m, "closing_speed", 1,
                 [](Plan& p, int) -> double& { return p.impact.closing_speed; });
  add_components(m, "objective", 4, [](Plan& p, int i) -> double& {
    ObjectiveValue& o = p.objective;
    return i == 0 ? o.nominal : i == 1 ? o.worst_case : i == 2 ? o.value : o.terms.at(o.name);
  });
  add_components(m, "candidate.value", 1,
                 [](Plan& p, int) -> double& { return p.candidates[0].value; });
  add_components(m, "worst_direction", 3,
                 [](Plan& p, int i) -> double& { return p.objective.worst_direction(i); });
  add_components(m, "candidate.objective", 1,
                 [](Plan& p, int) -> double& { return p.candidates[0].objective; });

  add_components(m, "candidate.worst_case", 1,
                 [](Plan& p, int) -> double& { return p.candidates[0].worst_case; });
  for (int k = 0; k < 7; ++k) {
    m.push_back({"candidate.phi[" + std::to_string(k) + "]", [k](Plan& p) {
                   // Another candidate than the chosen one.
                   Candidate other = p.candidates[0];
                   other.configuration.phi(k) *= kFactor;
                   p.candidates.push_back(other);
                   p.certificate.distinct_solutions = static_cast<int>(p.candidates.size());
                   p.certificate.starts += 10;
                 }});
  }
  for (std::size_t i = 0; i < plan.constraints.size(); ++i) {
    const std::string name = plan.constraints[i].name;
    m.push_back({name + ".lower", [i](Plan& p) {
                   ConstraintValue& c = p.constraints[i];
                   c.lower = std::abs(c.lower) < 1e300 ? c.lower * kFactor - 1e-11 : -10;
                 }});
    m.push_back({name + ".upper", [i](Plan& p) {
                   ConstraintValue& c = p.constraints[i];
                   c.upper = std::abs(c.upper) < 1e300 ? c.upper * kFactor + 1e-11 : 10;
                 }});
  }
  m.push_back({"certificate.max_violation", [](Plan& p) { p.certificate.max_violation += 1e-10; }});
  m.push_back({"kkt_residual", [](Plan& p) { p.certificate.kkt_residual = 0.3; }});
  m.push_back({"proof.gap", [](Plan& p) { p.certificate.proof.gap = -7; }});
  m.push_back({"proof.found_by_search", [](Plan& p) { p.certificate.proof.found_by_search = 99; }});
  m.push_back({"unseen", [](Plan& p) { p.certificate.unseen *= kFactor; }});
  m.push_back({"optimizer", [](Plan& p) { p.optimizer = "nlopt-cobyla"; }});
  m.push_back({"solver_calls", [](Plan& p) { p.solver_calls.clear(); }});
  m.push_back({"distinct_solutions", [](Plan& p) { ++p.certificate.distinct_solutions; }});

  // The path, at three of its samples.
  for (const std::size_t s : {std::size_t{15}, std::size_t{28}, plan.approach.times.size() - 12}) {
    const std::string at = "sample " + std::to_string(s) + " ";
    add_components(m, at + "joint_positions", 7,
                   [s](Plan& p, int i) -> double& { return p.approach.joint_positions[s](i); });
    add_components(m, at + "joint_velocities", 7,
                   [s](Plan& p, int i) -> double& { return p.approach.joint_velocities[s](i); });
    add_components(m, at + "joint_accelerations", 7,
                   [s](Plan& p, int i) -> double& { return p.approach.joint_accelerations[s](i); });
    add_components(m, at + "joint_torques", 7,
                   [s](Plan& p, int i) -> double& { return p.approach.joint_torques[s](i); });
    add_components(m, at + "time", 1, [s](Plan& p, int) -> double& { return p.approach.times[s]; });
    add_components(m, at + "base_position", 3,
                   [s](Plan& p, int i) -> double& { return p.approach.base_poses[s].position(i); });
    for (int i = 0; i < 4; ++i) {
      m.push_back({at + "base_orientation[" + std::to_string(i) + "]", [s, i](Plan& p) {
                     p.approach.base_poses[s].orientation.coeffs()(i) *= kFactor;
                     p.approach.base_poses[s].orientation.normalize();
                   }});
    }
    add_components(m, at + "base_velocity", 6,
                   [s](Plan& p, int i) -> double& { return p.approach.base_velocities[s](i); });
  }
  m.push_back({"late_by", [](Plan& p) { p.approach.late_by = 1e-6; }});
  m.push_back({"min_clearance", [](Plan& p) { p.approach.min_clearance += 0.002; }});
  add_components(m, "approach summary", 3, [](Plan& p, int i) -> double& {
    Approach& a = p.approach;
    return i == 0 ? a.duration : i == 1 ? a.path_length : a.attitude_excursion;
  });
  return m;
}

}  // namespace

TEST_CASE("a relative error of 1e-6 in any physical number of a plan is found") {
  VerifyOptions options;
  options.post_impact = false;
  options.cone_samples = 200;
  Plan plan = arm_plan();
  plan.problem.approach.clearance = 0;
  const Verification before = judge_plan(plan, options);
  for (const Claim& claim : before.claims) {
    if (claim.name == "approach_clearance") plan.approach.min_clearance = claim.value.value();
  }
  REQUIRE(judge_plan(plan, options).pass);
  const std::vector<Mutation> mutations = all_mutations(plan);
  CHECK(mutations.size() > 140);
  for (const Mutation& mutation : mutations) {
    Plan changed = plan;
    mutation.apply(changed);
    INFO(mutation.name);
    CHECK_FALSE(judge_plan(changed, options).pass);
  }
}
