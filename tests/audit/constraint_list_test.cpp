// Plans that leave out constraints, or a nominal optimum that the problem does not allow.
#include <catch2/catch.hpp>

#include <algorithm>
#include <functional>

#include <stillbase/planner/planner.hpp>

#include "support/shipped_problem.hpp"
#include "verification/failed_claims.hpp"

namespace stillbase {
namespace {

Plan plan_of(const std::string& name) {
  CaptureProblem problem = test::without_path(name);
  problem.search.starts = 8;
  PlannerOptions options;
  options.prover = nullptr;
  return make_plan(problem, options);
}

}  // namespace

TEST_CASE("every constraint that is taken out of the list is missed, one listed twice as well") {
  const std::string name = GENERATE("servicer_compromise", "planar_three_link_station", "spart_g2",
                                    "iiwa_case_c", "planar_two_link_c2_a");
  const Plan plan = plan_of(name);
  INFO(name);
  REQUIRE(failures(plan).find("constraints_complete") == std::string::npos);
  for (std::size_t i = 0; i < plan.constraints.size(); ++i) {
    const std::string& constraint = plan.constraints[i].name;
    // Equations of a case that others imply are listed beyond what is demanded; neighbouring shapes
    // that never touch are.
    if (constraint.rfind("case_", 0) == 0 || constraint.rfind("clearance_", 0) == 0) continue;
    Plan without = plan;
    without.constraints.erase(without.constraints.begin() + static_cast<std::ptrdiff_t>(i));
    INFO(constraint);
    CHECK(failures(without).find("constraints_complete") != std::string::npos);
  }
  Plan empty = plan;
  empty.constraints.clear();
  CHECK(failures(empty).find("constraints_complete") != std::string::npos);
  Plan twice = plan;
  twice.constraints.push_back(twice.constraints.front());
  CHECK(failures(twice).find("constraints_complete") != std::string::npos);
}

TEST_CASE("equations of a case and clearances are missed as well") {
  const std::string name = GENERATE("iiwa_case_c", "planar_two_link_c2_a", "spart_g2");
  Plan plan = plan_of(name);
  INFO(name);
  std::erase_if(plan.constraints,
                [](const ConstraintValue& c) { return c.name.rfind("case_", 0) == 0; });
  CHECK(failures(plan).find("constraints_complete") != std::string::npos);
  Plan far = plan_of("servicer_compromise");
  std::erase_if(far.constraints,
                [](const ConstraintValue& c) { return c.name == "clearance_1_8_base_target"; });
  CHECK(failures(far).find("constraints_complete") != std::string::npos);
}

TEST_CASE("a nominal optimum that the problem does not allow is refused") {
  const std::vector<std::pair<const char*, std::function<void(Configuration&)>>> changes = {
      {"station", [](Configuration& c) { c.base.position.x() = 1e300; }},
      {"time", [](Configuration& c) { c.contact_time += 1; }},
      {"posture", [](Configuration& c) { c.phi[0] += 1; }},
  };
  for (const char* name : {"servicer_6dof_held", "iiwa_cone"}) {
    const Plan plan = plan_of(name);
    REQUIRE(plan.nominal_optimum);
    REQUIRE(failures(plan).find("nominal_optimum") == std::string::npos);
    for (const auto& [what, change] : changes) {
      Plan altered = plan;
      change(altered.nominal_optimum->configuration);
      INFO(name << ": " << what);
      CHECK(failures(altered).find("nominal_optimum_allowed") != std::string::npos);
    }
  }
}

}  // namespace stillbase
