#include <catch2/catch.hpp>

#include <cmath>
#include <cstring>

#include "approach/problems.hpp"
#include "collision/closed_forms.hpp"

using namespace stillbase;
using namespace stillbase::test;

namespace {

/// Distance of a sphere from the capsules of the planar arm, by plane geometry alone.
double arm_clearance(const Eigen::VectorXd& phi, double shoulder_x, const Vector3d& centre,
                     double radius) {
  Vector3d begin(shoulder_x, 0, 0);
  double angle = 0, least = 1e9;
  for (Eigen::Index k = 0; k < phi.size(); ++k) {
    angle += phi[k];
    const Vector3d end = begin + 2 * Vector3d(std::cos(angle), std::sin(angle), 0);
    least = std::min(least, segment_distance(begin, end, centre, centre) - radius - 0.08);
    begin = end;
  }
  return least;
}

double straight_line_clearance(const JointVectord& a, const JointVectord& b, const Vector3d& centre,
                               double radius) {
  double least = 1e9;
  for (int i = 0; i <= 500; ++i) {
    least = std::min(least, arm_clearance(a + i / 500.0 * (b - a), 1.4, centre, radius));
  }
  return least;
}

double stored_clearance(const Approach& a, const Vector3d& centre, double radius) {
  double least = 1e9;
  for (std::size_t i = 0; i + 1 < a.times.size(); ++i) {
    for (int part = 0; part <= 10; ++part) {
      least = std::min(least, arm_clearance(hermite(a, i, part / 10.0).phi, 1.4, centre, radius));
    }
  }
  return least;
}

}  // namespace

TEST_CASE("a path without obstacles is the straight line, at rest at both ends and within limits") {
  const CaptureProblem problem = planar_problem(posture({-60, 30}));
  const Configuration goal = goal_at(posture({40, -50}));
  const Approach a = plan(problem, goal);
  check_motion(problem, goal, a);
  CHECK(a.path_length == Approx((goal.phi - problem.start).norm()).epsilon(1e-6));
  CHECK(a.attitude_excursion == 0);
  CHECK(a.min_clearance > problem.approach.clearance);
  for (const Vector6d& Omega : a.base_velocities) CHECK(Omega.isZero(0));
}

TEST_CASE("an obstacle put on the path changes the path, which then keeps the clearance") {
  CaptureProblem problem = planar_problem(posture({-60, 30}));
  const Configuration goal = goal_at(posture({60, -30}), 200);
  const Vector3d centre(4.5, 0, 0);
  const double radius = 0.3;
  REQUIRE(straight_line_clearance(problem.start, goal.phi, centre, radius) < -0.05);
  const Approach without = plan(problem, goal);
  problem.obstacles = {
      {"panel", Frame::Inertial, Pose{centre, Eigen::Quaterniond::Identity()}, Sphere{radius}}};
  for (const std::uint64_t seed : {1u, 2u, 3u, 4u, 5u}) {
    const Approach with = plan(problem, goal, nullptr, seed);
    check_motion(problem, goal, with);
    CHECK(with.path_length > without.path_length + 0.1);
    CHECK(stored_clearance(with, centre, radius) >= problem.approach.clearance - 1e-4);
    CHECK(with.min_clearance >= problem.approach.clearance - 1e-4);
    CHECK(with.min_clearance <= stored_clearance(with, centre, radius) + 1e-3);
  }
}

TEST_CASE("a post of 5 mm is seen however coarse the steps of the planner are") {
  CaptureProblem problem = planar_problem(posture({-60, 30}));
  problem.robot.shapes = {
      {1, "tip", Pose{Vector3d(2, 0, 0), Eigen::Quaterniond::Identity()}, Sphere{0.002}}};
  problem.approach.resolution = 0.2;
  problem.approach.clearance = 0.005;
  const Configuration goal = goal_at(posture({60, -30}), 200);
  const auto tip = [](const Eigen::VectorXd& phi) -> Vector3d {
    const double a = phi[0], b = phi[0] + phi[1];
    return Vector3d(1.4, 0, 0) +
           2 * Vector3d(std::cos(a) + std::cos(b), std::sin(a) + std::sin(b), 0);
  };
  for (const double place : {0.31, 0.37, 0.46, 0.53, 0.64}) {
    const Vector3d post = tip(problem.start + place * (goal.phi - problem.start));
    problem.obstacles = {
        {"post", Frame::Inertial, Pose{post, Eigen::Quaterniond::Identity()}, Sphere{0.0025}}};
    const Approach a = plan(problem, goal);
    check_motion(problem, goal, a);
    double least = kInfinity;
    for (std::size_t i = 0; i + 1 < a.times.size(); ++i) {
      for (int part = 0; part <= 1000; ++part) {
        least = std::min(least, (tip(hermite(a, i, part / 1000.0).phi) - post).norm());
      }
    }
    INFO("at " << place);
    CHECK(least - 0.0045 > 0);
  }
}

TEST_CASE("the same seed gives the same bytes, another seed another path around an obstacle") {
  CaptureProblem problem = planar_problem(posture({-60, 30, 10}));
  problem.obstacles = {{"panel", Frame::Inertial,
                        Pose{Vector3d(4.5, 0, 0), Eigen::Quaterniond::Identity()}, Sphere{0.3}}};
  const Configuration goal = goal_at(posture({60, -30, -10}), 300);
  const Approach a = plan(problem, goal, nullptr, 7), b = plan(problem, goal, nullptr, 7);
  const Approach c = plan(problem, goal, nullptr, 8);
  REQUIRE(a.status == ApproachStatus::Found);
  CHECK(a.times == b.times);
  CHECK(a.joint_positions == b.joint_positions);
  CHECK(a.joint_velocities == b.joint_velocities);
  CHECK(a.detail == b.detail);
  CHECK((a.times != c.times || a.joint_positions != c.joint_positions));
}

TEST_CASE("the planner's runs are counted under its name") {
  const CaptureProblem problem = planar_problem(posture({-60, 30}));
  std::map<std::string, long> calls;
  const Approach a = plan_approach(problem, goal_at(posture({40, -50})), nullptr, 1, {}, calls);
  CHECK(a.status == ApproachStatus::Found);
  CHECK(calls == std::map<std::string, long>{{"rrt_connect", 1}});
  CHECK(approach_planner_names().front() == "rrt_connect");
}

TEST_CASE("a joint that the search may not change stays where it is") {
  CaptureProblem problem = planar_problem(posture({-60, 30, 10}));
  problem.variables.joints = {true, false, true};
  const Configuration goal = goal_at(posture({60, 30, -10}), 300);
  problem.obstacles = {{"panel", Frame::Inertial,
                        Pose{Vector3d(7.1, 0.5, 0), Eigen::Quaterniond::Identity()}, Sphere{0.2}}};
  const Approach a = plan(problem, goal);
  check_motion(problem, goal, a);
  for (const JointVectord& phi : a.joint_positions) CHECK(phi[1] == problem.start[1]);
}

TEST_CASE("a continuous joint takes the shorter rotation to the goal's angle") {
  CaptureProblem problem = planar_problem(posture({-60, 30}));
  for (Joint& joint : problem.robot.joints) {
    joint.type = JointType::Continuous;
    joint.lower = -kInfinity;
    joint.upper = kInfinity;
  }
  const Configuration goal = goal_at(posture({-50 + 720, 30}));
  const Approach a = plan(problem, goal);
  REQUIRE(a.status == ApproachStatus::Found);
  CHECK(a.path_length == Approx(10 * kDegree).epsilon(1e-6));
  CHECK(a.joint_positions.back() == goal.phi);
  CHECK(wrap_angle(a.joint_positions.front()[0] - problem.start[0]) ==
        Approx(0).epsilon(0).margin(1e-12));
}

TEST_CASE("a robot that starts at its goal only waits") {
  const CaptureProblem problem = planar_problem(posture({-60, 30}));
  const Approach a = plan(problem, goal_at(problem.start));
  REQUIRE(a.status == ApproachStatus::Found);
  CHECK(a.duration == 0);
  CHECK(a.times == std::vector<double>{95, 100});
}

TEST_CASE("start and goal that break a limit or the clearance are named before any planning") {
  CaptureProblem problem = planar_problem(posture({-60, 30}));
  const Configuration good = goal_at(posture({40, -50}));
  std::map<std::string, long> calls;
  const auto status = [&](const CaptureProblem& p, const Configuration& goal,
                          const std::string& words) {
    const Approach a = plan_approach(p, goal, nullptr, 1, {}, calls);
    INFO(a.detail);
    CHECK(a.detail.find(words) != std::string::npos);
    CHECK(a.times.empty());
    return a.status;
  };
  CHECK(status(problem, goal_at(posture({40, 179})), "joint2") == ApproachStatus::GoalInvalid);
  CHECK(status(problem, goal_at(posture({177, 0})), "link1 with base") ==
        ApproachStatus::GoalInvalid);
  problem.start = posture({100, 130});
  CHECK(status(problem, good, "link2 with base") == ApproachStatus::StartInvalid);
  problem.start = posture({-179, 0});
  CHECK(status(problem, good, "joint1") == ApproachStatus::StartInvalid);
  CHECK(calls.empty());
}

TEST_CASE("a goal at the clearance is valid whichever way its distance is rounded") {
  CaptureProblem problem = planar_problem(posture({-60, 30}));
  const Configuration goal = goal_at(posture({40, -50}));
  const Vector3d centre(3.2, 2.6, 0);
  const double gap = arm_clearance(goal.phi, 1.4, centre, 0);
  const auto status = [&](double lacks) {
    const Sphere ball{gap - problem.approach.clearance + lacks};
    problem.obstacles = {
        {"ball", Frame::Inertial, Pose{centre, Eigen::Quaterniond::Identity()}, ball}};
    return plan(problem, goal).status;
  };
  for (const double rounding : {-4e-15, 4e-15, 1e-9}) {
    CAPTURE(rounding);
    CHECK(status(rounding) == ApproachStatus::Found);
  }
  CHECK(status(3e-6) == ApproachStatus::GoalInvalid);
}

TEST_CASE("a goal behind a wall is unreachable, and a reached stop is a time-out") {
  CaptureProblem problem = planar_problem(posture({-60, 0}));
  problem.approach.max_iterations = 500;
  // A wall that the arm cannot pass on either side: joint 1 is limited to +-3.1 rad.
  problem.obstacles = {{"wall", Frame::Inertial,
                        Pose{Vector3d(2.2, 0, 0), Eigen::Quaterniond::Identity()},
                        Box{Vector3d(0.2, 0.2, 1)}}};
  const Configuration goal = goal_at(posture({60, 0}));
  CHECK(plan(problem, goal).status == ApproachStatus::GoalUnreachable);
  const std::atomic<bool> interrupted = true;
  StopCondition stop;
  stop.interrupted = &interrupted;
  std::map<std::string, long> calls;
  CHECK(plan_approach(problem, goal, nullptr, 1, stop, calls).status == ApproachStatus::TimeOut);
}

TEST_CASE("an approach that takes too long says by how many seconds") {
  CaptureProblem problem = planar_problem(posture({-60, 30}));
  const Configuration goal = goal_at(posture({40, -50}));
  const Approach found = plan(problem, goal);
  problem.approach.max_duration = found.duration + problem.approach.wait - 2;
  const Approach late = plan(problem, goal);
  CHECK(late.status == ApproachStatus::TooSlow);
  CHECK(late.detail.find("2.000 s too slow") != std::string::npos);
}

TEST_CASE("an approach that was not asked for is not planned") {
  CaptureProblem problem = planar_problem(posture({-60, 30}));
  problem.approach.enabled = false;
  CHECK(plan(problem, goal_at(posture({40, -50}))).status == ApproachStatus::NotRequested);
}

TEST_CASE("numbers that are not finite never reach the planner") {
  const CaptureProblem good = planar_problem(posture({-60, 30}));
  const Configuration goal = goal_at(posture({40, -50}));
  CaptureProblem problem = good;
  problem.start[0] = std::nan("");
  CHECK_THROWS_AS(plan(problem, goal), std::invalid_argument);
  Configuration bad = goal;
  bad.phi[1] = kInfinity;
  CHECK_THROWS_AS(plan(good, bad), std::invalid_argument);
  bad = goal;
  bad.base.orientation.w() = std::nan("");
  CHECK_THROWS_AS(plan(good, bad), std::invalid_argument);
  problem = good;
  problem.approach.acceleration_limit[0] = 0;
  CHECK_THROWS_AS(plan(problem, goal), std::invalid_argument);
  problem = good;
  problem.approach.planner = "best_first";
  CHECK_THROWS_AS(plan(problem, goal), std::invalid_argument);
}
