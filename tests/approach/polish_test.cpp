#include <catch2/catch.hpp>

#include "approach/problems.hpp"
#include "approach/shipped_robot.hpp"
#include "approach/spline_shift.hpp"

using namespace stillbase;
using namespace stillbase::test;

TEST_CASE("the splines of a shift are what their derivatives say and vanish at both ends") {
  constexpr int kCount = 5;
  for (int i = 1; i < 40; ++i) {
    const double u = i / 40.0 + 0.001, h = 1e-5;
    const SplineBasis at = spline_basis(u, kCount);
    const SplineBasis ahead = spline_basis(u + h, kCount), behind = spline_basis(u - h, kCount);
    CHECK((at.first - (ahead.value - behind.value) / (2 * h)).norm() < 1e-6);
    CHECK((at.second - (ahead.first - behind.first) / (2 * h)).norm() < 1e-4);
    CHECK(at.value.minCoeff() >= 0);
  }
  for (const double end : {0.0, 1.0}) {
    const SplineBasis at = spline_basis(end, kCount);
    CHECK(at.value.norm() + at.first.norm() + at.second.norm() < 1e-12);
  }
}

TEST_CASE("the polish turns the base less and says by how much") {
  CaptureProblem problem =
      problem_for(shipped_robot("iiwa_on_cube"), posture({20, 40, 0, -60, 10, 50, 0}));
  problem.approach.base = BaseMode::Floating;
  problem.approach.velocity_scale = 0.05;
  const Configuration goal = goal_at(posture({60, 60, 20, -40, 0, 30, 40}), 400);
  const Approach plain = plan(problem, goal);
  REQUIRE(plain.status == ApproachStatus::Found);
  problem.approach.polish = PathPolish::Attitude;
  const Approach polished = plan(problem, goal);
  check_motion(problem, goal, polished);
  CHECK(polished.before_polish == Approx(plain.attitude_excursion));
  CHECK(polished.after_polish == Approx(polished.attitude_excursion));
  CHECK(polished.attitude_excursion < 0.98 * plain.attitude_excursion);
}

TEST_CASE("the polish makes no way around an obstacle slower and keeps the clearance") {
  CaptureProblem problem = planar_problem(posture({-60, 30, 0}));
  problem.obstacles = {{"ball", Frame::Base,
                        Pose{Vector3d(5.2, 0, 0), Eigen::Quaterniond::Identity()}, Sphere{0.5}}};
  const Configuration goal = goal_at(posture({60, -30, 0}), 300);
  const Approach plain = plan(problem, goal);
  REQUIRE(plain.status == ApproachStatus::Found);
  problem.approach.polish = PathPolish::Time;
  const Approach polished = plan(problem, goal);
  check_motion(problem, goal, polished);
  CHECK(polished.before_polish == Approx(plain.duration));
  CHECK(polished.after_polish == Approx(polished.duration));
  CHECK(polished.duration <= plain.duration * (1 + 1e-12));
  CHECK(polished.min_clearance >= problem.approach.clearance);
}

TEST_CASE("the polish never makes a path worse: a straight one that is fast already stays") {
  CaptureProblem problem = planar_problem(posture({-60, 30}));
  const Configuration goal = goal_at(posture({40, -50}), 300);
  const double plain = plan(problem, goal).duration;
  problem.approach.polish = PathPolish::Time;
  const Approach polished = plan(problem, goal);
  check_motion(problem, goal, polished);
  CHECK(polished.duration <= plain * (1 + 1e-12));
}
