// A plan of the planner itself, with one number of its lists off by a millionth or one solution
// taken out of every list.
#include <catch2/catch.hpp>

#include <functional>

#include <stillbase/planner/planner.hpp>

#include "support/shipped_problem.hpp"
#include "verification/failed_claims.hpp"

namespace stillbase {
namespace {

constexpr double kFactor = 1 + 1e-6;

const Plan& two_link_plan() {
  static const Plan plan = make_plan(test::shipped("planar_two_link_c2_a"));
  return plan;
}

}  // namespace

TEST_CASE("a solution that is removed from every list is found by an own search") {
  Plan plan = two_link_plan();
  REQUIRE(failures(plan).empty());
  Proof& proof = plan.certificate.proof;
  REQUIRE(proof.solutions.size() == 8);
  // The last one and its candidate vanish; every count is made to fit.
  const int candidate = proof.candidates.back();
  proof.solutions.pop_back();
  proof.candidates.pop_back();
  for (int& c : proof.candidates) c -= c > candidate;
  plan.candidates.erase(plan.candidates.begin() + candidate);
  plan.certificate.distinct_solutions = 7;
  proof.found_by_search = std::min(proof.found_by_search, 7);
  const std::size_t at = proof.statement.find("8 solutions");
  REQUIRE(at != std::string::npos);
  proof.statement.replace(at, 1, "7");
  CHECK(failures(plan).find("proof_recount") != std::string::npos);
}

TEST_CASE("the statement of a proof has to fit its lists") {
  const std::vector<std::pair<const char*, std::function<void(Proof&)>>> lies = {
      {"boxes", [](Proof& p) { p.boxes = 1; }},
      {"statement", [](Proof& p) { p.statement = "trust me"; }},
      {"count in the statement", [](Proof& p) { p.statement = "proven complete: 9 solutions"; }},
      {"lower bound", [](Proof& p) { p.lower_bound = -1; }},
      {"gap", [](Proof& p) { p.gap = 1e-12; }},
      {"undecided", [](Proof& p) { p.undecided = {p.solutions[0]}; }},
  };
  for (const auto& [name, lie] : lies) {
    Plan plan = two_link_plan();
    lie(plan.certificate.proof);
    INFO(name);
    CHECK(failures(plan).find("proof_statement") != std::string::npos);
  }
}

TEST_CASE("a relative error of 1e-6 in any number of the other candidates is found") {
  const std::size_t count = two_link_plan().candidates.size();
  REQUIRE(count > 2);
  for (std::size_t i = 0; i < count; ++i) {
    Plan plan = two_link_plan();
    plan.candidates[i].worst_case *= kFactor;
    INFO("candidate " << i);
    CHECK_FALSE(failures(plan).empty());
  }
}

TEST_CASE("a relative error of 1e-6 in the nominal optimum is found") {
  REQUIRE(two_link_plan().nominal_optimum);
  const std::vector<std::pair<const char*, std::function<void(NominalOptimum&)>>> changes = {
      {"worst case", [](NominalOptimum& o) { o.worst_case *= kFactor; }},
      {"joint 1", [](NominalOptimum& o) { o.configuration.phi[0] *= kFactor; }},
      {"joint 2", [](NominalOptimum& o) { o.configuration.phi[1] *= kFactor; }},
  };
  for (const auto& [name, change] : changes) {
    Plan plan = two_link_plan();
    change(*plan.nominal_optimum);
    INFO(name);
    CHECK_FALSE(failures(plan).empty());
  }
}

TEST_CASE("only a plan that a limit ended leaves its nominal optimum out") {
  Plan plan = two_link_plan();
  plan.nominal_optimum.reset();
  CHECK(failures(plan) == "nominal_optimum_stated ");
  plan.status = PlanStatus::Limit;
  CHECK(failures(plan).find("nominal_optimum_stated") == std::string::npos);
}

TEST_CASE("tolerances and words of a plan that differ from the format's are found") {
  const std::vector<std::pair<const char*, std::function<void(Plan&)>>> changes = {
      {"rank_tolerance", [](Plan& p) { p.impact.rank_tolerance *= kFactor; }},
      {"case_tolerance", [](Plan& p) { p.impact.judgement.tolerance *= kFactor; }},
      {"candidates_collision_named",
       [](Plan& p) {
         Candidate& first = p.candidates[0];
         first.collision = first.collision_free ? "a with b" : "";
       }},
  };
  for (const auto& [name, change] : changes) {
    Plan plan = two_link_plan();
    change(plan);
    INFO(name);
    CHECK(failures(plan).find(name) != std::string::npos);
  }
}

}  // namespace stillbase
