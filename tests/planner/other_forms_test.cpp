// The same solution at another roll of the last joint, or whole turns away, as goal of the
// approach.
#include <algorithm>
#include <catch2/catch.hpp>

#include <stillbase/collision/scene.hpp>
#include <stillbase/plan/free_roll.hpp>
#include <stillbase/planner/planner.hpp>
#include <stillbase/planner/post_impact.hpp>
#include <stillbase/search/search.hpp>

#include "planner/candidates.hpp"
#include "planner/other_forms.hpp"
#include "support/shipped_problem.hpp"
#include "verification/failed_claims.hpp"

namespace stillbase {
namespace {

constexpr double kDegree = kPi / 180;

CaptureProblem wide_planar() {
  CaptureProblem problem = test::shipped("planar_two_link_c2_a");
  for (Joint& joint : problem.robot.joints) {
    joint.type = JointType::Revolute;
    joint.lower = -350 * kDegree;
    joint.upper = 350 * kDegree;
  }
  problem.search.starts = 32;
  return problem;
}

}  // namespace

TEST_CASE("the approach leads to the posture that is fewer turns away") {
  CaptureProblem problem = wide_planar();
  problem.post_impact.controllers.clear();
  problem.start = JointVectord(2);
  problem.start << -80 * kDegree, -200 * kDegree;
  // Time for the short way alone: at 0.1 rad/s^2 a turn takes 16 s.
  problem.variables.contact_time_lower = problem.variables.contact_time_upper = 14;
  problem.approach.wait = 0;
  const Plan plan = make_plan(problem);
  REQUIRE(plan.approach.status == ApproachStatus::Found);
  CHECK((plan.configuration.phi - problem.start).cwiseAbs().maxCoeff() < kPi);
  CHECK(failures(plan) == "");
}

TEST_CASE("candidates stand nearest to the start posture, however wide the limits are") {
  CaptureProblem problem = wide_planar();
  problem.approach.enabled = false;
  problem.post_impact.controllers.clear();
  for (Joint& joint : problem.robot.joints) {
    joint.lower = -9000;
    joint.upper = 9000;
  }
  problem.start << 5000, -3000;
  const Plan plan = make_plan(problem);
  REQUIRE_FALSE(plan.candidates.empty());
  for (const Candidate& candidate : plan.candidates) {
    CHECK((candidate.configuration.phi - problem.start).cwiseAbs().maxCoeff() <= kPi + 1e-9);
  }
  CHECK(failures(plan) == "");
}

TEST_CASE("a posture that runs into a stop is taken a turn away from it") {
  CaptureProblem problem = wide_planar();
  problem.approach.enabled = false;
  const SearchResult all = search(problem, Formulation(problem), {});
  const CollisionJudge collisions(problem);
  const PlannerOptions options;
  AfterImpactJudge after(problem, {}, 1, nullptr);
  SearchResult found = all;
  collisions.judge_all(1, {}, found.candidates);
  const auto first = std::find_if(found.candidates.begin(), found.candidates.end(),
                                  [](const Candidate& one) { return one.collision_free; });
  REQUIRE(first != found.candidates.end());
  Candidate& candidate = *first;
  REQUIRE(after.keeps_limits(candidate.configuration));
  // The limits end where its first joint arrives after the impact, on the way that it moves.
  const double rate = impact_at(problem, candidate.configuration).Delta_phidot[0];
  REQUIRE(std::abs(rate) > 1e-3);
  const double angle = candidate.configuration.phi[0];
  Joint& joint = problem.robot.joints[0];
  joint.lower = rate > 0 ? angle - 2 * kPi - 3 : angle - 1e-4;
  joint.upper = rate > 0 ? angle + 1e-4 : angle + 2 * kPi + 3;
  AfterImpactJudge there(problem, {}, 1, nullptr);
  REQUIRE_FALSE(there.keeps_limits(candidate.configuration));
  take_forms_that_hold(problem, collisions, options, there, found);
  CHECK(there.keeps_limits(candidate.configuration));
  CHECK(candidate.configuration.phi[0] == Approx(angle + (rate > 0 ? -2 : 2) * kPi));
  CHECK(found.points[static_cast<std::size_t>(first - found.candidates.begin())][0] ==
        candidate.configuration.phi[0]);
}

TEST_CASE("a last body turns like a top unless its masses lie unevenly about the axis") {
  const RobotModel round = test::shipped("iiwa_client_50").robot;
  const int last = round.n() - 1;
  CHECK(turns_like_a_top(round, last));
  CHECK_FALSE(turns_like_a_top(round, last - 1));  // it carries the last one
  const auto turns_with = [&](const auto& change) {
    RobotModel robot = round;
    change(robot.bodies[static_cast<std::size_t>(last)]);
    return turns_like_a_top(robot, last);
  };
  CHECK(turns_with([](Body& body) { body.centroid.z() += 0.1; }));
  CHECK(turns_with([](Body& body) { body.inertia(2, 2) *= 1.1; }));
  CHECK_FALSE(turns_with([](Body& body) { body.centroid.y() += 1e-3; }));
  CHECK_FALSE(turns_with([](Body& body) { body.inertia(0, 0) *= 1.01; }));
  CHECK_FALSE(turns_with([](Body& body) { body.inertia(0, 2) = body.inertia(2, 0) = 1e-4; }));
}

TEST_CASE("what another joint exceeds after the impact it exceeds at every roll of a free one") {
  const CaptureProblem problem = test::shipped("iiwa_client_50");
  SearchOptions few;
  few.starts = 8;
  SearchResult found = search(problem, Formulation(problem), few);
  const CollisionJudge collisions(problem);
  collisions.judge_all(1, {}, found.candidates);
  AfterImpactJudge after(problem, {}, 1, nullptr);
  const std::string& rolled = problem.robot.joints.back().name;
  int failing = 0;
  for (std::size_t i = 0; i < found.candidates.size() && failing < 3; ++i) {
    const Configuration& at = found.candidates[i].configuration;
    const std::vector<Configuration> rolls = other_rolls_of(problem, found, i, 4);
    const std::string failure = after.failure(at);
    if (rolls.empty() || failure.empty() || failure.starts_with(rolled)) continue;
    ++failing;
    CAPTURE(i, failure);
    for (const Configuration& roll : rolls) CHECK(after.failure(roll) == failure);
  }
  CHECK(failing > 0);
}

TEST_CASE("the approach leads to another roll where there is no path to the first one") {
  CaptureProblem problem = test::shipped("mounted_six_joint");
  problem.post_impact.controllers.clear();
  const int last = problem.robot.hand_body;
  // The last joint hardly moves until the contact.
  problem.robot.joints[static_cast<std::size_t>(last)].max_velocity = 0.02;
  PlannerOptions options;
  options.prover = nullptr;
  const Plan plan = make_plan(problem, options);
  REQUIRE(plan.approach.status == ApproachStatus::Found);
  CHECK(plan.configuration.phi[last] == Approx(problem.start[last]).margin(0.05));
  CHECK(failures(plan) == "");
  options.jobs = 1;
  const Plan again = make_plan(problem, options);
  CHECK(again.configuration.phi == plan.configuration.phi);
  CHECK(again.approach.joint_positions == plan.approach.joint_positions);
}

}  // namespace stillbase
