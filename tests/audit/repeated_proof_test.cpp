// Proofs that a plan states, proven again.
#include <catch2/catch.hpp>

#include <functional>

#include <stillbase/audit/audit.hpp>
#include <stillbase/core/constants.hpp>
#include <stillbase/planner/planner.hpp>

#include "support/shipped_problem.hpp"

namespace stillbase {
namespace {

/// The check of that name among those of the audit.
Claim check_of(const Plan& plan, const std::string& name, const VerifyOptions& options = {}) {
  for (const Claim& claim : audit_plan(plan, options).claims) {
    if (claim.name == name) return claim;
  }
  return {};
}

const Plan& enclosed_plan() {
  static const Plan plan = make_plan(test::without_path("planar_two_link_c2_a"));
  return plan;
}

}  // namespace

TEST_CASE("a proof is repeated, and one that another number of boxes took is refused") {
  REQUIRE(check_of(enclosed_plan(), "proof_repeated").pass);
  const std::vector<std::pair<const char*, std::function<void(Proof&)>>> changes = {
      {"boxes", [](Proof& p) { ++p.boxes; }},
      {"statement", [](Proof& p) { p.statement.replace(0, 6, "proved"); }},
      {"undecided", [](Proof& p) { p.undecided = {p.solutions[0]}; }},
      {"solution", [](Proof& p) { p.solutions.back() = p.solutions.front(); }},
      {"status", [](Proof& p) { p.status = ProofStatus::Undecided; }},
  };
  for (const auto& [name, change] : changes) {
    Plan plan = enclosed_plan();
    change(plan.certificate.proof);
    INFO(name);
    CHECK(check_of(plan, "proof_repeated").fails() == (std::string(name) != "solution"));
  }
}

TEST_CASE("a bound is repeated, and one that is too high is refuted or stays unverified") {
  const Plan plan = make_plan(test::without_path("spart_given_push"));
  REQUIRE(plan.certificate.proof.lower_bound.value_or(0) > 0);
  CHECK(check_of(plan, "proof_bound_repeated").pass);
  // As if the best candidates had not been found.
  Plan worse = plan;
  worse.objective.value *= 1.5;
  for (Candidate& candidate : worse.candidates) candidate.value *= 1.5;
  *worse.certificate.proof.lower_bound *= 1.4;
  CHECK(check_of(worse, "proof_bound_repeated").fails());
}

TEST_CASE("where nothing is proven no boxes were examined") {
  Plan plan = make_plan(test::without_path("iiwa_fixed_start"));
  REQUIRE(check_of(plan, "proof_repeated").pass);
  plan.certificate.proof.boxes = 1;
  CHECK(check_of(plan, "proof_repeated").fails());
}

TEST_CASE("a bound that progresses slowly when it is repeated stays unverified after a while") {
  CaptureProblem problem = test::without_path("planar_three_link_cvar");
  problem.measure = {};
  problem.measure.kind = RiskMeasure::WorstCase;
  problem.uncertainty.cone_half_angle = 40 * kPi / 180;
  const Plan plan = make_plan(problem);
  REQUIRE(plan.certificate.proof.lower_bound.value_or(0) > 0);
  const Claim claim = check_of(plan, "proof_bound_repeated");
  CHECK_FALSE(claim.is_checked);
  CHECK_THAT(claim.detail, Catch::Contains("repeated, the bound reaches"));
  const std::string boxes = claim.detail.substr(claim.detail.rfind(" in ") + 4);
  CHECK(std::stol(boxes) < 20'000);
}

TEST_CASE("without a prover a stated proof is not verified") {
  VerifyOptions options;
  options.prover = nullptr;
  const Claim claim = check_of(enclosed_plan(), "proof_repeated", options);
  CHECK_FALSE(claim.is_checked);
  CHECK_FALSE(claim.pass);
  CHECK(claim.detail.find("not verified") != std::string::npos);
}

}  // namespace stillbase
