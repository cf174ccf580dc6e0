// A floating base that starts where it stands: the hand arrives although the base turns.
#include <catch2/catch.hpp>

#include "approach/problems.hpp"
#include "approach/shipped_robot.hpp"
#include "verification/path_motion.hpp"

using namespace stillbase;
using namespace stillbase::test;

namespace {

/// Postures of the planar two-link arm with its hand at a point of N, elbow on one side; by hand.
ContactSolver elbow_up(const Vector3d& point_N) {
  ContactSolver solver;
  solver.at_base = [point_N](const Pose& base, ContactSolve) -> std::optional<Configuration> {
    const Vector3d p = base.inverse() * point_N - Vector3d(1.4, 0, 0);
    const double c = (p.squaredNorm() - 8) / 8;
    if (std::abs(c) > 1) return std::nullopt;
    JointVectord phi(2);
    phi[1] = -std::acos(c);
    phi[0] = std::atan2(p.y(), p.x()) - std::atan2(2 * std::sin(phi[1]), 2 + 2 * std::cos(phi[1]));
    return Configuration{phi, base, 200};
  };
  return solver;
}

CaptureProblem from_where_it_stands() {
  CaptureProblem problem = planar_problem(posture({-60, -10}));
  // A base heavy enough that the arm cannot turn it out of reach.
  problem.robot.base.mass = 4000;
  problem.robot.base.inertia = Vector3d(4000, 4000, 4000).asDiagonal();
  problem.approach.base = BaseMode::Floating;
  problem.approach.station_free = false;
  problem.base = {Vector3d(0.3, -0.2, 0.1), rotation_exp(Vector3d(0, 0, 0.2))};
  return problem;
}

Approach plan_with(const CaptureProblem& problem, const ContactSolver& contact) {
  std::map<std::string, long> calls;
  const auto first = contact.at_base(problem.base, ContactSolve::Best);
  const Configuration goal = first ? *first : goal_at(posture({40, -70}), 200, problem.base);
  return plan_approach(problem, goal, nullptr, 1, {}, calls, contact);
}

/// Where the base ends by the second implementation of the dynamics.
Pose end_of_base(const RobotModel& robot, const Approach& a) {
  Pose pose = a.base_poses.front();
  for (std::size_t i = 0; i + 1 < a.times.size(); ++i) {
    const verification::HermiteSegment segment(a, i);
    pose = verification::drifted_base(robot, segment, pose, 0.005);
  }
  return pose;
}

}  // namespace

TEST_CASE("the hand of a floating robot with a stated start arrives at its point in N") {
  CaptureProblem problem = from_where_it_stands();
  const Vector3d point = problem.base * Vector3d(4.93, -1.28, 0);
  const bool obstructed = GENERATE(false, true);
  if (obstructed) {
    problem.obstacles = {{"ball", Frame::Base,
                          Pose{Vector3d(4.4, -3.0, 0), Eigen::Quaterniond::Identity()},
                          Sphere{0.2}}};
  }
  const Approach a = plan_with(problem, elbow_up(point));
  INFO(a.detail);
  REQUIRE(a.status == ApproachStatus::Found);
  CHECK(a.base_poses.front().position == problem.base.position);
  CHECK(a.joint_positions.front() == problem.start);
  const Pose end = end_of_base(problem.robot, a);
  const double angle = rotation_log(problem.base.orientation.conjugate() * end.orientation).norm();
  CHECK(angle > 2 * kDegree);  // the posture for the stated base would have missed
  const JointVectord& phi = a.joint_positions.back();
  const Vector3d hand = Vector3d(1.4, 0, 0) + 2 * Vector3d(std::cos(phi[0]), std::sin(phi[0]), 0) +
                        2 * Vector3d(std::cos(phi[0] + phi[1]), std::sin(phi[0] + phi[1]), 0);
  CHECK((end * hand - point).norm() < 1e-7);
  CHECK(a.hand_position_error < 1e-9);
  CHECK(a.hand_angle_error < 1e-9);
}

TEST_CASE("a contact that moves away as the base rotates leaves the closure open") {
  const CaptureProblem problem = from_where_it_stands();
  const Vector3d point = problem.base * Vector3d(4.93, -1.28, 0);
  const ContactSolver solve = elbow_up(point);
  // Only a base that is just where it started finds the contact.
  ContactSolver here_only;
  here_only.at_base = [&](const Pose& base, ContactSolve how) {
    const bool near = (base.position - problem.base.position).norm() < 1e-3;
    return near ? solve.at_base(base, how) : std::nullopt;
  };
  const Approach a = plan_with(problem, here_only);
  CHECK(a.status == ApproachStatus::BaseDriftOpen);
  CHECK(a.detail.find("posture") != std::string::npos);
}

TEST_CASE("postures whose base pose always asks for another posture leave the closure open") {
  const CaptureProblem problem = from_where_it_stands();
  // The far posture turns the base by some degrees, and then the near one is wanted, which does
  // not.
  const JointVectord far = posture({40, -70}), near = posture({-55, -15});
  ContactSolver solver;
  solver.at_base = [&](const Pose& base, ContactSolve) -> std::optional<Configuration> {
    const double angle =
        rotation_log(problem.base.orientation.conjugate() * base.orientation).norm();
    return Configuration{angle < 1 * kDegree ? far : near, base, 200};
  };
  const Approach a = plan_with(problem, solver);
  INFO(a.detail);
  CHECK(a.status == ApproachStatus::BaseDriftOpen);
  CHECK(a.detail.find("m or rad stay open") != std::string::npos);
  CHECK(a.joint_positions.empty());
}

TEST_CASE("a floating base with a stated start needs a solver for the contact") {
  const CaptureProblem problem = from_where_it_stands();
  CHECK_THROWS_AS(plan(problem, goal_at(posture({40, -70}), 200, problem.base)),
                  std::invalid_argument);
}
