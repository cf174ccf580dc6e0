// A plan whose proof is about base attitude and contact time as well, and states wrong ones.
#include <catch2/catch.hpp>

#include <functional>

#include <stillbase/planner/planner.hpp>

#include "support/shipped_problem.hpp"
#include "verification/failed_claims.hpp"

namespace stillbase {
namespace {

/// One joint, base angle and contact time: the hand head-on at a client that turns about z.
CaptureProblem turning_client() {
  CaptureProblem problem = test::shipped("planar_three_link_client");
  problem.variables.joints = {false, true, false};
  problem.variables.base_attitude_max = 3.14159265358979323846;
  problem.variables.contact_time_lower = 50;
  problem.variables.contact_time_upper = 90;
  problem.measure.kind = RiskMeasure::Nominal;
  problem.approach.enabled = false;
  return problem;
}

const Plan& plan_of_turning_client() {
  static const Plan plan = make_plan(turning_client());
  return plan;
}

}  // namespace

TEST_CASE("a proof over joints, base angle and contact time agrees with a recount") {
  const Plan& plan = plan_of_turning_client();
  const Proof& proof = plan.certificate.proof;
  CAPTURE(proof.statement);
  CHECK(proof.status == ProofStatus::Complete);
  REQUIRE_FALSE(proof.solutions.empty());
  for (const int c : proof.candidates) CHECK(c >= 0);
  CHECK(proof.solutions.front().base_angle);
  CHECK(proof.solutions.front().contact_time);
  CHECK(failures(plan).empty());
}

TEST_CASE("wrong base angles and times of enclosures are found") {
  const std::pair<const char*, std::function<void(JointBox&)>> lies[] = {
      {"angle",
       [](JointBox& box) {
         box.base_angle->lower += 1e-4;
         box.base_angle->upper += 1e-4;
       }},
      {"time",
       [](JointBox& box) {
         box.contact_time->lower += 1e-3;
         box.contact_time->upper += 1e-3;
       }},
      {"no angle", [](JointBox& box) { box.base_angle.reset(); }},
      {"no time", [](JointBox& box) { box.contact_time.reset(); }}};
  for (const auto& [name, lie] : lies) {
    INFO(name);
    Plan plan = plan_of_turning_client();
    lie(plan.certificate.proof.solutions.front());
    const std::string found = failures(plan);
    CHECK(found.find("proof_solutions_listed") != std::string::npos);
    CHECK(found.find("proof_recount") != std::string::npos);
  }
}

}  // namespace stillbase
