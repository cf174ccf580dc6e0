// Whole turns of joints: stated with each candidate, recomputed, and every posture listed once.
#include <catch2/catch.hpp>

#include <stillbase/planner/planner.hpp>

#include "support/shipped_problem.hpp"
#include "verification/failed_claims.hpp"

namespace stillbase {
namespace {

/// Both joints with limits of +-350 deg.
const Plan& plan_with_turns() {
  static const Plan plan = [] {
    CaptureProblem problem = test::without_path("planar_two_link_c2_a");
    for (Joint& joint : problem.robot.joints) {
      joint.type = JointType::Revolute;
      joint.lower = -350 * kPi / 180;
      joint.upper = 350 * kPi / 180;
    }
    return make_plan(problem);
  }();
  return plan;
}

}  // namespace

TEST_CASE("candidates say which whole turns their joints have room for") {
  const Plan& plan = plan_with_turns();
  const Plan endless = make_plan(test::without_path("planar_two_link_c2_a"));
  CHECK(plan.certificate.distinct_solutions == endless.certificate.distinct_solutions);
  CHECK(plan.certificate.proof.status == ProofStatus::Complete);
  CHECK(plan.certificate.proof.solutions.size() == endless.certificate.proof.solutions.size());
  CHECK(plan.certificate.unseen == endless.certificate.unseen);
  REQUIRE(!plan.candidates.empty());
  for (const Candidate& candidate : plan.candidates) {
    // The copy nearest to the start posture. Of an angle of at least 10 deg there is another one.
    std::size_t listed = 0;
    for (std::size_t k = 0; k < 2; ++k) {
      const double angle = candidate.configuration.phi[static_cast<Eigen::Index>(k)];
      CHECK(std::abs(angle - plan.problem.start[static_cast<Eigen::Index>(k)]) <= kPi);
      if (std::abs(angle) < 10 * kPi / 180) continue;
      REQUIRE(listed < candidate.turns.size());
      const JointTurns& turns = candidate.turns[listed++];
      CHECK(turns.joint == plan.problem.robot.joints[k].name);
      CHECK(turns.least == (angle > 0 ? -1 : 0));
      CHECK(turns.most == (angle > 0 ? 0 : 1));
    }
    CHECK(candidate.turns.size() == listed);
  }
  CHECK(failures(plan) == "");
}

TEST_CASE("misstated whole turns and a posture listed twice are found") {
  Plan more = plan_with_turns();
  more.candidates[0].turns[0].most += 1;
  CHECK(failures(more).find("candidates_turns_stated") != std::string::npos);
  Plan fewer = plan_with_turns();
  fewer.candidates[0].turns.pop_back();
  CHECK(failures(fewer).find("candidates_turns_stated") != std::string::npos);
  Plan twice = plan_with_turns();
  Candidate copy = twice.candidates[0];
  for (JointTurns& turns : copy.turns) {
    const int turn = turns.least + turns.most;
    copy.configuration.phi[turns.joint == "joint_1" ? 0 : 1] += 2 * kPi * turn;
    turns = {turns.joint, -std::max(turn, 0), std::max(-turn, 0)};
  }
  twice.candidates.push_back(copy);
  twice.certificate.distinct_solutions += 1;
  CHECK(failures(twice).find("candidates_list") != std::string::npos);
  Plan invented = make_plan(test::without_path("planar_two_link_c2_a"));
  invented.candidates[0].turns = {{"joint_1", -1, 0}};
  CHECK(failures(invented).find("candidates_turns_stated") != std::string::npos);
}

}  // namespace stillbase
