// Solutions that nearly coincide: a hand at the edge of the arm's reach, and a C2 fold. A solver's
// tolerance does not tell them apart, so that proofs call them undecided.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

#include <stillbase/planner/planner.hpp>

#include "support/shipped_problem.hpp"
#include "verification/failed_claims.hpp"

namespace stillbase {
namespace {

/// The hand `beyond` the full stretch of both links, 4 m from the shoulder at (1.4, 0) m.
CaptureProblem stretched(double beyond) {
  CaptureProblem problem = test::without_path("planar_two_link_c2_a");
  problem.constraints.impact_case = CaseConstraint::None;
  problem.hand.constraint = HandConstraint::Position;
  problem.hand.frame = Frame::Base;
  problem.hand.position = Vector3d(5.4 + beyond, 0, 0);
  problem.search.starts = 64;
  return problem;
}

bool is_within(const JointBox& box, const JointVectord& phi) {
  return (phi - box.lower).minCoeff() >= -1e-9 && (box.upper - phi).minCoeff() >= -1e-9;
}

/// Neither the statement nor the bound of a plan contradicts what its search found.
void check_agreement(const Plan& plan) {
  const Proof& proof = plan.certificate.proof;
  CAPTURE(proof.statement, proof.boxes, plan.candidates.size());
  REQUIRE(plan.status == PlanStatus::Optimal);
  CHECK(proof.statement.find("there is no solution") == std::string::npos);
  for (const Candidate& candidate : plan.candidates) {
    const auto holds = [&](const JointBox& box) {
      return is_within(box, candidate.configuration.phi);
    };
    const bool is_enclosed = std::any_of(proof.solutions.begin(), proof.solutions.end(), holds) ||
                             std::any_of(proof.undecided.begin(), proof.undecided.end(), holds) ||
                             std::count(proof.candidates.begin(), proof.candidates.end(),
                                        static_cast<int>(&candidate - plan.candidates.data())) == 1;
    CHECK(is_enclosed);
    if (proof.lower_bound) CHECK(candidate.value >= *proof.lower_bound * (1 - 1e-12));
  }
  // Some of these postures touch the base.
  const std::string failed = failures(plan);
  CHECK(failed.find("proof_") == std::string::npos);
  CHECK(failed.find("candidates_") == std::string::npos);
}

}  // namespace

TEST_CASE("a hand at the edge of its reach is undecided, not proven to have no posture") {
  for (const double beyond : {0.0, 1e-15, 1e-12, 1e-10, 9e-10, -1e-15, -1e-12, -1e-10}) {
    CAPTURE(beyond);
    const Plan plan = make_plan(stretched(beyond));
    CHECK(plan.certificate.proof.status == ProofStatus::Undecided);
    CHECK(plan.certificate.proof.undecided.size() == 1);
    CHECK(plan.certificate.proof.boxes < 2000);
    check_agreement(plan);
  }
}

TEST_CASE("postures near the edge of the reach are proven where the tolerance tells them apart") {
  for (const double inside : {1e-7, 1e-6, 1e-5, 1e-3}) {
    CAPTURE(inside);
    const Plan plan = make_plan(stretched(-inside));
    CHECK(plan.certificate.proof.status == ProofStatus::Complete);
    CHECK(plan.certificate.proof.solutions.size() == 2);
    CHECK(plan.candidates.size() == 2);
    check_agreement(plan);
  }
}

TEST_CASE("a hand beyond its reach by more than the tolerance has no posture") {
  const Plan plan = make_plan(stretched(1e-7));
  CHECK(plan.status == PlanStatus::Infeasible);
  CHECK(plan.certificate.proof.status == ProofStatus::Complete);
  CHECK(plan.certificate.proof.statement.find("there is no solution") != std::string::npos);
}

TEST_CASE("two C2 postures that merge at a direction of the impulse are undecided there") {
  // They merge near 18.7918577 deg, and have a residual below 1e-9 a little beyond.
  for (const double degrees : {18.791857, 18.79185771, 18.79185772, 18.79185773}) {
    CaptureProblem problem = test::without_path("planar_two_link_c2_a");
    const double angle = degrees * kPi / 180;
    problem.impulse.direction = Vector3d(std::cos(angle), std::sin(angle), 0);
    problem.search.starts = 128;
    const Plan plan = make_plan(problem);
    CAPTURE(degrees);
    CHECK(plan.certificate.proof.status == ProofStatus::Undecided);
    CHECK(plan.certificate.proof.solutions.size() == 8);
    CHECK(plan.certificate.proof.undecided.size() == 1);
    check_agreement(plan);
  }
}

}  // namespace stillbase
