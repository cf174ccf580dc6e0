// Torques along the path, by the work that they do, and the time law slowed to the effort limits.
#include <catch2/catch.hpp>

#include <stillbase/core/random.hpp>
#include <stillbase/reference/reference.hpp>

#include "approach/effort.hpp"
#include "approach/problems.hpp"
#include "approach/shipped_robot.hpp"
#include "support/dense.hpp"

using namespace stillbase;
using namespace stillbase::test;

namespace {

JointPath random_segment(int n, std::uint64_t seed) {
  Random random(seed);
  JointPath path;
  path.times = {0, 1};
  for (int i = 0; i < 2; ++i) {
    JointVectord phi(n), rate(n);
    for (int k = 0; k < n; ++k) {
      phi[k] = random.uniform(-1, 1);
      rate[k] = random.uniform(-1, 1);
    }
    path.phi.push_back(phi);
    path.phidot.push_back(rate);
  }
  return path;
}

/// Kinetic energy of robot and rotors by the second implementation of the dynamics.
double kinetic_energy(const CaptureProblem& problem, const JointMotion& motion) {
  const auto n = motion.phi.size();
  const Eigen::MatrixXd H = reference::compute(problem.robot, {motion.phi, {}, {}}).H;
  Eigen::VectorXd u = Eigen::VectorXd::Zero(6 + n);
  u.tail(n) = motion.phidot;
  if (problem.approach.base != BaseMode::Held) {
    u.head(6) = -test::solve(H.topLeftCorner(6, 6), H.topRightCorner(6, n) * motion.phidot);
  }
  double energy = u.dot(H * u) / 2;
  if (problem.resistance.model == ResistanceModel::RotorInertia) {
    energy += problem.resistance.rotor_inertia.dot(motion.phidot.cwiseAbs2()) / 2;
  }
  return energy;
}

}  // namespace

TEST_CASE("the power of the joint torques is the change of the kinetic energy") {
  const BaseMode mode = GENERATE(BaseMode::Held, BaseMode::Floating, BaseMode::ReactionNull);
  const bool rotors = GENERATE(false, true);
  CaptureProblem problem = problem_for(shipped_robot("iiwa_on_cube"), JointVectord::Zero(7));
  problem.approach.base = mode;
  if (rotors) {
    problem.resistance.model = ResistanceModel::RotorInertia;
    problem.resistance.rotor_inertia = JointVectord::Constant(7, 0.7);
  }
  const JointPath path = random_segment(7, 3);
  for (const double t : {0.2, 0.5, 0.9}) {
    const JointMotion at = motion_on_segment(path, 0, t);
    const double h = 1e-4;
    const double slope = (kinetic_energy(problem, motion_on_segment(path, 0, t + h)) -
                          kinetic_energy(problem, motion_on_segment(path, 0, t - h))) /
                         (2 * h);
    CHECK(joint_torques(problem, at).dot(at.phidot) == Approx(slope).epsilon(1e-5));
  }
}

TEST_CASE("torque limits slow the motion down, by the square root of the excess") {
  CaptureProblem problem = planar_problem(posture({-60, 30}));
  problem.approach.base = BaseMode::Floating;
  const Configuration goal = goal_at(posture({40, -50}), 400);
  const Approach fast = plan(problem, goal);
  REQUIRE(fast.status == ApproachStatus::Found);
  double largest = 0;
  for (const JointVectord& torques : fast.joint_torques) {
    largest = std::max(largest, torques.cwiseAbs().maxCoeff());
  }
  REQUIRE(largest > 0);
  CHECK(fast.joint_torques.back().isZero(0));
  for (Joint& joint : problem.robot.joints) joint.max_effort = largest / 9;
  const Approach slow = plan(problem, goal);
  REQUIRE(slow.status == ApproachStatus::Found);
  CHECK(slow.duration / fast.duration == Approx(3).epsilon(0.02));
  CHECK(slow.effort_used <= 1);
  CHECK(slow.effort_used > 0.95);
  for (const JointVectord& torques : slow.joint_torques) {
    CHECK(torques.cwiseAbs().maxCoeff() <= largest / 9);
  }
}

TEST_CASE(
    "torque limits that leave no time in the window make the approach too slow, by a stated time") {
  CaptureProblem problem = planar_problem(posture({-60, 30}));
  problem.approach.base = BaseMode::Floating;
  const Configuration goal = goal_at(posture({40, -50}), 400);
  problem.approach.max_duration = plan(problem, goal).duration + problem.approach.wait + 1;
  for (Joint& joint : problem.robot.joints) joint.max_effort = 1e-3;
  const Approach late = plan(problem, goal);
  CHECK(late.status == ApproachStatus::TooSlow);
  CHECK(late.late_by > 1);
  CHECK(late.detail.find("too slow for the longest duration") != std::string::npos);
}
