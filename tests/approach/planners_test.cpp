#include <catch2/catch.hpp>

#include "approach/problems.hpp"

using namespace stillbase;
using namespace stillbase::test;

namespace {

CaptureProblem around_a_ball() {
  CaptureProblem problem = planar_problem(posture({-60, 30, 0}));
  problem.obstacles = {{"ball", Frame::Base,
                        Pose{Vector3d(5.2, 0, 0), Eigen::Quaterniond::Identity()}, Sphere{0.5}}};
  return problem;
}

}  // namespace

TEST_CASE("every planner by name finds a path around an obstacle") {
  CaptureProblem problem = around_a_ball();
  const Configuration goal = goal_at(posture({60, -30, 0}), 300);
  for (const std::string& name : approach_planner_names()) {
    INFO(name);
    problem.approach.planner = name;
    std::map<std::string, long> calls;
    const Approach a = plan_approach(problem, goal, nullptr, 1, {}, calls);
    check_motion(problem, goal, a);
    CHECK(a.min_clearance >= problem.approach.clearance);
    CHECK(a.path_length > (goal.phi - problem.start).norm() + 0.01);
    CHECK(calls.at(name) >= 1);
    CHECK(a.detail.find(name) != std::string::npos);
  }
}

TEST_CASE("every planner gives the same path for the same seed, whatever ran before") {
  CaptureProblem problem = around_a_ball();
  const Configuration goal = goal_at(posture({60, -30, 0}), 300);
  const auto path = [&](const std::string& name) {
    problem.approach.planner = name;
    return plan(problem, goal, nullptr, 5).joint_positions;
  };
  const std::vector<std::string> names = approach_planner_names();
  CHECK(names == std::vector<std::string>{"rrt_connect", "rrt_star", "prm_star", "bit_star",
                                          "ait_star", "kpiece"});
  std::vector<std::vector<JointVectord>> first;
  for (const std::string& name : names) first.push_back(path(name));
  for (std::size_t i = names.size(); i-- > 0;) {
    INFO(names[i]);
    CHECK(path(names[i]) == first[i]);
  }
}
