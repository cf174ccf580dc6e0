#include <catch2/catch.hpp>

#include "approach/polish_problem.hpp"
#include "approach/problems.hpp"
#include "approach/rest_spline.hpp"
#include "approach/shipped_robot.hpp"

using namespace stillbase;
using namespace stillbase::test;

TEST_CASE("a spline from rest to rest begins and ends where it should, and its derivatives fit") {
  const JointVectord start = posture({10, -40}), end = posture({70, 20});
  const RestSpline spline(start, end, 7);
  Eigen::MatrixXd points(2, spline.points());
  for (int c = 0; c < spline.points(); ++c) {
    points.col(c) = JointVectord(posture({20.0 * c, 15.0 * c * c - 40}));
  }
  const auto at = [&](double u, int derivative) {
    return spline.at(spline.weights(u, derivative), points);
  };
  CHECK((at(0, 0) - start).norm() < 1e-14);
  CHECK((at(1, 0) - end).norm() < 1e-14);
  CHECK(at(0, 1).norm() + at(1, 1).norm() < 1e-12);
  for (int i = 1; i < 40; ++i) {
    const double u = i / 40.0 + 0.001, h = 1e-5;
    CHECK((at(u, 1) - (at(u + h, 0) - at(u - h, 0)) / (2 * h)).norm() < 1e-6);
    CHECK((at(u, 2) - (at(u + h, 1) - at(u - h, 1)) / (2 * h)).norm() < 1e-5);
  }
}

TEST_CASE("a motion that is a spline is fitted and stored exactly") {
  const JointVectord start = posture({10, -40}), end = posture({70, 20});
  const RestSpline spline(start, end, 6);
  Eigen::MatrixXd points(2, spline.points());
  for (int c = 0; c < spline.points(); ++c) {
    points.col(c) = JointVectord(posture({20.0 * c, 50 - 10.0 * c}));
  }
  const JointPath path = spline.motion(points, 12, 2);
  CHECK((spline.fitted(path) - points).norm() < 1e-11);
  for (std::size_t i = 0; i < path.segments(); ++i) {
    const double t = path.times[i] + 0.3 * (path.times[i + 1] - path.times[i]);
    const JointMotion stored = motion_on_segment(path, i, t);
    const JointVectord phi = spline.at(spline.weights(t / 12, 0), points);
    const JointVectord rate = spline.at(spline.weights(t / 12, 1), points) / 12;
    CHECK((stored.phi - phi).norm() < 1e-12);
    CHECK((stored.phidot - rate).norm() < 1e-12);
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
  CHECK(polished.attitude_excursion < 0.8 * plain.attitude_excursion);
}

TEST_CASE("the polish makes a way around an obstacle faster and keeps the clearance") {
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
  CHECK(polished.duration < 0.97 * plain.duration);
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
