// What a plan says of all its solutions is held against the candidates and the second dynamics.
#include <catch2/catch.hpp>

#include <stillbase/audit/audit.hpp>

#include "verification/example_plans.hpp"

using namespace stillbase;
using namespace stillbase::verification_test;

namespace {

/// The straight arm hit along its axis, as if it were the only solution.
Plan proven_plan() {
  Plan plan = straight_plan();
  Proof& proof = plan.certificate.proof;
  proof.status = ProofStatus::Complete;
  proof.solutions = {{JointVectord::Constant(2, -1e-13), JointVectord::Constant(2, 1e-13)}};
  proof.candidates = {0};
  proof.found_by_search = 1;
  return plan;
}

bool passes(const Plan& plan, const std::string& name) {
  VerifyOptions options;
  options.post_impact = false;
  options.cone_samples = 100;
  for (const Claim& claim : judge_plan(plan, options).claims) {
    if (claim.name == name) return claim.pass;
  }
  return false;
}

const char* const kClaims[] = {"proof_residual", "proof_solutions_listed",
                               "proof_candidates_enclosed"};

}  // namespace

TEST_CASE("enclosed solutions that are the candidates pass") {
  for (const char* claim : kClaims) {
    INFO(claim);
    CHECK(passes(proven_plan(), claim));
  }
}

TEST_CASE("an enclosed posture that is no solution is found") {
  Plan plan = proven_plan();
  plan.certificate.proof.solutions.push_back(
      {JointVectord::Constant(2, 0.5), JointVectord::Constant(2, 0.5)});
  plan.certificate.proof.candidates.push_back(-1);
  CHECK_FALSE(passes(plan, "proof_residual"));
  CHECK_FALSE(passes(plan, "proof_solutions_listed"));
}

TEST_CASE("a solution assigned to the wrong candidate is found") {
  Plan plan = proven_plan();
  plan.certificate.proof.candidates = {7};
  CHECK_FALSE(passes(plan, "proof_solutions_listed"));
}

TEST_CASE("a candidate outside all enclosures is found") {
  Plan plan = proven_plan();
  REQUIRE_FALSE(plan.candidates.empty());
  Candidate other = plan.candidates.front();
  other.configuration.phi[0] += 1e-3;
  plan.candidates.push_back(other);
  CHECK_FALSE(passes(plan, "proof_candidates_enclosed"));
  // Of a proof that leaves places open, in one of these.
  plan.certificate.proof.status = ProofStatus::Undecided;
  CHECK_FALSE(passes(plan, "proof_candidates_enclosed"));
  const JointVectord& phi = other.configuration.phi;
  plan.certificate.proof.undecided = {{phi, phi}};
  CHECK(passes(plan, "proof_candidates_enclosed"));
}

TEST_CASE("a full rotation of a joint without limits is the same candidate") {
  Plan plan = proven_plan();
  for (JointBox& box : plan.certificate.proof.solutions) {
    box.lower[1] += 2 * M_PI;
    box.upper[1] += 2 * M_PI;
  }
  const bool endless = plan.problem.robot.joints[1].type == JointType::Continuous;
  CHECK(passes(plan, "proof_solutions_listed") == endless);
}
