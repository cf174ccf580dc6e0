// What a plan says about the curves that its candidates are on.
#include <catch2/catch.hpp>

#include <algorithm>

#include <stillbase/io/problem_file.hpp>
#include <stillbase/planner/planner.hpp>
#include <stillbase/verification/verification.hpp>

namespace stillbase {
namespace {

/// Zeros on curves and minima beside them, by the predicted value alone.
const Plan& plan_with_families() {
  static const Plan plan = [] {
    CaptureProblem problem =
        read_problem(std::string(STILLBASE_SOURCE_DIR) + "/problems/planar_three_link_client.yaml");
    problem.measure.kind = RiskMeasure::Nominal;
    problem.search.max_candidates = 100;
    return make_plan(problem);
  }();
  return plan;
}

bool holds(const Plan& plan, const std::string& name) {
  for (const Claim& claim : verify_plan(plan).claims) {
    if (claim.name == name) return claim.pass;
  }
  return false;
}

}  // namespace

TEST_CASE("a plan with curves of solutions is verified, and what it misstates of them is found") {
  const Plan& plan = plan_with_families();
  REQUIRE(plan.families.size() >= 2);
  CHECK(holds(plan, "families_vanish"));
  CHECK(holds(plan, "candidates_list"));

  Plan more_starts = plan;
  ++more_starts.families[0].starts;
  CHECK_FALSE(holds(more_starts, "candidates_list"));

  // A candidate that no start reached is one of a curve, or it is made up.
  Plan alone = plan;
  alone.candidates[0].family = -1;
  alone.candidates[0].starts_reached = 0;
  CHECK_FALSE(holds(alone, "candidates_list"));

  Plan elsewhere = plan;
  const auto off_zero =
      std::find_if(elsewhere.candidates.begin(), elsewhere.candidates.end(),
                   [](const Candidate& candidate) { return candidate.objective > 1e-4; });
  REQUIRE(off_zero != elsewhere.candidates.end());
  off_zero->family = 0;
  CHECK_FALSE(holds(elsewhere, "families_vanish"));
}

}  // namespace stillbase
