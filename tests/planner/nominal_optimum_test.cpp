// The configuration with the lowest nominal value.
#include <catch2/catch.hpp>

#include <stillbase/planner/planner.hpp>

#include "support/shipped_problem.hpp"

namespace stillbase {

TEST_CASE("no candidate has a lower nominal value than the nominal optimum, few starts or many") {
  CaptureProblem problem = test::without_path("iiwa_cone");
  problem.hand.constraint = HandConstraint::None;
  problem.constraints.joint_limit_margin = 0;
  problem.start << 0.3, -0.6, 0.4, 1.2, 0.2, 0.9, 0.1;
  for (std::size_t k = 0; k < 7; ++k) problem.variables.joints[k] = k == 1 || k == 3;
  for (const std::uint64_t seed : {1u, 4u, 7u}) {
    problem.search.starts = 1;
    problem.search.seed = seed;
    const Plan plan = make_plan(problem);
    REQUIRE(plan.nominal_optimum.has_value());
    CAPTURE(seed, plan.candidates.size());
    for (const Candidate& candidate : plan.candidates) {
      CHECK(candidate.objective >= plan.nominal_optimum->nominal * (1 - 1e-6));
    }
  }
}

}  // namespace stillbase
