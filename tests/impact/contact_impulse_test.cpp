// Contact laws between a moving robot and a moving target. Momenta and energies come from the
// reference dynamics, in N, so that nothing of the code under test judges itself.
#include <algorithm>
#include <cmath>

#include <catch2/catch.hpp>

#include <stillbase/core/random.hpp>
#include <stillbase/impact/attach_target.hpp>
#include <stillbase/impact/contact.hpp>
#include <stillbase/impact/contact_impulse.hpp>
#include <stillbase/impact/gradient.hpp>
#include <stillbase/reference/reference.hpp>
#include <stillbase/target/target.hpp>

#include "support/random_robot.hpp"

namespace stillbase {
namespace {

constexpr double kRelative = 1e-12;

struct Encounter {
  RobotModel robot;
  Pose base;  // T_NB
  JointVectord phi, phidot;
  Vector6d Omega;
  JointResistance resistance;
  Contact contact;
  ContactTarget target;
};

/// Random robot, target and velocities. Resistance: free, rotor inertia, servo or locked in turn;
/// `still_joints` as the energy statement of servo and lock needs them.
Encounter random_encounter(std::uint64_t seed, std::uint64_t stream, bool still_joints) {
  Random random(seed, stream);
  Encounter e;
  const int n = 1 + random.index(9);
  e.robot = random_robot(random, n, random.uniform() < 0.5);
  e.base = {random_vector(random, 0, 3), Eigen::Quaterniond(random_rotation(random))};
  e.phi.resize(n);
  e.phidot.resize(n);
  for (int k = 0; k < n; ++k) {
    e.phi[k] = random.uniform(-2, 2);
    e.phidot[k] = still_joints ? 0 : random.normal();
  }
  for (int i = 0; i < 6; ++i) e.Omega[i] = 0.5 * random.normal();
  switch (random.index(4)) {
    case 0:
      break;
    case 1:
      e.resistance.model = ResistanceModel::RotorInertia;
      e.resistance.rotor_inertia = JointVectord::Constant(n, random.uniform(0, 5));
      break;
    case 2:
      e.resistance.model = ResistanceModel::Servo;
      e.resistance.stiffness = JointVectord::Constant(n, random.uniform(0, 1e4));
      e.resistance.damping = JointVectord::Constant(n, random.uniform(0, 1e2));
      e.resistance.contact_duration = 0.01;
      break;
    case 3:
      e.resistance.model = ResistanceModel::Locked;
      for (int k = 0; k < n; ++k) e.resistance.locked.push_back(random.uniform() < 0.5);
      break;
  }
  e.contact.law = static_cast<ContactLaw>(random.index(3));
  e.contact.restitution = random.uniform();
  e.contact.n = random.unit_vector();
  e.target.mass = random.uniform(5, 500);
  if (e.contact.law == ContactLaw::Latch || random.uniform() < 0.8) {
    e.target.inertia = random_inertia(random, e.target.mass, 1);
    e.target.r = random_vector(random, 0.1, 1.5);
    e.target.angular_velocity = random_vector(random, 0, 0.5);
  }
  e.target.velocity = random_vector(random, 0, 2);
  return e;
}

/// Momenta and energy of robot and target, in N, and the sums of magnitudes that they cancel from.
struct Totals {
  Vector3d P, L;  // L about the origin of N
  double energy = 0;
  double P_scale = 0, L_scale = 0;
};

Totals totals(const Encounter& e, const Vector6d& Omega, const JointVectord& phidot,
              const Vector3d& target_velocity, const Vector3d& target_rate) {
  const auto d = reference::compute(e.robot, {e.phi, phidot, Omega});
  const Matrix3d R = e.base.orientation.toRotationMatrix();
  const Vector3d robot_centroid = e.base * Vector3d(d.centroid);
  const Vector3d target_centroid =
      e.base * Vector3d(d.hand_position - (e.target.is_point_mass() ? 0.0 : 1.0) * e.target.r);
  const Vector3d P_r = R * d.P, P_t = R * (e.target.mass * target_velocity);
  const Vector3d spin = e.target.inertia * target_rate;
  Eigen::VectorXd x(6 + phidot.size());
  x << Omega, phidot;
  Eigen::MatrixXd H = d.H;
  const auto n = phidot.size();
  H.bottomRightCorner(n, n).diagonal() += added_plant_inertia(e.resistance, static_cast<int>(n));
  Totals t;
  t.P = P_r + P_t;
  t.L = R * (d.L_g + spin) + robot_centroid.cross(P_r) + target_centroid.cross(P_t);
  t.energy = 0.5 * x.dot(H * x) + 0.5 * e.target.mass * target_velocity.squaredNorm() +
             0.5 * target_rate.dot(spin);
  t.P_scale = P_r.norm() + P_t.norm();
  t.L_scale = d.L_g.norm() + spin.norm() + robot_centroid.norm() * P_r.norm() +
              target_centroid.norm() * P_t.norm();
  return t;
}

Vector6d hand_velocity(const Encounter& e, const Vector6d& Omega, const JointVectord& phidot) {
  const auto d = reference::compute(e.robot, {e.phi, phidot, Omega});
  Eigen::VectorXd x(6 + phidot.size());
  x << Omega, phidot;
  return d.J * x;
}

struct Worst {
  double linear = 0, angular = 0, law = 0, penetration = 0, energy = 0;
  int hits = 0, separating = 0, pulling = 0;
};

void examine(Worst& worst, const Encounter& e) {
  const ContactOutcome out =
      apply_contact(e.robot, e.phi, e.Omega, e.phidot, e.resistance, e.contact, e.target);
  const ContactVelocities& after = out.after;
  const Totals a = totals(e, e.Omega, e.phidot, e.target.velocity, e.target.angular_velocity);
  const Totals b =
      totals(e, after.Omega, after.phidot, after.target_velocity, after.target_angular_velocity);
  const auto keep = [](double& value, double x) {
    value = std::isnan(x) ? HUGE_VAL : std::max(value, x);
  };
  keep(worst.linear, (a.P - b.P).norm() / std::max(a.P_scale, b.P_scale));
  keep(worst.angular, (a.L - b.L).norm() / std::max(a.L_scale, b.L_scale));
  const bool drives_work =
      e.resistance.model == ResistanceModel::Servo || e.resistance.model == ResistanceModel::Locked;
  if (!drives_work || e.phidot.isZero(0)) {
    keep(worst.energy, (b.energy - a.energy) / std::max(a.energy, b.energy));
  }

  ContactTarget moved = e.target;
  moved.velocity = after.target_velocity;
  moved.angular_velocity = after.target_angular_velocity;
  const Vector6d hand = hand_velocity(e, e.Omega, e.phidot);
  const Vector6d hand_after = hand_velocity(e, after.Omega, after.phidot);
  const Vector6d before = e.target.contact_velocity() - hand;
  const Vector6d rest = moved.contact_velocity() - hand_after;
  const double scale = hand.norm() + hand_after.norm() + e.target.contact_velocity().norm() +
                       moved.contact_velocity().norm();
  const double v_n = e.contact.n.dot(before.head<3>());
  switch (out.impulse.status) {
    case ContactStatus::Separating:
      ++worst.separating;
      keep(worst.law, v_n > 1e-12 * scale ? 1 : 0);
      keep(worst.law, out.impulse.Fbar.norm());
      return;
    case ContactStatus::Pulling:
      ++worst.pulling;
      keep(worst.law, e.contact.law == ContactLaw::Sticking ? 0 : 1);
      keep(worst.law, out.impulse.Fbar.norm());
      return;
    case ContactStatus::Hit:
      break;
  }
  ++worst.hits;
  keep(worst.penetration, e.contact.n.dot(rest.head<3>()) / scale);
  switch (e.contact.law) {
    case ContactLaw::Frictionless:
      keep(worst.law,
           std::abs(e.contact.n.dot(rest.head<3>()) + e.contact.restitution * v_n) / scale);
      keep(worst.law, out.impulse.Fbar.tail<3>().norm());
      keep(worst.law,
           e.contact.n.cross(out.impulse.Fbar.head<3>()).norm() / out.impulse.Fbar.norm());
      break;
    case ContactLaw::Sticking:
      keep(worst.law, rest.head<3>().norm() / scale);
      keep(worst.law, out.impulse.Fbar.tail<3>().norm());
      break;
    case ContactLaw::Latch:
      keep(worst.law, rest.norm() / scale);
      break;
  }
  keep(worst.law, std::abs(out.separation_speed + e.contact.n.dot(rest.head<3>())) / scale);
}

void check_encounters(std::uint64_t seed, int count) {
  Worst worst;
  for (int i = 0; i < count; ++i) {
    examine(worst, random_encounter(seed, static_cast<std::uint64_t>(i), i % 2 == 0));
  }
  CHECK(worst.linear <= kRelative);
  CHECK(worst.angular <= kRelative);
  CHECK(worst.law <= kRelative);
  CHECK(worst.penetration <= kRelative);
  CHECK(worst.energy <= kRelative);
  // Every branch has been there.
  CHECK(worst.hits > count / 4);
  CHECK(worst.separating > count / 4);
  CHECK(worst.pulling > 0);
}

}  // namespace

TEST_CASE("impacts conserve momentum, obey their law and never add energy: 1000 random cases") {
  check_encounters(301, 1000);
}

TEST_CASE("impacts conserve momentum, obey their law and never add energy: 100000 random cases",
          "[.slow]") {
  check_encounters(302, 100000);
}

TEST_CASE("the target's inverse inertia is the velocity that a push at the contact gives") {
  Random random(303);
  for (int trial = 0; trial < 100; ++trial) {
    ContactTarget target;
    target.mass = random.uniform(1, 100);
    target.inertia = random_inertia(random, target.mass, 1);
    target.r = random_vector(random, 0.1, 2);
    const Matrix6d W = target_inverse_inertia6(target);
    const Vector3d f = random.unit_vector(), t = random.unit_vector();
    target.velocity = f / target.mass;
    target.angular_velocity = target.inertia.inverse() * (target.r.cross(f) + t);
    Vector6d F;
    F << f, t;
    CHECK((W * F - target.contact_velocity()).norm() <= kRelative * W.norm());
    CHECK((W - W.transpose()).norm() == 0);
    const double along = f.dot(target_inverse_inertia3(target) * f);
    const Matrix3d inverse = target.inertia.inverse();
    CHECK(std::abs(along - target_inverse_mass(target.mass, inverse, target.r, f)) <=
          kRelative * along);
  }
}

TEST_CASE("a point mass takes no latch") {
  ContactTarget target;
  target.mass = 10;
  target.velocity = -Vector3d::UnitX();
  Contact latch;
  latch.law = ContactLaw::Latch;
  CHECK_THROWS_AS(target_inverse_inertia6(target), std::invalid_argument);
  CHECK_THROWS_AS(contact_impulse(latch, Matrix6d::Identity(), Vector6d::Zero(), target),
                  std::invalid_argument);
}

TEST_CASE("a sticking contact that would have to pull is reported, with no impulse") {
  // A hand that yields far more easily along x + y than across it: to stop a target that closes
  // slowly along x and slides fast along y takes a force that points away from n.
  Matrix6d W = Matrix6d::Identity();
  W.topLeftCorner<2, 2>() << 1, 0.9, 0.9, 1;
  ContactTarget target;
  target.mass = 1e6;
  target.velocity = {0.1, 1, 0};
  Contact contact;
  contact.law = ContactLaw::Sticking;
  const ContactImpulse impulse = contact_impulse(contact, W, Vector6d::Zero(), target);
  CHECK(impulse.status == ContactStatus::Pulling);
  CHECK(impulse.Fbar.norm() == 0);
  CHECK(std::abs(impulse.closing_speed - 0.1) < 1e-15);
  target.velocity = {1, 0.1, 0};
  CHECK(contact_impulse(contact, W, Vector6d::Zero(), target).status == ContactStatus::Hit);
}

TEST_CASE("a latch holds a turning target at closing speed zero, and nothing that goes away") {
  ContactTarget target;
  target.mass = 10;
  target.inertia = Matrix3d::Identity();
  target.angular_velocity = Vector3d::UnitX();
  Contact latch;
  latch.law = ContactLaw::Latch;
  const auto held = contact_impulse(latch, Matrix6d::Identity(), Vector6d::Zero(), target);
  CHECK(held.status == ContactStatus::Hit);
  CHECK(held.Fbar.tail<3>().norm() > 0.1);
  target.velocity = -Vector3d::UnitX();
  CHECK(contact_impulse(latch, Matrix6d::Identity(), Vector6d::Zero(), target).status ==
        ContactStatus::Separating);
}

TEST_CASE("after a latch the composite robot has the momentum and energy of robot and target") {
  double worst = 0;
  int held = 0;
  for (int i = 0; i < 400; ++i) {
    Encounter e = random_encounter(304, static_cast<std::uint64_t>(i), false);
    e.contact.law = ContactLaw::Latch;
    if (e.target.is_point_mass()) continue;
    if (e.contact.n.dot(e.target.contact_velocity().head<3>() -
                        hand_velocity(e, e.Omega, e.phidot).head<3>()) < 0) {
      e.contact.n = -e.contact.n;
    }
    const auto out =
        apply_contact(e.robot, e.phi, e.Omega, e.phidot, e.resistance, e.contact, e.target);
    REQUIRE(out.impulse.status == ContactStatus::Hit);
    ++held;
    const Totals before =
        totals(e, e.Omega, e.phidot, e.target.velocity, e.target.angular_velocity);
    const Totals after = totals(e, out.after.Omega, out.after.phidot, out.after.target_velocity,
                                out.after.target_angular_velocity);

    // The target frame at any attitude; its inertia given in that frame.
    Random random(305, static_cast<std::uint64_t>(i));
    const auto d = reference::compute(e.robot, {e.phi, {}, {}});
    const Matrix3d R_target = random_rotation(random);
    TargetBody body;
    body.mass = e.target.mass;
    body.inertia = R_target.transpose() * e.target.inertia * R_target;
    const Pose hand{d.hand_position, Eigen::Quaterniond(Matrix3d(d.hand_rotation))};
    const Pose target{d.hand_position - e.target.r, Eigen::Quaterniond(R_target)};
    Encounter composite = e;
    composite.robot = attach_target(e.robot, hand, body, target);
    composite.target.mass = 0;
    composite.target.inertia.setZero();
    const Totals whole =
        totals(composite, out.after.Omega, out.after.phidot, Vector3d::Zero(), Vector3d::Zero());
    worst = std::max({worst, (whole.P - before.P).norm() / before.P_scale,
                      (whole.L - before.L).norm() / before.L_scale,
                      std::abs(whole.energy - after.energy) / after.energy});
    const auto hand_again = reference::compute(composite.robot, {e.phi, {}, {}});
    worst = std::max(worst, (hand_again.hand_position - d.hand_position).norm());
  }
  CHECK(held > 200);
  CHECK(worst <= kRelative);
}

TEST_CASE("a target on a hand that is fixed to the base moves the base frame with the centroid") {
  Random random(306);
  RobotModel robot = random_robot(random, 3, true);
  robot.hand_body = kBase;
  robot.moves_hand.assign(3, false);
  robot.p_hand = {0.4, -0.2, 0.3};
  robot.R_hand = random_rotation(random);
  TargetBody body;
  body.mass = 30;
  body.inertia = random_inertia(random, 30, 1);
  const Pose at{random_vector(random, 0.2, 1), Eigen::Quaterniond(random_rotation(random))};
  const RobotModel whole = attach_target(robot, body, at);
  const Vector3d s = base_shift(robot, body, at);
  const JointVectord phi = JointVectord::Constant(3, 0.4), phidot = JointVectord::Constant(3, -0.7);
  Vector6d Omega;
  Omega << 0.1, 0.2, -0.3, 0.5, -0.4, 0.2;
  Vector6d shifted = Omega;
  shifted.head<3>() += Vector3d(Omega.tail<3>()).cross(s);

  const auto d = reference::compute(robot, {phi, phidot, Omega});
  const auto w = reference::compute(whole, {phi, phidot, shifted});
  const Vector3d omega = Omega.tail<3>();
  const Vector3d c = robot.p_hand + robot.R_hand * at.position;  // of the target
  const Matrix3d R = robot.R_hand * at.orientation.toRotationMatrix();
  const Vector3d P_t = body.mass * (Vector3d(Omega.head<3>()) + omega.cross(c));
  CHECK((w.P - d.P - P_t).norm() <= kRelative * w.P.norm());
  // About the base centroid of the robot without target.
  const Vector3d L =
      d.L_g + d.centroid.cross(d.P) + c.cross(P_t) + R * body.inertia * R.transpose() * omega;
  const Vector3d L_whole = w.L_g + (w.centroid + s).cross(w.P);
  CHECK((L - L_whole).norm() <= kRelative * L.norm());
  CHECK((w.hand_position + s - d.hand_position).norm() <= kRelative);
  CHECK(whole.base.centroid.norm() == 0);
}

TEST_CASE("the impulse that joins hand and target is Gauss's multiplier as well") {
  int joined = 0;
  double worst = 0;
  for (int trial = 0; trial < 200; ++trial) {
    Encounter e = random_encounter(77, static_cast<std::uint64_t>(trial), true);
    if (e.contact.law == ContactLaw::Frictionless) continue;
    e.Omega.setZero();
    const ContactOutcome out =
        apply_contact(e.robot, e.phi, e.Omega, e.phidot, e.resistance, e.contact, e.target);
    if (out.impulse.status != ContactStatus::Hit) continue;
    ++joined;
    const ImpactResistance prepared = prepare_resistance(e.resistance, e.robot.n());
    const bool is_point = e.target.is_point_mass();
    const reference::MetBody body{e.target.mass, e.target.inertia,
                                  is_point ? Vector3d(Vector3d::Zero()) : e.target.r,
                                  e.target.velocity, e.target.angular_velocity};
    const Vector6d F = reference::impulse_that_joins(reference::compute(e.robot, {e.phi, {}, {}}),
                                                     prepared.added_inertia, prepared.locked, body,
                                                     e.contact.law == ContactLaw::Latch);
    worst = std::max(worst, (F - out.impulse.Fbar).norm() / out.impulse.Fbar.norm());
  }
  CHECK(joined > 40);
  CHECK(worst < 1e-9);
}

}  // namespace stillbase
