// Robot and held target brought to rest by wheels, within what grip, joints and wheels bear.
#include <catch2/catch.hpp>
#include <cmath>

#include <stillbase/dynamics/jacobian.hpp>
#include <stillbase/simulation/after_contact.hpp>

#include "simulation/robots.hpp"

namespace stillbase::test {
namespace {

Vector3d random_vector(Random& random, double size) {
  return size * Vector3d(random.normal(), random.normal(), random.normal());
}

/// A random arm that latches a client of 40 kg; both drift and turn slowly then.
struct Capture {
  ContactCase subject;
  LatchedRobot latched;
  Vector3d L_g = Vector3d::Zero();  ///< of robot and client, in B, N m s
};

Capture random_capture(std::uint64_t seed, double speed = 0.05) {
  Random random(seed, 1);
  Capture capture;
  ContactCase& subject = capture.subject;
  subject.robot = random_robot(random, 6, false);
  subject.robot.base.mass *= 20;
  subject.robot.base.inertia *= 20;
  for (Joint& joint : subject.robot.joints) {
    joint.lower = -10;
    joint.upper = 10;
    joint.max_velocity = 1;
    joint.max_effort = 50;
  }
  subject.before = random_state(random, 6, 0);
  subject.before.Omega.setZero();
  subject.before.phidot.setZero();
  TargetAtContact target;
  target.body.mass = 40;
  target.body.inertia = Vector3d(4, 6, 8).asDiagonal();
  const Kinematics<double> kinematics = compute_kinematics(subject.robot, subject.before.phi);
  const Vector3d hand = subject.before.base * kinematics.r_bh;
  const Vector3d r(-0.5, 0.1, 0.2);
  target.state.pose.position = hand - r;
  target.state.angular_velocity = random_vector(random, 0.5 * speed);
  target.state.velocity = Vector3d(speed, 0, 0) - target.state.angular_velocity.cross(r);
  subject.target = target;
  subject.normal_N = Vector3d::UnitX();
  subject.law = ContactLaw::Latch;
  subject.impulse = subject.closing_speed = 1;
  capture.latched = latch_target(subject);
  REQUIRE(capture.latched.impulse.status == ContactStatus::Hit);
  const PlantTerms terms(capture.latched.robot, JointVectord::Zero(6), capture.latched.state);
  capture.L_g = compute_momentum(terms.inertia, terms.tilde, capture.latched.state.Omega,
                                 capture.latched.state.phidot)
                    .L_g;
  return capture;
}

/// Wheels that need `time` at least.
PostImpactSpec wheels_for(const Capture& capture, double time) {
  PostImpactSpec spec;
  spec.wheels.torque.setConstant(capture.L_g.lpNorm<Eigen::Infinity>() / time);
  return spec;
}

SimulationResult run_under(ControllerKind kind, const Capture& capture, const PostImpactSpec& spec,
                           double horizon) {
  SimulationOptions options = plant_options_of(spec, capture.subject.robot);
  options.integrator = IntegratorKind::Dopri5;
  options.relative_tolerance = 1e-8;
  options.absolute_tolerance = 1e-10;
  options.horizon = horizon;
  Controller controller;
  controller.kind = kind;
  ContactCase subject = capture.subject;
  subject.before.wheel_momentum = spec.wheels.preset;
  AfterContact run = simulate_after_contact(subject, spec, controller, options);
  REQUIRE(run.is_held);
  REQUIRE(run.simulation.status == SimulationStatus::Finished);
  return run.simulation;
}

SimulationResult detumble(const Capture& capture, const PostImpactSpec& spec, double horizon) {
  return run_under(ControllerKind::Detumble, capture, spec, horizon);
}

}  // namespace

TEST_CASE("the grip's wrench is what the robot alone lacks in its equation of motion",
          "[simulation]") {
  Random random(3);
  for (int trial = 0; trial < 20; ++trial) {
    const RobotModel robot = random_robot(random, 6, trial % 2 == 0);
    const PlantState state = random_state(random, 6, 1);
    TargetBody body;
    body.mass = 30;
    body.inertia = Vector3d(2, 3, 4).asDiagonal();
    const Pose hand_target{random_vector(random, 0.5), random_state(random, 6, 0).base.orientation};
    const RobotModel both = attach_target(robot, body, hand_target);
    const JointVectord rotors = JointVectord::LinSpaced(6, 0, 2);
    const JointVectord tau = JointVectord::LinSpaced(6, -3, 2);
    Vector6d F_b;
    F_b << random_vector(random, 2), random_vector(random, 2);
    const PlantTerms terms(both, rotors, state);
    const PlantAcceleration a = compute_acceleration(terms, F_b, tau);
    const Vector6d wrench = grip_wrench({body, hand_target}, both, terms.kinematics, state, a);

    const PlantTerms alone(robot, rotors, state);
    const HandJacobian<double> J = compute_hand_jacobian(robot, alone.kinematics);
    const InertiaMatrices<double>& H = alone.inertia;
    const Vector6d base = H.H_b * a.dot_Omega + H.H_bphi * a.phiddot + alone.bias.c_b - F_b;
    const JointVectord joints =
        H.H_bphi.transpose() * a.dot_Omega + H.H_phi * a.phiddot + alone.bias.c_phi - tau;
    const double scale = 1 + wrench.norm();
    INFO("trial " << trial);
    CHECK((base + J.R_bh.transpose() * wrench).norm() < 1e-9 * scale);
    CHECK((joints + J.J_phi.transpose() * wrench).norm() < 1e-9 * scale);
  }
}

TEST_CASE("detumble is at rest within 5 % of the time that the wheels need at least",
          "[simulation]") {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const Capture capture = random_capture(seed);
    const double least = 8;
    const SimulationResult run = detumble(capture, wheels_for(capture, least), 12);
    const SimulationSummary& summary = run.summary;
    INFO("seed " << seed);
    REQUIRE(summary.rest_time);
    CHECK(*summary.rest_time < 1.05 * least);
    // No wheels are faster but for the base's own rotation and what counts as rest.
    CHECK(*summary.rest_time > 0.9 * least);
    const TraceSample& last = run.trace.back();
    CHECK(last.total.norm() < 1e-3 * capture.L_g.norm());
    CHECK(last.state.phidot.norm() < 1e-4);
    CHECK(last.state.Omega.tail<3>().norm() < 1e-4);
    // The momentum is in the wheels, in N.
    const Vector3d wheels_N = last.state.base.orientation * last.state.wheel_momentum;
    CHECK((wheels_N - run.trace.front().total_N).norm() < 2e-3 * capture.L_g.norm());
    CHECK(summary.relative_momentum_drift < 1e-6);
  }
}

TEST_CASE("errors of the rates excuse one deviation of the momentum and no more", "[simulation]") {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const Capture capture = random_capture(seed);
    const double least = 8;
    const PlantTerms terms(capture.latched.robot, JointVectord::Zero(6), capture.latched.state);
    const double widest = terms.tilde.Htilde_omega.operatorNorm();
    PostImpactSpec spec = wheels_for(capture, least);
    spec.sensor.base_rate_error = 0.1 * capture.L_g.norm() / widest;
    const SimulationResult run = detumble(capture, spec, 14);
    INFO("seed " << seed);
    REQUIRE(run.summary.rest_time);
    // One deviation is a tenth of the momentum at most, which the wheels take evenly.
    CHECK(*run.summary.rest_time > 0.85 * least);
    for (const TraceSample& sample : run.trace) {
      if (sample.time < *run.summary.rest_time) continue;
      CHECK(sample.total.norm() < 0.11 * capture.L_g.norm());
    }
  }
}

TEST_CASE("rns_handback gives the momentum of robot and target to the wheels, the base keeps still",
          "[simulation]") {
  const Capture capture = random_capture(1, 0.02);
  const SimulationResult run =
      run_under(ControllerKind::RnsHandback, capture, wheels_for(capture, 4), 20);
  const TraceSample& last = run.trace.back();
  CHECK(last.total.norm() < 1e-3 * capture.L_g.norm());
  CHECK(last.state.Omega.tail<3>().norm() < 1e-4);
  CHECK(run.summary.relative_momentum_drift < 1e-6);
  // Stronger wheels need the same time for the arm, detumble does not.
  const SimulationResult fast = detumble(capture, wheels_for(capture, 4), 20);
  REQUIRE(fast.summary.rest_time);
  CHECK(*fast.summary.rest_time < run.summary.rest_time.value_or(20));
}

TEST_CASE("detumble keeps the limits of grip and joints, and takes longer for it", "[simulation]") {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    Capture capture = random_capture(seed);
    PostImpactSpec spec = wheels_for(capture, 4);
    const SimulationResult free = detumble(capture, spec, 20);
    REQUIRE(free.summary.rest_time);
    INFO("seed " << seed);
    PostImpactSpec gripped = spec;
    gripped.grip.force = 0.3 * free.summary.peak_grip_force;
    gripped.grip.moment = 0.3 * free.summary.peak_grip_moment;
    const SimulationResult weak = detumble(capture, gripped, 20);
    CHECK(weak.summary.peak_grip_force <= *gripped.grip.force);
    CHECK(weak.summary.peak_grip_moment <= *gripped.grip.moment);
    REQUIRE(weak.summary.rest_time);
    CHECK(*weak.summary.rest_time >= 0.99 * *free.summary.rest_time);

    for (int k = 0; k < 6; ++k) {
      capture.subject.robot.joints[static_cast<std::size_t>(k)].max_effort =
          0.3 * free.summary.peak_demanded_torques[k];
    }
    const SimulationResult slack = detumble(capture, spec, 20);
    for (int k = 0; k < 6; ++k) {
      CHECK(slack.summary.peak_demanded_torques[k] <=
            capture.subject.robot.joints[static_cast<std::size_t>(k)].max_effort);
    }
    CHECK(slack.summary.rest_time.has_value());
  }
}

TEST_CASE("detumble fills no wheel beyond its capacity, a preset makes room", "[simulation]") {
  const Capture capture = random_capture(2);
  PostImpactSpec spec = wheels_for(capture, 4);
  Eigen::Index axis = 0;
  const double h = capture.L_g.cwiseAbs().maxCoeff(&axis);
  spec.wheels.momentum.setConstant(0.6 * h);
  const SimulationResult full = detumble(capture, spec, 12);
  CHECK(full.summary.peak_wheel_momenta.maxCoeff() <= 0.6 * h * (1 + 1e-9));
  CHECK_FALSE(full.summary.rest_time.has_value());
  const SimulationResult handed = run_under(ControllerKind::RnsHandback, capture, spec, 20);
  CHECK(handed.summary.peak_wheel_momenta.maxCoeff() <= 0.6 * h * (1 + 1e-12));
  spec.wheels.preset = -0.5 * capture.L_g;
  const SimulationResult half = detumble(capture, spec, 12);
  CHECK(half.summary.peak_wheel_momenta.maxCoeff() <= 0.6 * h * (1 + 1e-9));
  CHECK(half.summary.rest_time.has_value());
}

TEST_CASE("a wheel that was filled up is full, whatever rounding left of its room",
          "[simulation]") {
  const Capture capture = random_capture(2);
  PostImpactSpec spec = wheels_for(capture, 4);
  spec.wheels.momentum.setConstant(0.6 * capture.L_g.cwiseAbs().maxCoeff());
  Eigen::Index axis = 0;
  capture.L_g.cwiseAbs().maxCoeff(&axis);
  for (const ControllerKind kind : {ControllerKind::Detumble, ControllerKind::RnsHandback}) {
    Controller controller;
    controller.kind = kind;
    controller.K_handback = 10;  // beyond what the wheels give: the fullest one counts
    const auto torque = [&](double filled) {
      PlantState state = capture.latched.state;
      state.wheel_momentum[axis] = std::copysign(filled, capture.L_g[axis]);
      const PlantTerms terms(capture.latched.robot, JointVectord::Zero(6), state);
      return control_command(controller, spec.wheels, capture.latched.robot, terms, state, 5, {},
                             0.01)
          .wheel_torque;
    };
    const double capacity = spec.wheels.momentum[axis];
    const Vector3d full = torque(capacity);
    INFO(to_string(kind));
    CHECK(full[axis] == 0);
    for (const double rest : {-1e-15, 1e-15, 1e-12}) {
      CHECK((torque(capacity * (1 - rest)) - full).isZero(0));
    }
    CHECK_FALSE((torque(capacity * 0.99) - full).isZero(1e-6));
  }
}

TEST_CASE("wheels of other torques per axis are used in proportion", "[simulation]") {
  const Capture capture = random_capture(4);
  PostImpactSpec spec;
  spec.wheels.torque = Vector3d(0.5, 1, 0.25) * capture.L_g.norm() / 6;
  const double least = (capture.L_g.cwiseAbs().array() / spec.wheels.torque.array()).maxCoeff();
  const SimulationResult run = detumble(capture, spec, 1.6 * least);
  REQUIRE(run.summary.rest_time);
  CHECK(*run.summary.rest_time < 1.1 * least);
  for (int i = 0; i < 3; ++i) {
    CHECK(run.summary.peak_wheel_torques[i] <= spec.wheels.torque[i] * (1 + 1e-12));
  }
}

TEST_CASE("the grip's limits hold in a thousand captures by detumble", "[simulation][.slow]") {
  int kept = 0;
  for (std::uint64_t seed = 1; seed <= 1000; ++seed) {
    const Capture capture = random_capture(seed, 0.02);
    PostImpactSpec spec = wheels_for(capture, 4);
    spec.grip.force = 2;
    spec.grip.moment = 2;
    const SimulationResult run = detumble(capture, spec, 2);
    kept += run.summary.peak_grip_force <= 2 && run.summary.peak_grip_moment <= 2;
  }
  CHECK(kept == 1000);
}

}  // namespace stillbase::test
