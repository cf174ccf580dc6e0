// What a plan says of the least measure there is, held against its candidates and against a search
// by the second dynamics.
#include <catch2/catch.hpp>

#include <functional>

#include <stillbase/io/problem_file.hpp>
#include <stillbase/planner/planner.hpp>

#include "verification/failed_claims.hpp"

namespace stillbase {
namespace {

const Plan& plan_of_null() {
  static const Plan plan = [] {
    CaptureProblem problem =
        read_problem(std::string(STILLBASE_SOURCE_DIR) + "/problems/planar_three_link_null.yaml");
    problem.approach.enabled = false;
    problem.post_impact.controllers.clear();
    return make_plan(problem);
  }();
  return plan;
}

}  // namespace

TEST_CASE("a proven bound passes") {
  REQUIRE(plan_of_null().certificate.proof.lower_bound.value_or(0) > 0);
  CHECK(failures(plan_of_null()).empty());
}

TEST_CASE("a bound that says too much is found out") {
  const std::vector<std::pair<const char*, std::function<void(Plan&)>>> lies = {
      {"proof_bound ", [](Plan& p) { *p.certificate.proof.lower_bound *= 1.001; }},
      {"proof_bound_statement", [](Plan& p) { *p.certificate.proof.gap *= 1 + 1e-6; }},
      {"proof_bound_statement", [](Plan& p) { p.certificate.proof.gap.reset(); }},
      {"proof_bound_statement", [](Plan& p) { p.certificate.proof.statement = "proven: trust"; }},
      {"proof_bound_statement", [](Plan& p) { p.certificate.proof.boxes = 0; }}};
  for (const auto& [claim, lie] : lies) {
    Plan plan = plan_of_null();
    lie(plan);
    INFO(claim);
    CHECK(failures(plan).find(claim) != std::string::npos);
  }
}

TEST_CASE("better postures that were kept quiet are found by a search of its own") {
  Plan plan = plan_of_null();
  Proof& proof = plan.certificate.proof;
  // As if the worst of the candidates were the best there is.
  proof.lower_bound = plan.candidates.back().value * 0.999;
  CHECK(failures(plan).find("proof_bound_searched") != std::string::npos);
}

}  // namespace stillbase
