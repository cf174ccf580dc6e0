// The floating base along the path, against the second implementation of the dynamics.
#include <catch2/catch.hpp>

#include <stillbase/collision/scene.hpp>
#include <stillbase/core/random.hpp>
#include <stillbase/reference/reference.hpp>

#include "approach/base_motion.hpp"
#include "approach/problems.hpp"
#include "approach/shipped_robot.hpp"
#include "support/dense.hpp"

using namespace stillbase;
using namespace stillbase::test;

namespace {

/// Total momentum of all bodies, [P; L about the system centroid], in B, by the reference.
Eigen::VectorXd momentum(const RobotModel& robot, const Eigen::VectorXd& phi,
                         const Eigen::VectorXd& phidot, const Vector6d& Omega) {
  reference::State state;
  state.phi = phi;
  state.phidot = phidot;
  state.Omega = Omega;
  const reference::Dynamics dynamics = reference::compute(robot, state);
  Eigen::VectorXd both(6);
  both << dynamics.P, dynamics.L_g;
  return both;
}

/// The base twist that makes the reference's momentum zero.
Vector6d still_momentum_twist(const RobotModel& robot, const Eigen::VectorXd& phi,
                              const Eigen::VectorXd& phidot) {
  reference::State state;
  state.phi = phi;
  state.phidot = Eigen::VectorXd::Zero(phi.size());
  const Eigen::MatrixXd H = reference::compute(robot, state).H;
  return -test::solve(H.topLeftCorner(6, 6), H.topRightCorner(6, phi.size()) * phidot);
}

/// Classical Runge-Kutta on position and rotation matrix, re-orthogonalised: plain and independent.
std::vector<Pose> integrate(const RobotModel& robot, const Approach& a, int steps) {
  std::vector<Pose> poses = {a.base_poses.front()};
  Vector3d p = a.base_poses.front().position;
  Eigen::Matrix3d R = a.base_poses.front().orientation.toRotationMatrix();
  for (std::size_t i = 0; i + 1 < a.times.size(); ++i) {
    const double h = (a.times[i + 1] - a.times[i]) / steps;
    for (int s = 0; s < steps; ++s) {
      const auto twist = [&](double c) {
        const Sample sample = hermite(a, i, (s + c) / steps);
        return still_momentum_twist(robot, sample.phi, sample.phidot);
      };
      const Vector6d t0 = twist(0), tm = twist(0.5), t1 = twist(1);
      const auto dR = [](const Eigen::Matrix3d& M, const Vector6d& t) {
        return Eigen::Matrix3d(M * skew(Vector3d(t.tail<3>())));
      };
      const Eigen::Matrix3d k1 = dR(R, t0), k2 = dR(R + h / 2 * k1, tm),
                            k3 = dR(R + h / 2 * k2, tm), k4 = dR(R + h * k3, t1);
      const Vector3d l1 = R * t0.head<3>(), l2 = (R + h / 2 * k1) * tm.head<3>(),
                     l3 = (R + h / 2 * k2) * tm.head<3>(), l4 = (R + h * k3) * t1.head<3>();
      p += h / 6 * (l1 + 2 * l2 + 2 * l3 + l4);
      R += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
      R = Eigen::Quaterniond(R).normalized().toRotationMatrix();
    }
    poses.push_back({p, Eigen::Quaterniond(R)});
  }
  return poses;
}

double difference(const Pose& a, const Pose& b) {
  return std::max((a.position - b.position).norm(),
                  rotation_log(a.orientation.conjugate() * b.orientation).norm());
}

void check_floating(const CaptureProblem& problem, const Configuration& goal, const Approach& a) {
  check_motion(problem, goal, a);
  CHECK(difference(a.base_poses.back(), goal.base) == 0);
  for (std::size_t i = 0; i < a.times.size(); ++i) {
    CHECK(momentum(problem.robot, a.joint_positions[i], a.joint_velocities[i], a.base_velocities[i])
              .cwiseAbs()
              .maxCoeff() < 1e-9);
  }
  const std::vector<Pose> expected = integrate(problem.robot, a, 4);
  double worst = 0, excursion = 0;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    worst = std::max(worst, difference(expected[i], a.base_poses[i]));
    excursion = std::max(
        excursion,
        rotation_log(goal.base.orientation.conjugate() * a.base_poses[i].orientation).norm());
  }
  CHECK(worst < 1e-7);
  CHECK(a.attitude_excursion == Approx(excursion).epsilon(1e-6));
  CHECK(a.attitude_excursion > 0.01);
}

}  // namespace

TEST_CASE(
    "one Magnus step has order five locally, also when the base rotates about changing axes") {
  const RobotModel robot = shipped_robot("iiwa_on_cube");
  Random random(2);
  JointPath path;
  path.times = {0, 1};
  for (int i = 0; i < 2; ++i) {
    JointVectord phi(7), rate(7);
    for (int k = 0; k < 7; ++k) {
      phi[k] = random.uniform(-1, 1);
      rate[k] = random.uniform(-1, 1);
    }
    path.phi.push_back(phi);
    path.phidot.push_back(rate);
  }
  const auto in_steps = [&](int steps) {
    Pose pose;
    for (int s = 0; s < steps; ++s) {
      pose = pose * base_step(robot, path, 0, s / double(steps), (s + 1) / double(steps));
    }
    return pose;
  };
  const Pose exact = in_steps(256);
  const double e8 = difference(in_steps(8), exact), e16 = difference(in_steps(16), exact);
  CHECK(e8 > 1e-9);
  CHECK(e8 / e16 == Approx(16).epsilon(0.2));
  CHECK(difference(base_displacement(robot, path, 0, 1e-10), exact) < 1e-9);
}

TEST_CASE("a floating planar robot keeps zero momentum and arrives at the goal's base pose") {
  CaptureProblem problem = planar_problem(posture({-60, 30}));
  problem.approach.base = BaseMode::Floating;
  const Pose base{Vector3d(3, -2, 1),
                  Eigen::Quaterniond(Eigen::AngleAxisd(0.7, Vector3d(1, 2, 2).normalized()))};
  const Configuration goal = goal_at(posture({60, -30}), 100, base);
  check_floating(problem, goal, plan(problem, goal));
}

TEST_CASE("a floating seven-joint arm keeps zero momentum around an obstacle") {
  const RobotModel robot = shipped_robot("iiwa_on_cube");
  CaptureProblem problem = problem_for(robot, posture({0, 100, 0, 100, 0, 60, 0}));
  problem.approach.base = BaseMode::Floating;
  problem.approach.velocity_scale = 0.05;
  problem.obstacles = {{"panel", Frame::Base,
                        Pose{Vector3d(0.45, 0.35, 1.0), Eigen::Quaterniond::Identity()},
                        Box{Vector3d(0.1, 0.3, 0.5)}}};
  const Configuration goal = goal_at(posture({80, 70, 0, 40, 0, 30, 0}), 100);
  const CollisionScene scene(problem);
  bool straight_hits = false;
  for (int i = 0; i <= 200; ++i) {
    const JointVectord phi = problem.start + i / 200.0 * (goal.phi - problem.start);
    straight_hits =
        straight_hits || scene.first_hit(compute_kinematics<double>(robot, phi), Pose{}, nullptr);
  }
  REQUIRE(straight_hits);
  const Approach a = plan(problem, goal);
  check_floating(problem, goal, a);
  CHECK(a.path_length > (goal.phi - problem.start).norm() + 0.01);
  for (std::size_t i = 0; i + 1 < a.times.size(); ++i) {
    for (int part = 0; part < 4; ++part) {
      const JointVectord phi = hermite(a, i, part / 4.0).phi;
      CHECK_FALSE(scene.first_hit(compute_kinematics<double>(robot, phi), Pose{}, nullptr,
                                  problem.approach.clearance));
    }
  }
}

TEST_CASE(
    "obstacles in the inertial frame are checked at the integrated pose of the floating base") {
  CaptureProblem problem = planar_problem(posture({-60, 30}));
  problem.approach.base = BaseMode::Floating;
  problem.obstacles = {{"panel", Frame::Inertial,
                        Pose{Vector3d(4.6, 0, 0), Eigen::Quaterniond::Identity()}, Sphere{0.3}}};
  const Configuration goal = goal_at(posture({60, -30}), 300);
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    const Approach a = plan(problem, goal, nullptr, seed);
    check_floating(problem, goal, a);
    double least = 1e9;
    for (std::size_t i = 0; i < a.times.size(); ++i) {
      const Vector3d centre = a.base_poses[i].inverse() * Vector3d(4.6, 0, 0);
      Vector3d begin(1.4, 0, 0);
      double angle = 0;
      for (Eigen::Index k = 0; k < 2; ++k) {
        angle += a.joint_positions[i][k];
        const Vector3d end = begin + 2 * Vector3d(std::cos(angle), std::sin(angle), 0);
        const double t = std::clamp((centre - begin).dot(end - begin) / 4, 0.0, 1.0);
        least = std::min(least, (begin + t * (end - begin) - centre).norm() - 0.38);
        begin = end;
      }
    }
    CHECK(least >= problem.approach.clearance - 1e-3);
  }
}
