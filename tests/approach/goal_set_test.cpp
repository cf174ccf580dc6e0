// One run of the planner for several goals.
#include <catch2/catch.hpp>

#include "approach/problems.hpp"

using namespace stillbase;
using namespace stillbase::test;

namespace {

constexpr double kShoulder = 1.4;

ApproachToAny plan_any(const CaptureProblem& problem, const std::vector<ApproachGoal>& goals,
                       std::uint64_t seed = 1, const ApproachOptions& options = {}) {
  std::map<std::string, long> calls;
  return plan_approach_to_any(problem, goals, seed, {}, calls, options);
}

ApproachGoal towards(const Configuration& configuration, double weight = 1) {
  ApproachGoal goal;
  goal.configuration = configuration;
  goal.weight = weight;
  return goal;
}

/// Link 1 can be on either side of a ball and not pass it.
CaptureProblem beside_a_ball() {
  CaptureProblem problem = planar_problem(posture({-60, 30}));
  problem.robot.joints[0].type = JointType::Revolute;
  problem.robot.joints[0].lower = -100 * kDegree;
  problem.robot.joints[0].upper = 100 * kDegree;
  problem.obstacles = {{"ball", Frame::Base,
                        Pose{Vector3d(kShoulder + 1, 0, 0), Eigen::Quaterniond::Identity()},
                        Sphere{0.2}}};
  problem.approach.max_iterations = 3000;
  return problem;
}

}  // namespace

TEST_CASE("a goal that cannot be reached does not prevent the approach to one that can") {
  CaptureProblem problem = beside_a_ball();
  const Configuration behind = goal_at(posture({60, 10})), beside = goal_at(posture({-30, 60}));
  REQUIRE(plan(problem, behind).status == ApproachStatus::GoalUnreachable);
  problem.approach.max_iterations = 20000;
  for (const std::string& name : approach_planner_names()) {
    INFO(name);
    problem.approach.planner = name;
    const ApproachToAny any = plan_any(problem, {towards(behind), towards(beside)});
    INFO(any.approach.detail);
    REQUIRE(any.approach.status == ApproachStatus::Found);
    CHECK(any.goal == 1);
    check_motion(problem, beside, any.approach);
    CHECK(any.approach.detail.find("goal 2 of a set of 2") != std::string::npos);
  }
}

TEST_CASE("the best goal of a set is reached, though another one is easier to reach") {
  CaptureProblem problem = beside_a_ball();
  problem.obstacles.front().pose.position.x() = kShoulder + 2.5;  // link 2 has to be folded to pass
  const std::vector<ApproachGoal> goals = {towards(goal_at(posture({60, 10}))),
                                           towards(goal_at(posture({-50, 40})))};
  ApproachOptions at_once;
  at_once.path.iterations_to_best = 0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const ApproachToAny any = plan_any(problem, goals, seed);
    INFO(any.approach.detail);
    REQUIRE(any.approach.status == ApproachStatus::Found);
    CHECK(any.goal == 0);
    CHECK(plan_any(problem, goals, seed, at_once).goal == 1);
  }
}

TEST_CASE("each goal is planned for among its own obstacles") {
  // Two stations of a held base; the ball, fixed in space, blocks the path at the first one alone.
  CaptureProblem problem = beside_a_ball();
  problem.obstacles.front().frame = Frame::Inertial;
  const JointVectord phi = posture({60, 10});
  const Pose away{Vector3d(0, 20, 0), Eigen::Quaterniond::Identity()};
  const ApproachToAny any =
      plan_any(problem, {towards(goal_at(phi)), towards(goal_at(phi, 100, away))});
  INFO(any.approach.detail);
  REQUIRE(any.approach.status == ApproachStatus::Found);
  CHECK(any.goal == 1);
  CHECK(any.approach.base_poses.front().position == away.position);
  CHECK(any.approach.path_length == Approx((phi - problem.start).norm()).epsilon(1e-6));
}

TEST_CASE(
    "goals that are refused at once are left out, and when all are refused the reason is stated") {
  const CaptureProblem problem = beside_a_ball();
  const Configuration touching = goal_at(posture({0, 0})), good = goal_at(posture({-30, 60}));
  CHECK(plan_any(problem, {towards(touching), towards(good)}).goal == 1);
  const ApproachToAny none = plan_any(problem, {towards(touching), towards(touching)});
  CHECK(none.approach.status == ApproachStatus::GoalInvalid);
  CHECK(none.approach.detail.find("ball") != std::string::npos);
}

TEST_CASE("a set of goals gives the same path for the same seed") {
  const CaptureProblem problem = beside_a_ball();
  const std::vector<ApproachGoal> goals = {towards(goal_at(posture({60, 10}))),
                                           towards(goal_at(posture({-30, 120})), 0.3),
                                           towards(goal_at(posture({-80, -120})), 0.3)};
  const ApproachToAny first = plan_any(problem, goals, 7), second = plan_any(problem, goals, 7);
  REQUIRE(first.approach.status == ApproachStatus::Found);
  CHECK(first.goal == second.goal);
  CHECK(first.approach.joint_positions == second.approach.joint_positions);
}

TEST_CASE("empty sets of goals and weights of zero are refused") {
  CaptureProblem problem = beside_a_ball();
  const ApproachGoal goal = towards(goal_at(posture({-30, 60})));
  CHECK_THROWS_AS(plan_any(problem, {}), std::invalid_argument);
  CHECK_THROWS_AS(plan_any(problem, {goal, towards(goal.configuration, 0)}), std::invalid_argument);
  problem.approach.enabled = false;
  CHECK(plan_any(problem, {goal}).approach.status == ApproachStatus::NotRequested);
}
