// Approaches that leave the base's attitude alone.
#include <catch2/catch.hpp>

#include <atomic>

#include <stillbase/reference/reference.hpp>

#include "approach/null_tracker.hpp"
#include "approach/problems.hpp"
#include "approach/shipped_robot.hpp"
#include "verification/path_motion.hpp"

using namespace stillbase;
using namespace stillbase::test;

namespace {

/// Largest rotation angle of the base by the second implementation of the dynamics.
double rotation_angle(const RobotModel& robot, const Approach& a) {
  Pose pose;
  double largest = 0;
  for (std::size_t i = 0; i + 1 < a.times.size(); ++i) {
    const verification::HermiteSegment segment(a, i);
    pose = verification::drifted_base(robot, segment, pose, 0.005);
    largest = std::max(largest, rotation_log(pose.orientation).norm());
  }
  return largest;
}

CaptureProblem arm_problem() {
  CaptureProblem problem =
      problem_for(shipped_robot("iiwa_on_cube"), posture({20, 40, 0, -60, 10, 50, 0}));
  problem.approach.velocity_scale = 0.05;
  return problem;
}

}  // namespace

TEST_CASE("a seven-joint arm reaches a set of postures without turning the base") {
  CaptureProblem problem = arm_problem();
  // A posture that can be reached: the end of the curve that follows the line to `far`.
  const JointVectord far = posture({60, 60, 20, -40, 0, 30, 40});
  Knots knots(7, 5);
  for (int k = 0; k < 5; ++k) knots.col(k) = problem.start + k / 4.0 * (far - problem.start);
  const NullTracker tracker(problem.robot, problem.start, {0, 1, 2, 3, 4, 5, 6});
  const Configuration goal = goal_at(tracker.follow(knots, 20).phi.back(), 400);
  REQUIRE((goal.phi - problem.start).norm() > 0.5);
  problem.approach.base = BaseMode::Floating;
  const Approach plain = plan(problem, goal);
  REQUIRE(plain.status == ApproachStatus::Found);
  CHECK(rotation_angle(problem.robot, plain) > 0.05 * kDegree);

  // Any posture with joints 2 and 4 as in the goal is as good, the best one has joint 6 as well.
  ContactSolver contact;
  contact.near_posture = [&](const JointVectord& phi, ContactSolve how) {
    Configuration near = goal;
    near.phi = phi;
    for (const int k : {1, 3}) near.phi[k] = goal.phi[k];
    if (how == ContactSolve::Best) near.phi[5] = goal.phi[5];
    return std::optional<Configuration>(near);
  };
  contact.measure = [&](const Configuration& end) { return std::abs(end.phi[5] - goal.phi[5]); };
  problem.approach.base = BaseMode::ReactionNull;
  const auto plan_still = [&] {
    std::map<std::string, long> calls;
    return plan_approach(problem, goal, nullptr, 1, {}, calls, contact);
  };
  const Approach still = plan_still();
  INFO(still.detail);
  REQUIRE(still.status == ApproachStatus::Found);
  for (const int k : {1, 3, 5}) CHECK(still.joint_positions.back()[k] == goal.phi[k]);
  CHECK(rotation_angle(problem.robot, still) < 0.01 * kDegree);
  CHECK(still.attitude_excursion < 0.01 * kDegree);
  CHECK(plan_still().joint_positions == still.joint_positions);
}

TEST_CASE("a curve that is stopped gets to no goal") {
  const CaptureProblem problem = arm_problem();
  std::atomic<bool> interrupted{false};
  StopCondition stop;
  stop.interrupted = &interrupted;
  const std::vector<Eigen::Index> all{0, 1, 2, 3, 4, 5, 6};
  const NullTracker tracker(problem.robot, problem.start, all, {}, 1, stop);
  // Somewhere beside the end of the straight reference, which itself does not get there.
  Configuration goal;
  Knots straight(7, 5);
  for (int k = 0; k < 5; ++k) {
    straight.col(k) = problem.start + k / 4.0 * posture({10, 5, 5, 5, 0, 5, 5});
  }
  goal.phi = tracker.follow(straight, 20).phi.back() + JointVectord::Constant(7, 0.002);
  const auto there = [&](const JointVectord&) { return std::optional<Configuration>(goal); };
  JointPath curve;
  Knots knots = straight;
  REQUIRE(tracker.reach(there, knots, curve));
  interrupted = true;
  knots = straight;
  CHECK_FALSE(tracker.reach(there, knots, curve));
  CHECK(knots == straight);
}

TEST_CASE("velocities projected into the reaction null space carry no angular momentum") {
  const CaptureProblem problem = arm_problem();
  const NullTracker tracker(problem.robot, problem.start, {0, 1, 2, 3, 4, 5, 6});
  const Eigen::VectorXd wanted = Eigen::VectorXd::LinSpaced(7, -1, 1);
  const Eigen::VectorXd kept = tracker.projected(problem.start, wanted);
  const auto d = reference::compute(problem.robot, {problem.start, {}, {}});
  CHECK((d.Htilde_omegaphi * kept).norm() < 1e-12);
  CHECK(kept.norm() > 0.1);
  CHECK(std::abs(kept.dot(wanted - kept)) < 1e-12);  // the nearest one
}

TEST_CASE("two joints reach no other posture without turning the base") {
  CaptureProblem problem = planar_problem(posture({-60, 30}));
  problem.approach.base = BaseMode::ReactionNull;
  const Approach a = plan(problem, goal_at(posture({60, -30}), 300));
  CHECK(a.status == ApproachStatus::UnreachableInBaseMode);
  CHECK(a.detail.find("within the reaction null space 0 end at the goal") != std::string::npos);
}

TEST_CASE("of several goals within the null space one that can be reached is taken") {
  CaptureProblem problem = arm_problem();
  problem.approach.base = BaseMode::ReactionNull;
  const JointVectord far = posture({60, 60, 20, -40, 0, 30, 40});
  Knots knots(7, 5);
  for (int k = 0; k < 5; ++k) knots.col(k) = problem.start + k / 4.0 * (far - problem.start);
  const NullTracker tracker(problem.robot, problem.start, {0, 1, 2, 3, 4, 5, 6});
  const Configuration goal = goal_at(tracker.follow(knots, 20).phi.back(), 400);
  // Nothing solves the contact near the first one; any posture with the goal's joint 4 near the
  // second one.
  ApproachGoal nowhere, somewhere;
  nowhere.configuration = goal_at(far, 400);
  nowhere.contact.near_posture = [](const JointVectord&, ContactSolve) {
    return std::optional<Configuration>();
  };
  somewhere.configuration = goal;
  somewhere.contact.near_posture = [&](const JointVectord& phi, ContactSolve) {
    Configuration near = goal;
    near.phi = phi;
    near.phi[3] = goal.phi[3];
    return std::optional<Configuration>(near);
  };
  // The further joint 1 is from where it started, the better: downhill along the contact.
  somewhere.contact.measure = [&](const Configuration& end) { return 10 - end.phi[0]; };
  std::map<std::string, long> calls;
  const ApproachToAny any = plan_approach_to_any(problem, {nowhere, somewhere}, 1, {}, calls);
  INFO(any.approach.detail);
  REQUIRE(any.approach.status == ApproachStatus::Found);
  CHECK(any.goal == 1);
  CHECK(any.approach.joint_positions.back()[3] == goal.phi[3]);
  CHECK(any.approach.joint_positions.back()[0] > goal.phi[0] + 5 * kDegree);
  CHECK(rotation_angle(problem.robot, any.approach) < 0.01 * kDegree);
}
