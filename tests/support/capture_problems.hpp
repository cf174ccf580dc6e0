// Capture problems made in code for the tests of this room.
#pragma once

#include <cmath>

#include <stillbase/core/random.hpp>
#include <stillbase/plan/problem.hpp>

#include "support/random_robot.hpp"

namespace stillbase {

/// A point mass comes along `direction` (in B) at 1 m/s and bounces off elastically.
inline CaptureProblem point_mass_problem(const RobotModel& robot, const Vector3d& direction) {
  CaptureProblem problem;
  problem.source = "test.yaml";
  problem.robot = robot;
  problem.start = JointVectord::Zero(robot.n());
  problem.variables.joints.assign(static_cast<std::size_t>(robot.n()), true);
  problem.impulse.source = ImpulseSource::PointMass;
  problem.impulse.direction = direction;
  problem.impulse.closing_speed = 1;
  problem.impulse.restitution = 1;
  TargetBody target;
  target.name = "ball";
  target.mass = 100;
  target.is_point_mass = true;
  problem.target = target;
  return problem;
}

/// A tumbling box with an off-centre feature drifts towards the robot; everything is free.
inline CaptureProblem tumbling_problem(Random& random, const RobotModel& robot) {
  CaptureProblem problem;
  problem.source = "test.yaml";
  problem.robot = robot;
  problem.start = JointVectord::Zero(robot.n());
  problem.variables.joints.assign(static_cast<std::size_t>(robot.n()), true);
  problem.impulse.source = ImpulseSource::RigidBody;
  problem.impulse.restitution = 0.4;
  TargetBody target;
  target.name = "client";
  target.mass = 50;
  target.inertia = Vector3d(3, 4, 5).asDiagonal();
  target.features.push_back({"plus_x", {0.3, 0.12, 0.06}, Vector3d::UnitX()});
  problem.target = target;
  problem.target_state.pose.position = {-2.5, 0.2, 0.1};
  problem.target_state.pose.orientation = rotation_exp(0.3 * random.unit_vector());
  problem.target_state.linear_velocity = {0.05, 0, 0};
  problem.target_state.angular_velocity = 0.05 * random.unit_vector();
  problem.variables.feature = "plus_x";
  problem.variables.base_attitude = AttitudeFreedom::Free;
  problem.variables.base_position = PositionFreedom::Box;
  problem.variables.base_position_lower = {-5, -5, -5};
  problem.variables.base_position_upper = {5, 5, 5};
  problem.variables.contact_time_lower = 0;
  problem.variables.contact_time_upper = 5;
  problem.hand.constraint = HandConstraint::Axis;
  return problem;
}

}  // namespace stillbase
