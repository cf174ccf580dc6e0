#include <catch2/catch.hpp>

#include "planner/feature_choice.hpp"

namespace stillbase {
namespace {

Candidate candidate(const std::string& feature, double value) {
  Candidate out;
  out.configuration.phi = JointVectord::Constant(1, value);
  out.configuration.feature = feature;
  out.worst_case = out.value = value;
  out.starts_reached = 1;
  return out;
}

PlanOfFeature plan(const std::string& feature, const std::vector<double>& values,
                   PlanQuality quality, std::size_t chosen = 0) {
  PlanOfFeature out;
  out.quality = quality;
  out.plan.problem.start = JointVectord::Zero(1);
  out.plan.problem.variables.feature = feature;
  out.plan.problem.search.max_candidates = 4;
  out.plan.problem.measure.kind = RiskMeasure::WorstCase;
  for (const double value : values) out.plan.candidates.push_back(candidate(feature, value));
  out.plan.certificate.starts = 10;
  if (values.empty()) return out;
  out.plan.configuration = out.plan.candidates[chosen].configuration;
  out.plan.objective.value = out.plan.objective.worst_case = values[chosen];
  out.plan.certificate.distinct_solutions = static_cast<int>(values.size());
  out.plan.nominal_optimum =
      NominalOptimum{out.plan.configuration, 0, values.back(), values.back()};
  out.plan.solver_calls = {{"sqp", 3}};
  out.plan.status = PlanStatus::Optimal;
  return out;
}

}  // namespace

TEST_CASE("of several features the plan that ranks first is taken, with all candidates in order") {
  const Plan best = best_of_features(
      {plan("a", {2, 3}, PlanQuality::Holds), plan("b", {1, 4}, PlanQuality::Holds)});
  CHECK(best.configuration.feature == "b");
  CHECK(best.problem.variables.feature == "b");
  REQUIRE(best.candidates.size() == 4);
  for (std::size_t i = 0; i < 4; ++i)
    CHECK(best.candidates[i].value == 1.0 + static_cast<double>(i));
  CHECK(best.certificate.starts == 20);
  CHECK(best.certificate.distinct_solutions == 4);
  CHECK(best.solver_calls.at("sqp") == 6);
  CHECK(best.nominal_optimum->configuration.feature == "a");
  CHECK(best.certificate.proof.status == ProofStatus::NotApplicable);
}

TEST_CASE("a plan that holds goes before one that ranks better and does not") {
  for (const PlanQuality less : {PlanQuality::Arrives, PlanQuality::Solved, PlanQuality::Nothing}) {
    const Plan best = best_of_features({plan("a", {1}, less), plan("b", {5}, PlanQuality::Holds)});
    CHECK(best.configuration.feature == "b");
    CHECK(best.candidates.size() == (less == PlanQuality::Nothing ? 1u : 2u));
  }
}

TEST_CASE("the chosen candidate stays in the list however long it is") {
  const Plan best = best_of_features({plan("a", {1, 2, 3, 9}, PlanQuality::Holds, 3),
                                      plan("b", {4, 5, 6, 7}, PlanQuality::Arrives)});
  CHECK(best.configuration.feature == "a");
  REQUIRE(best.candidates.size() == 4);
  CHECK(best.candidates.back().value == 9);
  CHECK(best.certificate.distinct_solutions == 8);
}

TEST_CASE("the sample of a self-motion stays behind the others, and only that of the best plan") {
  PlanOfFeature a = plan("a", {3, 1}, PlanQuality::Holds, 1);
  PlanOfFeature b = plan("b", {4, 2}, PlanQuality::Holds, 1);
  for (PlanOfFeature* one : {&a, &b}) {
    one->plan.candidates.back().starts_reached = 0;
    one->plan.certificate.distinct_solutions = 1;
  }
  const Plan best = best_of_features({b, a});
  CHECK(best.configuration.feature == "a");
  REQUIRE(best.candidates.size() == 3);
  CHECK(best.candidates[0].value == 3);
  CHECK(best.candidates[1].value == 4);
  CHECK(best.candidates[2].value == 1);
  CHECK(best.certificate.distinct_solutions == 2);
}

TEST_CASE("what was not seen is estimated from the starts of all features") {
  PlanOfFeature a = plan("a", {1, 2}, PlanQuality::Holds);
  a.plan.candidates[0].starts_reached = 5;
  a.plan.certificate.unseen = 1.0 / 6;
  PlanOfFeature b = plan("b", {3}, PlanQuality::Arrives);
  b.plan.candidates[0].starts_reached = 4;
  b.plan.certificate.unseen = 0;
  CHECK(best_of_features({a, b}).certificate.unseen == Approx(1.0 / 10));
}

TEST_CASE("with rounds of starts the feature searched least decides what may be missed") {
  PlanOfFeature a = plan("a", {1}, PlanQuality::Holds), b = plan("b", {3}, PlanQuality::Arrives);
  a.plan.status = PlanStatus::Optimal;
  for (PlanOfFeature* one : {&a, &b}) one->plan.certificate.had_rounds = true;
  a.plan.certificate.unseen = 1e-4;
  b.plan.certificate.unseen = 0.04;
  const Plan good = best_of_features({a, b});
  CHECK(good.certificate.unseen == 0.04);
  CHECK(good.status == PlanStatus::Optimal);
  b.plan.certificate.unseen = 0.3;
  CHECK(best_of_features({a, b}).status == PlanStatus::Feasible);
}

TEST_CASE("a choice in which one feature was stopped is stopped") {
  PlanOfFeature a = plan("a", {1}, PlanQuality::Holds);
  PlanOfFeature b = plan("b", {}, PlanQuality::Nothing);
  b.plan.status = PlanStatus::Limit;
  CHECK(best_of_features({a, b}).status == PlanStatus::Limit);
}

}  // namespace stillbase
