// A contact that takes time, against the instantaneous jump.
#include <catch2/catch.hpp>
#include <cmath>
#include <stillbase/impact/contact_impulse.hpp>
#include <stillbase/simulation/after_contact.hpp>

#include "simulation/robots.hpp"

namespace stillbase::test {
namespace {

/// A body whose point r_T touches the hand of a robot with its outward normal n_T.
struct Touch {
  Vector3d r_T = Vector3d(0.2, 0.1, -0.15), n_T = Vector3d(1, 2, -1).normalized();
};

/// Puts the target of a case to the hand.
void touch(ContactCase& subject, const Touch& at) {
  const Vector3d hand =
      subject.before.base * compute_kinematics(subject.robot, subject.before.phi).r_bh;
  Pose& pose = subject.target->state.pose;
  pose.position = hand - pose.orientation * at.r_T;
  subject.normal_N = pose.orientation * at.n_T;
}

/// A tumbling body in front of the hand of a robot.
ContactCase tumbling(const RobotModel& robot, const JointVectord& phi, double restitution) {
  ContactCase subject;
  subject.robot = robot;
  subject.before = state_at_rest(Pose(), phi);
  subject.restitution = restitution;
  TargetAtContact& target = subject.target.emplace();
  target.body.mass = 50;
  target.body.inertia = Vector3d(3, 4, 5).asDiagonal();
  target.state.pose.orientation = rotation_exp(Vector3d(0.3, -0.2, 0.5));
  touch(subject, {});
  target.state.velocity = 0.05 * subject.normal_N + Vector3d(0.004, -0.003, 0.002);
  target.state.angular_velocity = Vector3d(0.02, 0.05, -0.03);
  return subject;
}

}  // namespace

TEST_CASE("with growing stiffness the compliant contact approaches the instantaneous jump",
          "[simulation]") {
  Random random(7, 2);
  const RobotModel robot = random_robot(random, 6, false);
  const PlantState posture = random_state(random, 6, 0);
  for (const double restitution : {0.2, 1.0}) {
    const ContactCase subject = tumbling(robot, posture.phi, restitution);
    const std::vector<ModelCheckRow> rows = check_stiffness(subject, 0, {1e4, 1e6, 1e8, 1e10});
    for (std::size_t i = 0; i < rows.size(); ++i) {
      INFO(restitution << " " << rows[i].stiffness << " " << rows[i].velocity_error);
      REQUIRE(rows[i].ended);
      CHECK(rows[i].momentum_error < 1e-9);
      // The error falls with the duration, which falls with the root of the stiffness.
      if (i > 0) CHECK(rows[i].velocity_error < 0.15 * rows[i - 1].velocity_error);
    }
    CHECK(rows.back().velocity_error < 1e-4);
    CHECK(rows.back().impulse_error < 1e-4);
  }
}

TEST_CASE("friction at the contact takes energy and leaves the momentum of the pair",
          "[simulation]") {
  Random random(7, 3);
  const RobotModel robot = random_robot(random, 5, false);
  const ContactCase subject = tumbling(robot, random_state(random, 5, 0).phi, 0.5);
  const ModelCheckRow smooth = check_stiffness(subject, 0, {1e7})[0];
  const ModelCheckRow rough = check_stiffness(subject, 0.3, {1e7})[0];
  CHECK(rough.momentum_error < 1e-9);
  CHECK(rough.kinetic_energy_after < smooth.kinetic_energy_after);
}

TEST_CASE("rotor inertia is the same in a contact of any duration", "[simulation]") {
  Random random(7, 4);
  const RobotModel robot = random_robot(random, 6, false);
  ContactCase subject = tumbling(robot, random_state(random, 6, 0).phi, 0.3);
  subject.resistance.model = ResistanceModel::RotorInertia;
  subject.resistance.rotor_inertia = JointVectord::Constant(6, 2.0);
  const std::vector<ModelCheckRow> rows = check_stiffness(subject, 0, {1e6, 1e8, 1e10});
  CHECK(rows.back().velocity_error < 1e-4);
}

TEST_CASE("the servo formula holds for short contacts and a free joint for shorter ones",
          "[simulation]") {
  const RobotModel robot = planar_two_link('A');
  ContactCase subject = tumbling(robot, JointVectord::Zero(2), 0.5);
  subject.before.phi << -80 * kDegree, 160 * kDegree;
  TargetPlantState& target = subject.target->state;
  target.pose.orientation = Eigen::Quaterniond::Identity();
  target.velocity = Vector3d(-0.5, 0, 0);
  target.angular_velocity.setZero();
  touch(subject, {.n_T = Vector3d(-1, 0, 0)});
  subject.resistance.model = ResistanceModel::Servo;
  subject.resistance.stiffness = JointVectord::Constant(2, 500.0);
  subject.resistance.damping = JointVectord::Constant(2, 50.0);
  const std::vector<ModelCheckRow> rows = check_stiffness(subject, 0, {1e4, 1e6, 1e8});
  for (std::size_t i = 0; i < rows.size(); ++i) {
    INFO(rows[i].duration << " servo " << rows[i].velocity_error << " free " << rows[i].free_error);
    CHECK(rows[i].velocity_error < rows[i].free_error);
    if (i > 0) CHECK(rows[i].free_error < 0.2 * rows[i - 1].free_error);
  }
}

TEST_CASE("the damping of a contact leaves the restitution asked for", "[simulation]") {
  CHECK(contact_damping(1, 1e5, 10) == Approx(0).epsilon(0).margin(1e-9));
  CHECK_THROWS_AS(contact_damping(0, 1e5, 10), std::invalid_argument);
  double before = 0;
  for (const double e : {0.9, 0.5, std::exp(-2.0), 0.1, 0.01, 0.001}) {
    const double d = contact_damping(e, 1e5, 10);
    CHECK(d > before);
    before = d;
  }
  // Critical damping is the case with a closed form: e = exp(-2).
  CHECK(contact_damping(std::exp(-2.0), 1e5, 10) == Approx(2 * std::sqrt(1e6)).epsilon(1e-6));
}

TEST_CASE("after a latch robot and target are one, momentum included", "[simulation]") {
  Random random(7, 5);
  const RobotModel robot = random_robot(random, 6, false);
  ContactCase subject;
  subject.robot = robot;
  subject.before = random_state(random, 6, 0.1);
  subject.target.emplace();
  const PlantState& before = subject.before;
  TargetBody& target = subject.target->body;
  target.name = "client";
  target.mass = 40;
  target.inertia = Vector3d(2, 3, 4).asDiagonal();
  TargetPlantState& motion = subject.target->state;
  motion.pose.orientation = rotation_exp(Vector3d(0.1, 0.4, -0.2));
  motion.angular_velocity = Vector3d(0.05, -0.02, 0.03);
  const Kinematics<double> kinematics = compute_kinematics(robot, before.phi);
  const Vector3d hand = before.base * kinematics.r_bh;
  motion.pose.position = hand - Vector3d(0.3, 0.1, 0.2);
  subject.normal_N = Vector3d(1, 0, 0);
  motion.velocity = Vector3d(2, 0.02, 0.01);  // fast enough to close in on any hand
  const LatchedRobot latched = latch_target(subject);
  REQUIRE(latched.impulse.status == ContactStatus::Hit);

  const auto momentum = [](const RobotModel& model, const PlantState& state, Vector3d& angular) {
    const PlantTerms terms(model, JointVectord::Zero(model.n()), state);
    const Momentum<double> m =
        compute_momentum(terms.inertia, terms.tilde, state.Omega, state.phidot);
    const Vector3d P = state.base.orientation * m.P;
    angular = state.base.orientation * m.L_g + (state.base * terms.inertia.r_bg).cross(P);
    return P;
  };
  Vector3d L0, L1;
  Vector3d P0 = momentum(robot, before, L0);
  const Vector3d p = target.mass * motion.velocity;
  P0 += p;
  L0 += motion.pose.position.cross(p) +
        motion.pose.orientation * Vector3d(target.inertia * motion.angular_velocity);
  const Vector3d P1 = momentum(latched.robot, latched.state, L1);
  CHECK((P1 - P0).norm() < 1e-10 * P0.norm());
  CHECK((L1 - L0).norm() < 1e-9 * L0.norm());

  // The controllers work on the whole: the base stops turning although the target is heavy.
  Controller rns;
  rns.kind = ControllerKind::RnsDamped;
  rns.joint_rate_edge = 100;
  SimulationOptions options;
  options.integrator = IntegratorKind::Dopri5;
  options.control_period = 0.002;
  options.horizon = 1;
  const SimulationResult result =
      simulate_post_impact(latched.robot, {}, latched.state, rns, options);
  CHECK(result.summary.residual_base_rate < 0.05 * latched.state.Omega.tail<3>().norm());
}

}  // namespace stillbase::test
