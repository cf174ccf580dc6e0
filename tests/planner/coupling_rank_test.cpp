// Case G3 where the coupling matrix has rank 2: its rows are those along two columns.
#include <catch2/catch.hpp>

#include <stillbase/audit/audit.hpp>
#include <stillbase/planner/planner.hpp>

#include "support/shipped_problem.hpp"

namespace stillbase {

TEST_CASE("candidates near postures with parallel columns satisfy the case, not its rows alone") {
  CaptureProblem problem = test::shipped("spart_g2");
  problem.constraints.impact_case = CaseConstraint::G3;
  problem.constraints.clearance.reset();
  problem.measure.kind = RiskMeasure::Nominal;
  problem.approach.enabled = false;
  problem.variables.base_attitude = AttitudeFreedom::Axis;
  problem.variables.base_attitude_axis = Vector3d::UnitY();
  problem.variables.base_attitude_max = M_PI;
  const Plan plan = make_plan(problem);
  REQUIRE(plan.status == PlanStatus::Optimal);
  REQUIRE(plan.candidates.size() > 10);
  for (const Candidate& candidate : plan.candidates) {
    const ImpactSummary impact = impact_at(problem, candidate.configuration);
    CHECK(impact.rank == 2);
    CHECK(impact.judgement.coupling <= 1e-9);
  }
  for (const Claim& claim : judge_plan(plan).claims) {
    INFO(claim.name << ": " << claim.detail);
    CHECK_FALSE(claim.fails());
  }
}

}  // namespace stillbase
