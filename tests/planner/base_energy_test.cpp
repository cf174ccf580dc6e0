// A quantity that is a square: values, bound, gap and unit are those of the energy.
#include <catch2/catch.hpp>

#include <stillbase/audit/audit.hpp>
#include <stillbase/planner/planner.hpp>

#include "support/shipped_problem.hpp"

namespace stillbase {
namespace {

using test::without_path;

double energy_of(const CaptureProblem& problem, const ImpactSummary& impact) {
  const Body& base = problem.robot.base;
  const Vector3d v = impact.Delta_Omega.head<3>(), omega = impact.Delta_Omega.tail<3>();
  return 0.5 * base.mass * v.squaredNorm() + 0.5 * omega.dot(base.inertia * omega);
}

void check_claims(const Plan& plan) {
  for (const Claim& claim : judge_plan(plan).claims) {
    CAPTURE(claim.name, claim.value, claim.limit, claim.detail);
    CHECK_FALSE(claim.fails());
  }
}

}  // namespace

TEST_CASE("the kinetic energy of the base is planned, bounded, verified and audited", "[proofs]") {
  CaptureProblem problem = without_path("planar_three_link_null");
  problem.objective = {{ObjectiveQuantity::BaseEnergy}};
  problem.measure.kind =
      GENERATE(RiskMeasure::Nominal, RiskMeasure::WorstCase, RiskMeasure::Expectation);
  problem.measure.samples = 16;
  problem.search.starts = 16;
  const Plan plan = make_plan(problem);
  CAPTURE(plan.problem.measure.kind, plan.certificate.proof.statement);
  CHECK(plan.status == PlanStatus::Optimal);
  CHECK(plan.objective.unit == "J");
  CHECK(plan.objective.nominal == Approx(energy_of(problem, plan.impact)).epsilon(1e-10));
  CHECK(plan.objective.terms.at("base_energy") == Approx(plan.objective.nominal).epsilon(1e-12));
  CHECK(plan.objective.worst_case >= plan.objective.nominal * (1 - 1e-12));

  const Proof& proof = plan.certificate.proof;
  REQUIRE(proof.lower_bound.has_value());
  CHECK(*proof.lower_bound <= plan.objective.value);
  CHECK(*proof.lower_bound >= plan.objective.value * 0.99);
  CHECK(proof.gap == gap_to_bound(plan));

  check_claims(plan);
}

TEST_CASE("as one of several terms an energy counts by value / size") {
  CaptureProblem problem = without_path("planar_three_link_null");
  problem.objective = {{ObjectiveQuantity::BaseEnergy, 0.02},
                       {ObjectiveQuantity::JointRateNorm, 0.1}};
  problem.search.starts = 8;
  const Plan plan = make_plan(problem);
  CHECK(plan.objective.unit == "1");
  const std::map<std::string, double>& terms = plan.objective.terms;
  const double rates = terms.at("joint_rate_norm") / 0.1;
  CHECK(terms.at("base_energy") == Approx(energy_of(problem, plan.impact)).epsilon(1e-10));
  CHECK(plan.objective.nominal ==
        Approx(std::sqrt(terms.at("base_energy") / 0.02 + rates * rates)).epsilon(1e-10));
  check_claims(plan);
}

}  // namespace stillbase
