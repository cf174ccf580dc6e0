#include <catch2/catch.hpp>

#include "approach/problems.hpp"
#include "collision/closed_forms.hpp"

using namespace stillbase;
using namespace stillbase::test;

namespace {

/// The paper's point mass on a straight line, at `contact` at time t_c.
TargetMotion flying(const Vector3d& contact, const Vector3d& velocity, double contact_time) {
  TargetState state;
  state.time = contact_time;
  state.pose.position = contact;
  state.linear_velocity = velocity;
  return TargetMotion(point_target(), state, 1000);
}

CaptureProblem point_mass_problem(const JointVectord& start) {
  CaptureProblem problem = planar_problem(start);
  problem.target = point_target();
  problem.impulse.direction = -Vector3d::UnitX();
  return problem;
}

}  // namespace

TEST_CASE("a target that moves along its direction is captured at the hand") {
  const CaptureProblem problem = point_mass_problem(posture({-60, 30}));
  const Configuration goal = goal_at(posture({0, 0}));
  const TargetMotion target = flying(Vector3d(5.5, 0, 0), Vector3d(-1, 0, 0), goal.contact_time);
  const Approach a = plan(problem, goal, &target);
  check_motion(problem, goal, a);
}

TEST_CASE("a target that sweeps over the waiting arm is reported as an early collision") {
  const CaptureProblem problem = point_mass_problem(posture({-60, 30}));
  const Configuration goal = goal_at(posture({0, 0}));
  // Comes along the arm from behind: over link 1, then link 2, to the hand.
  const TargetMotion target = flying(Vector3d(5.5, 0, 0), Vector3d(1, 0.02, 0), goal.contact_time);
  const Approach a = plan(problem, goal, &target);
  CHECK(a.status == ApproachStatus::HitEarly);
  INFO(a.detail);
  CHECK(a.detail.find("while the robot waits: target with ") != std::string::npos);
  CHECK(a.detail.find("before the contact") != std::string::npos);
}

TEST_CASE("the approach avoids a target that crosses the arm's path") {
  // The straight line of the arm sweeps through the place where the target flies at that time; the
  // target ends at the hand.
  CaptureProblem problem = point_mass_problem(posture({-80, 20}));
  problem.approach.wait = 0.5;
  const Configuration goal = goal_at(posture({60, -20}), 100);
  const Vector3d hand(1.4 + 2 * std::cos(60 * kDegree) + 2 * std::cos(40 * kDegree),
                      2 * std::sin(60 * kDegree) + 2 * std::sin(40 * kDegree), 0);
  int hit_straight = 0, found = 0;
  for (int i = 0; i < 5; ++i) {
    // Follows the hand's own sweep from below, faster and faster from case to case.
    const Vector3d velocity = (0.15 + 0.1 * i) * Vector3d(-0.25, 1, 0).normalized();
    const TargetMotion target = flying(hand + 0.1 * Vector3d(0.6, -0.8, 0), velocity, 100);
    const Approach free = plan(problem, goal);
    REQUIRE(free.status == ApproachStatus::Found);
    const auto clearance = [&](const Approach& a) {
      double least = 1e9;
      for (std::size_t s = 0; s + 1 < a.times.size(); ++s) {
        for (int part = 0; part <= 10; ++part) {
          const double t = a.times[s] + part / 10.0 * (a.times[s + 1] - a.times[s]);
          const Eigen::VectorXd phi = hermite(a, s, part / 10.0).phi;
          const Vector3d centre = target.state(t).pose.position;
          Vector3d begin(1.4, 0, 0);
          double angle = 0;
          for (Eigen::Index k = 0; k < 2; ++k) {
            angle += phi[k];
            const Vector3d end = begin + 2 * Vector3d(std::cos(angle), std::sin(angle), 0);
            if (k == 0 || (end - centre).norm() > 0.1 + problem.approach.contact_allowance) {
              least = std::min(least, segment_distance(begin, end, centre, centre) - 0.18);
            }
            begin = end;
          }
        }
      }
      return least;
    };
    if (clearance(free) < 0) ++hit_straight;
    const Approach a = plan(problem, goal, &target);
    INFO(a.detail);
    CHECK((a.status == ApproachStatus::Found || a.status == ApproachStatus::HitEarly));
    if (a.status != ApproachStatus::Found) continue;
    ++found;
    check_motion(problem, goal, a);
    CHECK(clearance(a) >= problem.approach.clearance - 1e-3);
  }
  CHECK(hit_straight >= 1);
  CHECK(found >= 3);
}

TEST_CASE("a start before the target's estimate is too slow") {
  CaptureProblem problem = planar_problem(posture({-60, 30}));
  problem.target = cube_target();
  problem.variables.feature = "face";
  const Configuration goal = goal_at(posture({0, 0}), 10);
  const Eigen::Quaterniond about_z(Eigen::AngleAxisd(180 * kDegree, Vector3d::UnitZ()));
  TargetState state;
  state.pose = {Vector3d(5.4, 0, 0) - about_z * problem.target->features.front().point, about_z};
  problem.target_state = state;
  const TargetMotion target(*problem.target, state, 1000);
  const Approach a = plan(problem, goal, &target);
  INFO(a.detail);
  CHECK(a.status == ApproachStatus::TooSlow);
  CHECK(a.detail.find("s too slow for a start after the target's estimate") != std::string::npos);
  CHECK(plan(problem, goal_at(goal.phi, 40), &target).status == ApproachStatus::Found);
}

TEST_CASE("a target whose prediction does not reach back far enough is an outcome, not a crash") {
  const CaptureProblem problem = point_mass_problem(posture({-60, 30}));
  TargetState state;
  state.time = 100;
  state.pose.position = Vector3d(5.5, 0, 0);
  state.linear_velocity = Vector3d(-1, 0, 0);
  const TargetMotion target(point_target(), state, 1.0);
  CHECK(plan(problem, goal_at(posture({0, 0})), &target).status == ApproachStatus::TooSlow);
}

TEST_CASE("a goal whose other links touch the target at the contact is invalid") {
  const CaptureProblem problem = point_mass_problem(posture({-60, 30}));
  const Configuration goal = goal_at(posture({0, 0}));
  const TargetMotion target = flying(Vector3d(2.4, 0.1, 0), Vector3d(-1, 0, 0), goal.contact_time);
  const Approach a = plan(problem, goal, &target);
  CHECK(a.status == ApproachStatus::GoalInvalid);
  CHECK(a.detail.find("target with link") != std::string::npos);
}

TEST_CASE(
    "a collision of the target with a part fixed to the held base is reported after one attempt") {
  CaptureProblem problem = point_mass_problem(posture({-60, 30}));
  problem.obstacles = {{"antenna", Frame::Base,
                        Pose{Vector3d(12, 0.2, 0), Eigen::Quaterniond::Identity()}, Sphere{0.15}}};
  const Configuration goal = goal_at(posture({0, 0}));
  const TargetMotion target = flying(Vector3d(5.5, 0, 0), Vector3d(-1, 0, 0), goal.contact_time);
  std::map<std::string, long> calls;
  const Approach a = plan_approach(problem, goal, &target, 1, {}, calls);
  CHECK(a.status == ApproachStatus::HitEarly);
  // It passes x = 12 m about 6.5 s before the contact.
  CHECK(a.detail.find("target with antenna at 93.") == 0);
  CHECK(calls["rrt_connect"] == 1);
}

TEST_CASE("a goal is left out after a few paths on which the target touches a floating base") {
  CaptureProblem problem = point_mass_problem(posture({-60, 30}));
  problem.approach.base = BaseMode::Floating;
  // Wide enough for every base pose that a path may begin from.
  problem.obstacles = {{"shield", Frame::Base,
                        Pose{Vector3d(15, 0, 0), Eigen::Quaterniond::Identity()}, Sphere{3.5}}};
  const Configuration goal = goal_at(posture({0, 0}));
  const TargetMotion target = flying(Vector3d(5.5, 0, 0), Vector3d(-1, 0, 0), goal.contact_time);
  for (const int hits : {1, 2, 5}) {
    ApproachOptions options;
    options.base_hits = hits;
    std::map<std::string, long> calls;
    const Approach a = plan_approach(problem, goal, &target, 1, {}, calls, {}, options);
    CHECK(a.status == ApproachStatus::HitEarly);
    INFO(a.detail);
    CHECK(a.detail.find("target with shield") == 0);
    CHECK(calls["rrt_connect"] == hits);
    CHECK(a.base_hits == hits);
  }
  // Of several goals it is known how many paths to each were such ones.
  ApproachGoal first, second;
  first.configuration = goal;
  second.configuration = goal_at(posture({0, 0}));
  first.target = second.target = &target;
  std::map<std::string, long> calls;
  const ApproachToAny any = plan_approach_to_any(problem, {first, second}, 1, {}, calls);
  CHECK(any.approach.status == ApproachStatus::HitEarly);
  CHECK(any.base_hits == std::vector<int>{1, 1});
  CHECK(calls["rrt_connect"] == 2);
}

TEST_CASE("a longer wait avoids a target that touches a floating base on its way") {
  CaptureProblem problem = point_mass_problem(posture({-60, 30}));
  problem.approach.base = BaseMode::Floating;
  // Beside the line of flight at the end of the path, on it while the path turns the base.
  problem.obstacles = {{"boom", Frame::Base,
                        Pose{Vector3d(13, -1.75, 0), Eigen::Quaterniond::Identity()},
                        Sphere{0.15}}};
  const Configuration goal = goal_at(posture({0, 0}));
  const TargetMotion target = flying(Vector3d(5.5, 0, 0), Vector3d(-1, 0, 0), goal.contact_time);
  ApproachOptions options;
  options.base_hits = 1;
  std::map<std::string, long> calls;
  const Approach a = plan_approach(problem, goal, &target, 1, {}, calls, {}, options);
  INFO(a.detail);
  CHECK(a.status == ApproachStatus::Found);
  CHECK(calls["rrt_connect"] > 1);
}
