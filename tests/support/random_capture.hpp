// Random capture problems that nobody tuned a search for: arms of 6 to 8 revolute joints on a free
// base, a tumbling target, a cone of directions. One number gives one problem on every machine.
#pragma once

#include <stillbase/encounter/encounter.hpp>

#include "support/capture_problems.hpp"

namespace stillbase {

/// A serial arm with joint axes at right angles to each other or parallel, as industrial arms have
/// them, lighter towards the hand; masses, lengths and limits are random.
inline RobotModel random_arm(Random& random, int joints) {
  RobotModel robot;
  robot.name = "random_arm";
  robot.base.mass = random.uniform(30, 300);
  robot.base.inertia = random_inertia(random, robot.base.mass, 1.0);
  const double reach = random.uniform(0.8, 2.5);  // m, of the arm
  double mass = random.uniform(4, 15);
  for (int k = 0; k < joints; ++k) {
    Joint joint;
    const bool is_continuous = random.uniform() < 0.2;
    joint.type = is_continuous ? JointType::Continuous : JointType::Revolute;
    joint.parent = k - 1;
    if (k == 0) {
      joint.R = random_rotation(random);
      joint.p = random_vector(random, 0.2, 0.6);
    } else {
      // The next axis: parallel, or normal to this one.
      const double twist = random.uniform() < 0.25 ? 0 : (random.uniform() < 0.5 ? -90 : 90);
      joint.R = rotation_rpy(twist * kPi / 180, 0, 0).toRotationMatrix();
      const double along = random.uniform() < 0.5 ? random.uniform(0.1, 0.5) : 0;
      const double across = random.uniform() < 0.5 ? random.uniform(0.05, 0.5) : 0;
      joint.p = reach / joints * 3 * Vector3d(across, 0, along);
    }
    if (!is_continuous) {
      joint.upper = random.uniform(1.9, 3.1);
      joint.lower = random.uniform() < 0.7 ? -joint.upper : -random.uniform(0.3, 3.1);
    }
    joint.max_velocity = random.uniform(1, 3);
    joint.max_effort = random.uniform(40, 200);
    robot.joints.push_back(joint);

    Body body;
    body.mass = mass;
    body.centroid = random_vector(random, 0, 0.5 * reach / joints);
    body.inertia = random_inertia(random, mass, 1.5 * reach / joints);
    robot.bodies.push_back(body);
    mass *= random.uniform(0.55, 0.95);
  }
  const Pose hand{Vector3d(0, 0, random.uniform(0.05, 0.25)), Eigen::Quaterniond::Identity()};
  return with_links_and_hand(std::move(robot), joints - 1, hand);
}

/// A posture within the limits, away from them.
inline JointVectord random_posture(Random& random, const RobotModel& robot) {
  JointVectord phi(robot.n());
  for (int k = 0; k < robot.n(); ++k) {
    const Joint& joint = robot.joints[static_cast<std::size_t>(k)];
    const double lower = std::max(joint.lower, -kPi), upper = std::min(joint.upper, kPi);
    phi[k] = lower + (upper - lower) * random.uniform(0.1, 0.9);
  }
  return phi;
}

/// A robust capture with at least one degree of freedom: fixed pose or axis of the hand, a cone of
/// 5 to 30 deg, base attitude free or not. It has a solution of its constraints.
inline CaptureProblem random_capture(std::uint64_t number) {
  Random random(2024, number);
  const int joints = 6 + random.index(3);
  CaptureProblem problem;
  problem.name = std::string("random_").append(std::to_string(number));
  problem.purpose = "A random capture.";
  problem.source = problem.name + ".yaml";
  problem.robot = random_arm(random, joints);
  problem.start = random_posture(random, problem.robot);
  problem.variables.joints.assign(static_cast<std::size_t>(joints), true);
  if (random.uniform() < 0.5) {
    problem.resistance.model = ResistanceModel::RotorInertia;
    problem.resistance.rotor_inertia = JointVectord::Constant(joints, random.uniform(0.1, 3));
  }

  problem.hand.constraint = random.uniform() < 0.5 ? HandConstraint::Pose : HandConstraint::Axis;
  const bool is_turned = random.uniform() < 0.3;
  if (is_turned) {
    problem.variables.base_attitude = AttitudeFreedom::Free;
    problem.variables.base_attitude_max = random.uniform(0.1, 0.6);
  }
  // A fixed station takes three more degrees of freedom.
  const int needed = problem.hand.constraint == HandConstraint::Pose ? 6 : 5;
  const bool is_held = random.uniform() < 0.35 && joints + (is_turned ? 3 : 0) > needed;
  problem.variables.base_position = is_held ? PositionFreedom::Fixed : PositionFreedom::Free;

  TargetBody target;
  target.name = "client";
  target.mass = random.uniform(20, 300);
  target.inertia = random_inertia(random, target.mass, random.uniform(0.5, 1.5));
  target.features.push_back({"feature", random_vector(random, 0.1, 0.8), random.unit_vector()});
  problem.target = target;
  problem.variables.feature = "feature";
  problem.impulse.source =
      random.uniform() < 0.8 ? ImpulseSource::RigidBody : ImpulseSource::PointMass;
  problem.impulse.restitution = random.uniform(0, 0.8);

  // The target so that one posture has the hand at the feature, with its axes as asked for.
  const EncounterModel model = encounter_model(problem);
  const auto at = compute_kinematics<double>(problem.robot, random_posture(random, problem.robot));
  const Matrix3d R_NT = at.R_hand * model.hand_axes.transpose();
  const Vector3d n = R_NT * model.n, r = R_NT * model.r;
  const Vector3d spin = random_vector(random, 0, 0.1);
  const double speed = random.uniform(0.02, 0.1);
  TargetState& state = problem.target_state;
  state.pose = {at.r_bh - r, Eigen::Quaterniond(R_NT)};
  state.angular_velocity = spin;
  state.linear_velocity =
      speed * n + speed * random.uniform(0, 0.4) * n.unitOrthogonal() - spin.cross(r);
  const double window = random.uniform() < 0.25 ? random.uniform(0.2, 2) : 0;
  state.time = 10;
  problem.variables.contact_time_lower = 10 - window;
  problem.variables.contact_time_upper = 10 + window;

  problem.constraints.closing_speed_min = 1e-3;
  const double quantity = random.uniform();
  problem.objective = {{quantity < 0.7    ? ObjectiveQuantity::BaseAngularMomentum
                        : quantity < 0.85 ? ObjectiveQuantity::BaseAngularVelocity
                                          : ObjectiveQuantity::BaseEnergy}};
  problem.measure.kind = RiskMeasure::WorstCase;
  problem.uncertainty.cone_half_angle = random.uniform(5, 30) * kPi / 180;
  problem.approach.enabled = false;
  return problem;
}

}  // namespace stillbase
