// The models of a contact beside each other, and what acts on the base besides the arm.
#include <catch2/catch.hpp>
#include <cmath>

#include <stillbase/impact/contact_impulse.hpp>
#include <stillbase/simulation/after_contact.hpp>

#include "simulation/robots.hpp"

namespace stillbase::test {
namespace {

/// A random arm that waits for a client coming along n.
ContactCase random_case(double restitution) {
  Random random(11, 3);
  ContactCase subject;
  subject.robot = random_robot(random, 5, false);
  for (Joint& joint : subject.robot.joints) {
    joint.lower = -10;
    joint.upper = 10;
    joint.max_effort = joint.max_velocity = 1e6;
  }
  subject.before = random_state(random, 5, 0);
  subject.before.Omega.setZero();
  subject.before.phidot.setZero();
  TargetAtContact target;
  target.body.name = "client";
  target.body.mass = 40;
  target.body.inertia = Vector3d(2, 3, 4).asDiagonal();
  const Kinematics<double> kinematics = compute_kinematics(subject.robot, subject.before.phi);
  const Vector3d hand = subject.before.base * kinematics.r_bh;
  const Vector3d r(0.3, 0.1, 0.2);
  target.state.pose.position = hand - r;
  target.state.velocity = Vector3d(0.2, 0.01, 0.02);
  target.state.angular_velocity = Vector3d(0.01, -0.02, 0.03);
  subject.target = target;
  subject.normal_N = Vector3d::UnitX();
  subject.restitution = restitution;

  // The frictionless jump of the contact laws.
  const Eigen::Quaterniond R_BN = subject.before.base.orientation.conjugate();
  const Matrix3d R = R_BN.toRotationMatrix();
  Contact contact;
  contact.restitution = restitution;
  contact.n = R * subject.normal_N;
  ContactTarget body;
  body.mass = target.body.mass;
  body.inertia = R * target.body.inertia * R.transpose();
  body.r = R * r;
  body.velocity = R * target.state.velocity;
  body.angular_velocity = R * target.state.angular_velocity;
  const ContactOutcome outcome =
      apply_contact(subject.robot, subject.before.phi, subject.before.Omega, subject.before.phidot,
                    {}, contact, body);
  REQUIRE(outcome.impulse.status == ContactStatus::Hit);
  subject.after = subject.before;
  subject.after.Omega = outcome.after.Omega;
  subject.after.phidot = outcome.after.phidot;
  subject.impulse = outcome.impulse.Fbar.head<3>().norm();
  subject.closing_speed = outcome.impulse.closing_speed;
  return subject;
}

SimulationOptions short_run(double horizon) {
  SimulationOptions options;
  options.integrator = IntegratorKind::Fehlberg78;
  options.horizon = horizon;
  options.control_period = 0.01;
  return options;
}

AfterContact run(const ContactCase& subject, const PostImpactSpec& spec, double horizon) {
  return simulate_after_contact(subject, spec, {}, short_run(horizon));
}

}  // namespace

TEST_CASE("a stiff compliant contact leaves the robot as the jump does", "[simulation]") {
  const ContactCase subject = random_case(0.5);
  const AfterContact jump = run(subject, {}, 0.05);
  double before = 1;
  for (const double stiffness : {1e6, 1e7, 1e8}) {
    PostImpactSpec spec;
    spec.contact.model = ContactModel::Compliant;
    spec.contact.stiffness = stiffness;
    const AfterContact contact = run(subject, spec, 0.05);
    REQUIRE(contact.encounter);
    REQUIRE(contact.encounter->contact.contacts == 1);
    CHECK(contact.encounter->separation_speed ==
          Approx(0.5 * subject.closing_speed).epsilon(30 / std::sqrt(stiffness)));
    CHECK(contact.encounter->momentum_error < 1e-9);
    const Vector6d difference =
        contact.simulation.trace.back().state.Omega - jump.simulation.trace.back().state.Omega;
    const double off = difference.norm() / jump.simulation.trace.back().state.Omega.norm();
    CHECK(off < before);
    before = off;
  }
  CHECK(before < 0.01);
}

TEST_CASE("friction of the contact changes what the target leaves", "[simulation]") {
  const ContactCase subject = random_case(0.5);
  PostImpactSpec spec;
  spec.contact.model = ContactModel::Compliant;
  const AfterContact smooth = run(subject, spec, 0.2);
  spec.contact.friction = 0.5;
  const AfterContact rough = run(subject, spec, 0.2);
  CHECK(rough.encounter->momentum_error < 1e-8);
  CHECK((rough.encounter->impulse_N - smooth.encounter->impulse_N).norm() >
        0.01 * smooth.encounter->impulse_N.norm());
}

TEST_CASE("a latch holds the target, and a controller without it in its model does worse",
          "[simulation]") {
  ContactCase subject = random_case(0);
  subject.law = ContactLaw::Latch;
  Controller rns;
  rns.kind = ControllerKind::RnsDamped;
  rns.joint_rate_edge = 100;
  PostImpactSpec spec;
  const AfterContact held = simulate_after_contact(subject, spec, rns, short_run(2));
  CHECK(held.is_held);
  double mass = 0, mass_held = held.robot.base.mass;
  mass += subject.robot.base.mass + 40;
  for (const Body& body : subject.robot.bodies) mass += body.mass;
  for (const Body& body : held.robot.bodies) mass_held += body.mass;
  CHECK(mass_held == Approx(mass));
  CHECK(held.simulation.summary.relative_momentum_drift < 1e-9);
  spec.model.target_mass_scale = 0;
  const AfterContact unknown = simulate_after_contact(subject, spec, rns, short_run(2));
  CHECK(unknown.simulation.summary.attitude_turned > 1.5 * held.simulation.summary.attitude_turned);
}

TEST_CASE("a latch of a hand that moves along holds a target that recedes", "[simulation]") {
  ContactCase subject = random_case(0);
  subject.law = ContactLaw::Latch;
  subject.target->state.velocity *= -1;
  subject.closing_speed *= -1;
  subject.impulse = 0;
  REQUIRE(subject.closing_speed < 0);
  Controller none;
  none.kind = ControllerKind::None;
  CHECK_FALSE(simulate_after_contact(subject, {}, none, short_run(0.1)).is_held);
  subject.before.phidot[0] = 0.01;
  CHECK(simulate_after_contact(subject, {}, none, short_run(0.1)).is_held);
}

TEST_CASE("controllers know the target that the case states for them", "[simulation]") {
  ContactCase subject = random_case(0);
  subject.law = ContactLaw::Latch;
  Controller rns;
  rns.kind = ControllerKind::RnsDamped;
  rns.joint_rate_edge = 100;
  PostImpactSpec spec;
  spec.model.target_mass_scale = 0.5;
  const AfterContact scaled = simulate_after_contact(subject, spec, rns, short_run(1));
  spec.model.target_mass_scale = 1;
  subject.known_target = subject.target->body;
  const AfterContact exact = simulate_after_contact(subject, spec, rns, short_run(1));
  subject.known_target->mass *= 0.5;
  subject.known_target->inertia *= 0.5;
  const AfterContact stated = simulate_after_contact(subject, spec, rns, short_run(1));
  CHECK(stated.simulation.summary.attitude_turned == scaled.simulation.summary.attitude_turned);
  CHECK(stated.simulation.summary.attitude_turned != exact.simulation.summary.attitude_turned);
}

TEST_CASE("a compliant contact neither sticks nor latches", "[simulation]") {
  ContactCase subject = random_case(0.5);
  PostImpactSpec spec;
  spec.contact.model = ContactModel::Compliant;
  for (const ContactLaw law : {ContactLaw::Sticking, ContactLaw::Latch}) {
    subject.law = law;
    CHECK_THROWS_AS(run(subject, spec, 0.1), std::invalid_argument);
  }
}

TEST_CASE("without a contact the robot continues its motion", "[simulation]") {
  ContactCase subject = random_case(0);
  subject.law = ContactLaw::Latch;
  subject.impulse = 0;
  subject.after = subject.before;
  PostImpactSpec spec;
  const AfterContact run_on = run(subject, spec, 0.1);
  CHECK_FALSE(run_on.is_held);
  CHECK(run_on.simulation.summary.peak_base_rate == 0);
  subject.target.reset();
  CHECK_THROWS_AS(run(subject, spec, 0.1), std::invalid_argument);
}

TEST_CASE("thrusters brake the base, keep their limit and are accounted for", "[simulation]") {
  const ContactCase subject = random_case(0.5);
  Controller damping;
  damping.kind = ControllerKind::JointDamping;
  SimulationOptions options = short_run(20);
  const SimulationResult without =
      simulate_post_impact(subject.robot, {}, subject.after, damping, options);
  CHECK(without.trace.back().state.thruster_impulse.norm() == 0);
  options.thrusters = {0.02, 1, 1e-4};
  const SimulationResult with =
      simulate_post_impact(subject.robot, {}, subject.after, damping, options);
  REQUIRE(without.summary.residual_base_rate > 1e-3);
  CHECK(with.summary.residual_base_rate < 0.7 * without.summary.residual_base_rate);
  CHECK(with.trace.back().state.thruster_impulse.norm() > 0);
  CHECK(with.summary.relative_momentum_drift < 1e-9);
  double largest = 0;
  for (const TraceSample& sample : with.trace) {
    largest = std::max(largest, sample.thruster_torque.lpNorm<Eigen::Infinity>());
  }
  CHECK(largest == Approx(0.02));
  // Within the dead band they are off.
  options.thrusters = {0.02, 1, 10};
  const SimulationResult idle =
      simulate_post_impact(subject.robot, {}, subject.after, damping, options);
  CHECK(idle.trace.back().state.thruster_impulse.norm() == 0);
}

}  // namespace stillbase::test
