#include <catch2/catch.hpp>

#include <stillbase/core/random.hpp>
#include <stillbase/impact/attach_target.hpp>
#include <stillbase/impact/contact_impulse.hpp>
#include <stillbase/impact/contact_response.hpp>

#include "impact/contact_response_kernel.hpp"
#include "impact/random_resistance.hpp"
#include "support/autodiff_kernel.hpp"
#include "support/coupled_robot.hpp"
#include "support/random_capture.hpp"

namespace stillbase {
namespace {

constexpr ContactLaw kLaws[] = {ContactLaw::Sticking, ContactLaw::Latch};

JointVectord joints_at_random(Random& random, int n) {
  JointVectord phi(n);
  for (int k = 0; k < n; ++k) phi[k] = random.uniform(-2, 2);
  return phi;
}

TargetAtHand<double> target_at_random(Random& random) {
  TargetAtHand<double> target;
  const double mass = random.uniform(5, 300);
  target.inverse_mass = 1 / mass;
  target.inertia = random_inertia(random, mass, 1);
  target.inverse_inertia = target.inertia.inverse();
  target.r = random_vector(random, 0.2, 1);
  target.velocity = random_vector(random, 0.01, 0.1);
  target.omega = random_vector(random, 0.01, 0.1);
  return target;
}

RigidContact<double> contact_at_random(Random& random, ContactLaw law) {
  RigidContact<double> contact;
  contact.law = law;
  contact.target = target_at_random(random);
  return contact;
}

/// The hand on some joint's body.
RobotModel robot_at_random(Random& random, int n, bool is_planar) {
  RobotModel robot = random_robot(random, n, is_planar);
  while (robot.hand_body == kBase) robot = random_robot(random, n, is_planar);
  return robot;
}

ContactTarget plain(const TargetAtHand<double>& target) {
  return {1 / target.inverse_mass, target.inertia, target.r, target.velocity, target.omega};
}

ResponseWeights<double> weights_at_random(Random& random, int n) {
  ResponseWeights<double> weights;
  weights.velocity = random.unit_vector();
  weights.omega = random.unit_vector();
  weights.base = random.unit_vector();
  weights.total = random.unit_vector();
  weights.momentum << random.unit_vector(), random.unit_vector();
  weights.phidot = joints_at_random(random, n);
  weights.force = random.unit_vector();
  return weights;
}

template <class S>
S weighted_parts(const PostureImpact<S>& posture, const ImpactResponse<S>& response,
                 const ResponseWeights<double>& weights) {
  const Vector6<S> momentum = posture.inertia.H_b * response.d.Delta_Omega + response.held_momentum;
  const Vector6<S>& Omega = response.d.Delta_Omega;
  const JointVector<S> u = weights.phidot.template cast<S>();
  return Vector3<S>(Omega.template head<3>()).dot(weights.velocity.template cast<S>()) +
         response.omega().dot(weights.omega.template cast<S>()) +
         response.base.dot(weights.base.template cast<S>()) +
         response.total.dot(weights.total.template cast<S>()) +
         momentum.dot(weights.momentum.template cast<S>()) + response.d.Delta_phidot.dot(u) +
         Vector3<S>(response.F.template head<3>()).dot(weights.force.template cast<S>());
}

/// Size of the terms of weighted_parts, which may cancel.
double size_of_parts(const PostureImpact<double>& posture, const ImpactResponse<double>& response,
                     const ResponseWeights<double>& weights) {
  const Vector6d momentum = posture.inertia.H_b * response.d.Delta_Omega + response.held_momentum;
  return response.d.Delta_Omega.norm() * (weights.velocity.norm() + weights.omega.norm()) +
         response.base.norm() * weights.base.norm() + response.total.norm() * weights.total.norm() +
         momentum.norm() * weights.momentum.norm() +
         response.d.Delta_phidot.norm() * weights.phidot.norm() +
         response.F.norm() * weights.force.norm();
}

/// x + x x theta, theta three variables from `first` on.
Matrix3<Dual> small_rotation(int first, int size) {
  Vector3<Dual> theta;
  for (int i = 0; i < 3; ++i) theta[i] = Dual(0, size, first + i);
  return Matrix3<Dual>::Identity() - skew<Dual>(theta);
}

/// The target as numbers with derivatives: in the axes of B turned by a small rotation (three
/// variables from `first` on), its velocities changed by the six variables after these.
TargetAtHand<Dual> varied(const TargetAtHand<double>& target, int first, int size) {
  const auto variables = [&](int from, const Vector3d& value) {
    Vector3<Dual> out;
    for (int i = 0; i < 3; ++i) out[i] = Dual(value[i], size, from + i);
    return out;
  };
  const Matrix3<Dual> R = small_rotation(first, size);
  TargetAtHand<Dual> out;
  out.inverse_mass = Dual(target.inverse_mass, Eigen::VectorXd::Zero(size));
  out.inertia = R * target.inertia.cast<Dual>() * R.transpose();
  out.inverse_inertia = R * target.inverse_inertia.cast<Dual>() * R.transpose();
  out.r = R * target.r.cast<Dual>();
  out.velocity = R * variables(first + 3, target.velocity);
  out.omega = R * variables(first + 6, target.omega);
  return out;
}

/// A hand that moves, for arms of six joints and more.
struct MovingHand {
  MatchedPart part = MatchedPart::None;
  ArrivalRates rates = ArrivalRates::LeastJointRate;
};

double worst_gradient_error(const RobotModel& robot, Random& random, ContactLaw law,
                            const MovingHand& hand = {}) {
  const int joints = robot.n(), size = joints + 9;
  const JointVectord phi = joints_at_random(random, joints);
  const ImpactResistance resistance = random_resistance(random, joints);
  const ResponseWeights<double> weights = weights_at_random(random, joints);
  RigidContact<double> contact = contact_at_random(random, law);
  const Vector3d n = random.unit_vector();
  contact.matched = hand.part;
  contact.rates = hand.rates;
  contact.n = n;
  contact.apart << 0.01 * random.unit_vector(), 0.02 * random.unit_vector();
  const auto posture = evaluate_posture<double>(robot, resistance, phi);
  const auto response = respond_to_contact(posture, contact);
  const auto gradient = contact_gradient(robot, posture, contact, response, weights);

  JointVector<Dual> variables(joints);
  for (int k = 0; k < joints; ++k) variables[k] = Dual(phi[k], size, k);
  RigidContact<Dual> dual_contact;
  dual_contact.law = law;
  dual_contact.target = varied(contact.target, joints, size);
  const Matrix3<Dual> R = small_rotation(joints, size);
  dual_contact.matched = hand.part;
  dual_contact.rates = hand.rates;
  dual_contact.n = R * n.cast<Dual>();
  dual_contact.apart.head<3>() = R * Vector3d(contact.apart.head<3>()).cast<Dual>();
  dual_contact.apart.tail<3>() = R * Vector3d(contact.apart.tail<3>()).cast<Dual>();
  const auto dual_posture = evaluate_posture<Dual>(robot, resistance, variables);
  const Dual psi =
      weighted_parts(dual_posture, respond_to_contact(dual_posture, dual_contact), weights);
  CHECK(weighted_parts(posture, response, weights) ==
        Approx(psi.value()).epsilon(0).margin(1e-12 * size_of_parts(posture, response, weights)));
  Eigen::VectorXd found(size);
  found << gradient.phi, gradient.turn, gradient.velocity, gradient.omega;
  const double scale = 1 + psi.derivatives().cwiseAbs().maxCoeff();
  return (found - psi.derivatives()).cwiseAbs().maxCoeff() / scale;
}

}  // namespace

TEST_CASE("a sticking contact and a latch give the impulse of their contact law") {
  Random random(71);
  for (int trial = 0; trial < 60; ++trial) {
    const int n = 2 + random.index(9);
    const RobotModel robot = robot_at_random(random, n, trial % 2 == 0);
    const auto posture =
        evaluate_posture<double>(robot, random_resistance(random, n), joints_at_random(random, n));
    const Matrix6d W_h = extended_inverse_inertia(posture.factor, posture.jacobian);
    for (const ContactLaw law : kLaws) {
      RigidContact<double> contact = contact_at_random(random, law);
      const auto response = respond_to_contact(posture, contact);
      Contact stated;
      stated.law = law;
      const ContactTarget target = plain(contact.target);
      const Vector3d f = response.F.head<3>(), v = target.contact_velocity().head<3>();
      stated.n = (f.normalized() + v.normalized()).normalized();  // neither pulls nor separates
      const auto expected = contact_impulse(stated, W_h, Vector6d::Zero(), target);
      REQUIRE(expected.status == ContactStatus::Hit);
      CHECK((response.F - expected.Fbar).norm() < 1e-11 * expected.Fbar.norm());
      const Vector6d hand = W_h * response.F;
      const Vector6d apart =
          target.contact_velocity() - hand - target_inverse_inertia6(target) * response.F;
      const int components = law == ContactLaw::Latch ? 6 : 3;
      CHECK(apart.head(components).norm() < 1e-11 * target.contact_velocity().norm());
    }
  }
}

TEST_CASE(
    "the gradient of a sticking contact and of a latch agrees with automatic "
    "differentiation") {
  Random random(72);
  for (int trial = 0; trial < 40; ++trial) {
    const RobotModel robot = robot_at_random(random, 2 + random.index(9), trial % 2 == 0);
    for (const ContactLaw law : kLaws) {
      INFO("trial " << trial << ", " << (law == ContactLaw::Latch ? "latch" : "sticking"));
      CHECK(worst_gradient_error(robot, random, law) < 1e-11);
    }
  }
}

TEST_CASE("the gradient of a contact with a moving hand agrees with automatic differentiation") {
  const MatchedPart part =
      GENERATE(MatchedPart::Normal, MatchedPart::Linear, MatchedPart::Angular, MatchedPart::All);
  const ArrivalRates rates = GENERATE(ArrivalRates::LeastJointRate, ArrivalRates::LeastBaseRate);
  Random random(75);
  for (int trial = 0; trial < 6; ++trial) {
    const RobotModel robot = random_arm(random, 7 + random.index(3));
    for (const ContactLaw law : kLaws) {
      INFO("trial " << trial << ", part " << static_cast<int>(part) << ", rates "
                    << static_cast<int>(rates));
      CHECK(worst_gradient_error(robot, random, law, {part, rates}) < 1e-8);
    }
  }
}

TEST_CASE("the gradient of a latch holds for robots with coupled joints") {
  Random random(73);
  for (int trial = 0; trial < 20; ++trial) {
    const RobotModel robot =
        with_couplings(robot_at_random(random, 2 + random.index(9), trial % 2 == 0), random);
    for (const ContactLaw law : kLaws) CHECK(worst_gradient_error(robot, random, law) < 1e-10);
  }
}

TEST_CASE("after a latch base part, total and received momentum are those of robot and target") {
  Random random(74);
  for (int trial = 0; trial < 40; ++trial) {
    const int n = 2 + random.index(9);
    const RobotModel robot = robot_at_random(random, n, trial % 2 == 0);
    const JointVectord phi = joints_at_random(random, n);
    const ImpactResistance resistance = random_resistance(random, n);
    const auto posture = evaluate_posture<double>(robot, resistance, phi);
    RigidContact<double> contact = contact_at_random(random, ContactLaw::Latch);
    const auto response = respond_to_contact(posture, contact);

    TargetBody body;
    body.mass = 1 / contact.target.inverse_mass;
    body.inertia = contact.target.inertia;  // T parallel to B
    const Pose hand{posture.kinematics.r_bh, Eigen::Quaterniond(posture.kinematics.R_hand)};
    const Pose target{posture.kinematics.r_bh - contact.target.r, Eigen::Quaterniond::Identity()};
    const auto whole =
        evaluate_posture<double>(attach_target(robot, hand, body, target), resistance, phi);
    const Vector3d base = whole.tilde.Htilde_omega * response.omega();
    const Vector3d coupling = whole.tilde.Htilde_omegaphi * response.d.Delta_phidot;
    const double size = base.norm() + coupling.norm();
    CHECK((response.base - base).norm() < 1e-11 * size);
    CHECK((response.coupling() - coupling).norm() < 1e-11 * size);
    const Vector6d received = whole.inertia.H_b * response.d.Delta_Omega;
    const Vector6d found = posture.inertia.H_b * response.d.Delta_Omega + response.held_momentum;
    CHECK((found - received).norm() < 1e-11 * received.norm());
  }
}

}  // namespace stillbase
