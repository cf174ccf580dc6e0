// The bound beside the search.
#include <catch2/catch.hpp>

#include <stillbase/io/problem_file.hpp>
#include <stillbase/planner/planner.hpp>

namespace stillbase {
namespace {

CaptureProblem without_path(const std::string& name) {
  CaptureProblem problem =
      read_problem(std::string(STILLBASE_SOURCE_DIR) + "/problems/" + name + ".yaml");
  problem.approach.enabled = false;
  problem.post_impact.controllers.clear();
  return problem;
}

double best_of(const Plan& plan) {
  double best = kInfinity;
  for (const Candidate& candidate : plan.candidates) best = std::min(best, candidate.value);
  return best;
}

}  // namespace

TEST_CASE("the best worst case of the redundant planar arm is proven to a thousandth") {
  const Plan plan = make_plan(without_path("planar_three_link_null"));
  const Proof& proof = plan.certificate.proof;
  INFO(proof.statement);
  CHECK(proof.status == ProofStatus::Complete);
  CHECK(proof.solutions.size() >= 4);
  REQUIRE(proof.lower_bound.has_value());
  CHECK(*proof.lower_bound <= best_of(plan));
  CHECK(*proof.lower_bound >= best_of(plan) * (1 - 1e-3));
  CHECK(proof.gap == best_of(plan) - *proof.lower_bound);
  CHECK(proof.statement.find("; no posture has a worst case below 1.67") != std::string::npos);
  CHECK(make_plan(without_path("planar_three_link_null")).certificate.proof.lower_bound ==
        proof.lower_bound);
}

TEST_CASE("an objective that vanishes nowhere is bounded although no solution is enclosed") {
  CaptureProblem problem = without_path("planar_three_link_null");
  problem.objective = {{ObjectiveQuantity::JointRateNorm}};
  problem.measure.kind = RiskMeasure::Nominal;
  const Plan plan = make_plan(problem);
  const Proof& proof = plan.certificate.proof;
  INFO(proof.statement);
  CHECK(proof.status == ProofStatus::NotApplicable);
  CHECK(proof.statement.find("proven: no posture has a predicted joint_rate_norm below") == 0);
  REQUIRE(proof.lower_bound.has_value());
  CHECK(*proof.lower_bound >= best_of(plan) * (1 - 1e-3));
  CHECK(*proof.lower_bound <= best_of(plan));
}

TEST_CASE(
    "where the postures of a case are enclosed, the least worst case among them is the bound") {
  CaptureProblem problem = without_path("planar_two_link_c2_a");
  problem.measure.kind = RiskMeasure::WorstCase;
  const Plan plan = make_plan(problem);
  const Proof& proof = plan.certificate.proof;
  INFO(proof.statement);
  CHECK(proof.solutions.size() == 8);
  REQUIRE(proof.lower_bound.has_value());
  CHECK(*proof.lower_bound <= best_of(plan));
  CHECK(*proof.lower_bound >= best_of(plan) * (1 - 1e-3));
}

TEST_CASE("where the best candidate is zero no bound is looked for") {
  const Plan zero = make_plan(without_path("planar_two_link_c2_a"));
  CHECK_FALSE(zero.certificate.proof.lower_bound.has_value());
}

}  // namespace stillbase
