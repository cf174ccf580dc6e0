// What makes a motion slow, and by how much that has to change.
#include "approach/pace.hpp"

#include "approach/problems.hpp"

namespace stillbase {
namespace {

using test::goal_at;
using test::planar_problem;
using test::posture;

TEST_CASE("the limit that makes a motion slow is the one that makes it faster") {
  CaptureProblem problem = planar_problem(posture({-60, 30, 0}));
  const Configuration goal = goal_at(posture({40, -50, 5}));
  for (Joint& joint : problem.robot.joints) joint.max_effort = kInfinity;
  problem.robot.joints[1].max_velocity = 0.02;
  problem.approach.acceleration_limit.setConstant(10);
  const Pace slow = pace_of_straight_motion(problem, goal, 0);
  CHECK(slow.limit == PaceLimit::Rate);
  CHECK(slow.joint == problem.robot.joints[1].name);
  CHECK_FALSE(slow.factor.has_value());
  const double wanted = slow.duration / 3;
  const Pace rates = pace_of_straight_motion(problem, goal, wanted);
  REQUIRE(rates.factor);
  CHECK(*rates.factor > 2.5);
  CHECK(*rates.factor < 3.5);
  for (Joint& joint : problem.robot.joints) joint.max_velocity *= *rates.factor;
  CHECK(pace_of_straight_motion(problem, goal, 0).duration <= wanted);

  problem.approach.acceleration_limit.setConstant(1e-4);
  const double before = pace_of_straight_motion(problem, goal, 0).duration;
  const Pace sluggish = pace_of_straight_motion(problem, goal, before / 2);
  CHECK(sluggish.limit == PaceLimit::Acceleration);
  REQUIRE(sluggish.factor);
  problem.approach.acceleration_limit *= *sluggish.factor;
  CHECK(pace_of_straight_motion(problem, goal, 0).duration <= before / 2);
  // At any acceleration the rates are left.
  CHECK_FALSE(pace_of_straight_motion(problem, goal, 1e-3).factor.has_value());
}

TEST_CASE("torques that stretch a motion are what limits it") {
  CaptureProblem problem = planar_problem(posture({-60, 30}));
  for (Joint& joint : problem.robot.joints) joint.max_effort = 1e-6;
  const Pace pace = pace_of_straight_motion(problem, goal_at(posture({40, -50})), 1);
  CHECK(pace.limit == PaceLimit::Torque);
  CHECK_FALSE(pace.factor.has_value());
}

}  // namespace
}  // namespace stillbase
