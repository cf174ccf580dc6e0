#include <catch2/catch.hpp>

#include "approach/polish.hpp"
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

TEST_CASE("slopes of the polish are those of its values") {
  CaptureProblem problem =
      problem_for(shipped_robot("iiwa_on_cube"), posture({20, 40, 0, -60, 10, 50, 0}));
  problem.approach.base = BaseMode::Floating;
  problem.approach.velocity_scale = 0.05;
  problem.approach.polish = GENERATE(PathPolish::Attitude, PathPolish::Time);
  problem.obstacles = {{"ball", Frame::Inertial,
                        Pose{Vector3d(0.9, 0.5, 1.2), Eigen::Quaterniond::Identity()},
                        Sphere{0.1}}};
  const Configuration goal = goal_at(posture({60, 60, 20, -40, 0, 30, 40}), 400);
  const ContactSolver contact;
  const ApproachTask task = make_task(problem, goal, nullptr, contact);
  CaptureProblem plain = problem;
  plain.approach.polish = PathPolish::None;
  AttemptGoal first(make_task(plain, goal, nullptr, contact));
  first.max_iterations = 2000;
  std::size_t reached = 0;
  const AttemptResult found = try_approach({&first}, 1, {}, reached);
  REQUIRE(found.status == ApproachStatus::Found);
  const PolishProblem polish(task, found, problem.approach.wait);
  Eigen::VectorXd x = polish.start();
  for (Eigen::Index i = 0; i + 1 < x.size(); ++i)
    x[i] += 0.05 * std::sin(3.0 * static_cast<double>(i));
  nlp::Evaluation at, ahead, behind;
  polish.evaluate(x, at);
  double worst = 0, worst_slope = 0;
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    constexpr double h = 1e-5;
    Eigen::VectorXd beside = x;
    beside[i] += h;
    polish.evaluate_value(beside, ahead);
    beside[i] -= 2 * h;
    polish.evaluate_value(beside, behind);
    const Eigen::VectorXd column = (ahead.constraints - behind.constraints) / (2 * h);
    worst = std::max(worst, (column - at.jacobian.col(i)).cwiseAbs().maxCoeff());
    worst_slope = std::max(
        worst_slope, std::abs((ahead.objective - behind.objective) / (2 * h) - at.gradient[i]));
  }
  CHECK(worst < 2e-3);  // distances of capsules, one-sided
  CHECK(worst_slope < 1e-4 * (1 + at.gradient.cwiseAbs().maxCoeff()));
  CHECK(at.constraints.tail(31).minCoeff() < 0.9);  // the ball is near enough to matter
}

TEST_CASE("the polish reduces the base's rotation and states by how much") {
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
  CHECK(polished.attitude_excursion < 0.9 * plain.attitude_excursion);
}

TEST_CASE("the polish makes a motion faster and states by how much") {
  CaptureProblem problem =
      problem_for(shipped_robot("iiwa_on_cube"), posture({20, 40, 0, -60, 10, 50, 0}));
  problem.approach.base = BaseMode::Floating;
  const Configuration goal = goal_at(posture({60, 60, 20, -40, 0, 30, 40}), 400);
  const Approach plain = plan(problem, goal);
  problem.approach.polish = PathPolish::Time;
  const Approach polished = plan(problem, goal);
  check_motion(problem, goal, polished);
  CHECK(polished.before_polish == Approx(plain.duration));
  CHECK(polished.after_polish == Approx(polished.duration));
  CHECK(polished.duration < 0.99 * plain.duration);
}

TEST_CASE("the polish makes no path around an obstacle slower and keeps the clearance") {
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

TEST_CASE("the polish never makes a path worse: a straight one at its limits is kept") {
  CaptureProblem problem = planar_problem(posture({-60, 30}));
  const Configuration goal = goal_at(posture({40, -50}), 300);
  const double plain = plan(problem, goal).duration;
  problem.approach.polish = PathPolish::Time;
  const Approach polished = plan(problem, goal);
  check_motion(problem, goal, polished);
  CHECK(polished.duration <= plain * (1 + 1e-12));
}
