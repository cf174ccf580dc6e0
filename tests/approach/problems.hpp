// Small capture problems for the tests of the approach, and what every found approach must satisfy.
#pragma once

#include <catch2/catch.hpp>

#include <stillbase/approach/approach.hpp>

#include "collision/planar_robot.hpp"

namespace stillbase::test {

constexpr double kDegree = 3.14159265358979323846 / 180;

inline JointVectord posture(std::initializer_list<double> degrees) {
  JointVectord phi(static_cast<Eigen::Index>(degrees.size()));
  Eigen::Index k = 0;
  for (const double d : degrees) phi[k++] = d * kDegree;
  return phi;
}

inline CaptureProblem problem_for(RobotModel robot, const JointVectord& start) {
  CaptureProblem problem;
  problem.robot = std::move(robot);
  problem.start = start;
  problem.approach.acceleration_limit = JointVectord::Constant(problem.robot.n(), 0.1);
  return problem;
}

inline CaptureProblem planar_problem(const JointVectord& start) {
  return problem_for(planar_robot(static_cast<int>(start.size())), start);
}

inline Configuration goal_at(const JointVectord& phi, double contact_time = 100,
                             const Pose& base = {}) {
  return {phi, base, contact_time};
}

inline Approach plan(const CaptureProblem& problem, const Configuration& goal,
                     const TargetMotion* target = nullptr, std::uint64_t seed = 1) {
  std::map<std::string, long> calls;
  return plan_approach(problem, goal, target, seed, {}, calls);
}

/// Joint positions, rates and accelerations on the stored Hermite segment i at u in [0, 1], written
/// apart from the library.
struct Sample {
  Eigen::VectorXd phi, phidot, phiddot;
};
inline Sample hermite(const Approach& a, std::size_t i, double u) {
  const double h = a.times[i + 1] - a.times[i];
  const Eigen::VectorXd q0 = a.joint_positions[i], q1 = a.joint_positions[i + 1];
  const Eigen::VectorXd m0 = h * a.joint_velocities[i], m1 = h * a.joint_velocities[i + 1];
  const Eigen::VectorXd c2 = 3 * (q1 - q0) - 2 * m0 - m1, c3 = 2 * (q0 - q1) + m0 + m1;
  return {q0 + u * (m0 + u * (c2 + u * c3)), (m0 + u * (2 * c2 + 3 * u * c3)) / h,
          (2 * c2 + 6 * u * c3) / (h * h)};
}

/// Sizes, ends, rest and limits of a found approach.
inline void check_motion(const CaptureProblem& problem, const Configuration& goal,
                         const Approach& a) {
  INFO(a.detail);
  REQUIRE(a.status == ApproachStatus::Found);
  const std::size_t count = a.times.size();
  REQUIRE(count >= 2);
  REQUIRE(a.joint_positions.size() == count);
  REQUIRE(a.joint_velocities.size() == count);
  REQUIRE(a.base_poses.size() == count);
  REQUIRE(a.base_velocities.size() == count);
  CHECK(a.joint_positions.front() == problem.start);
  CHECK(a.joint_positions.back() == goal.phi);
  CHECK(a.times.back() == goal.contact_time);
  CHECK(a.times.back() - a.times.front() - a.duration >= problem.approach.wait - 1e-9);
  CHECK(a.joint_velocities.front().isZero(0));
  CHECK(a.joint_velocities.back().isZero(0));
  CHECK(a.joint_velocities[count - 2].isZero(0));
  CHECK(a.base_poses.back().position == goal.base.position);
  double rate = 0, acceleration = 0;
  for (std::size_t i = 0; i + 1 < count; ++i) {
    REQUIRE(a.times[i] < a.times[i + 1]);
    for (int part = 0; part <= 20; ++part) {
      const Sample s = hermite(a, i, part / 20.0);
      for (int k = 0; k < problem.robot.n(); ++k) {
        const Joint& joint = problem.robot.joints[static_cast<std::size_t>(k)];
        rate = std::max(rate, std::abs(s.phidot[k]) / joint.max_velocity);
        acceleration =
            std::max(acceleration, std::abs(s.phiddot[k]) / problem.approach.acceleration_limit[k]);
        CHECK(s.phi[k] >= joint.lower - 1e-6);
        CHECK(s.phi[k] <= joint.upper + 1e-6);
      }
    }
  }
  CHECK(rate <= problem.approach.velocity_scale * (1 + 1e-6));
  CHECK(acceleration <= 1 + 1e-6);
  CHECK(acceleration > 0.5);  // the limit is used, not feared
}

}  // namespace stillbase::test
