// How the joints resist: limits that are known, and a push that takes time.
#include <cmath>

#include <catch2/catch.hpp>

#include <stillbase/core/random.hpp>
#include <stillbase/impact/compare_resistances.hpp>
#include <stillbase/impact/contact_impulse.hpp>
#include <stillbase/impact/gradient.hpp>
#include <stillbase/reference/reference.hpp>
#include <stillbase/simulation/plant.hpp>

#include "support/dense.hpp"
#include "support/random_robot.hpp"

namespace stillbase {
namespace {

struct Case {
  RobotModel robot;
  JointVectord phi;
  Vector6d Fbar;
};

Case random_case(std::uint64_t seed, std::uint64_t stream) {
  Random random(seed, stream);
  Case c;
  const int n = 1 + random.index(7);
  c.robot = random_robot(random, n, random.uniform() < 0.5);
  c.phi.resize(n);
  for (int k = 0; k < n; ++k) c.phi[k] = random.uniform(-2, 2);
  c.Fbar << 10 * random.unit_vector(), 2 * random.unit_vector();
  return c;
}

/// [Delta Omega; Delta phidot].
Eigen::VectorXd jump(const Case& c, const JointResistance& resistance) {
  const auto posture =
      evaluate_posture<double>(c.robot, prepare_resistance(resistance, c.robot.n()), c.phi);
  const auto d = compute_jump(posture.factor, posture.jacobian, c.Fbar);
  Eigen::VectorXd x(6 + c.robot.n());
  x << d.Delta_Omega, d.Delta_phidot;
  return x;
}

JointResistance rotors(int n, double inertia) {
  JointResistance resistance;
  resistance.model = ResistanceModel::RotorInertia;
  resistance.rotor_inertia = JointVectord::Constant(n, inertia);
  return resistance;
}

JointResistance locked(int n) {
  JointResistance resistance;
  resistance.model = ResistanceModel::Locked;
  resistance.locked.assign(static_cast<std::size_t>(n), true);
  return resistance;
}

JointResistance servo(int n, double stiffness, double damping, double duration) {
  JointResistance resistance;
  resistance.model = ResistanceModel::Servo;
  resistance.stiffness = JointVectord::LinSpaced(n, stiffness, 1.5 * stiffness);
  resistance.damping = JointVectord::LinSpaced(n, damping, 1.5 * damping);
  resistance.contact_duration = duration;
  return resistance;
}

/// A classical Runge-Kutta step for x' = f(x).
template <class F>
Eigen::VectorXd rk4(const F& f, Eigen::VectorXd x, double duration, int steps) {
  const double h = duration / steps;
  for (int i = 0; i < steps; ++i) {
    const Eigen::VectorXd a = f(x), b = f(x + h / 2 * a), c = f(x + h / 2 * b), d = f(x + h * c);
    x += h / 6 * (a + 2 * b + 2 * c + d);
  }
  return x;
}

/// Velocity after a constant force Fbar / h over h on the robot at rest with springs and dampers at
/// the joints, posture frozen: H x' = J' Fbar / h - D x - K y, y' = x on the joints.
Eigen::VectorXd frozen_push(const Case& c, const JointResistance& r) {
  const auto d = reference::compute(c.robot, {c.phi, {}, {}});
  const Eigen::MatrixXd H_inverse =
      test::solve(d.H, Eigen::MatrixXd::Identity(d.H.rows(), d.H.cols()));
  const Eigen::VectorXd push = d.J.transpose() * c.Fbar / r.contact_duration;
  const int n = c.robot.n();
  const auto rate = [&](const Eigen::VectorXd& x) -> Eigen::VectorXd {
    Eigen::VectorXd load = push;
    load.tail(n) -= Eigen::VectorXd(r.damping).cwiseProduct(x.segment(6, n)) +
                    Eigen::VectorXd(r.stiffness).cwiseProduct(x.tail(n));
    Eigen::VectorXd out(6 + 2 * n);
    out << H_inverse * load, x.segment(6, n);
    return out;
  };
  return rk4(rate, Eigen::VectorXd::Zero(6 + 2 * n), r.contact_duration, 100).head(6 + n);
}

/// The same with the whole nonlinear plant; the force keeps its direction in B.
Eigen::VectorXd plant_push(const Case& c, const JointResistance& r) {
  const int n = c.robot.n();
  const JointVectord no_rotor = JointVectord::Zero(n);
  const auto rate = [&](const Eigen::VectorXd& x) -> Eigen::VectorXd {
    PlantState state;
    state.Omega = x.head<6>();
    state.phidot = x.segment(6, n);
    state.phi = x.tail(n);
    const PlantTerms terms(c.robot, no_rotor, state);
    const auto jacobian = compute_hand_jacobian(c.robot, terms.kinematics);
    const Vector6d F = c.Fbar / r.contact_duration;
    JointVectord tau = jacobian.J_phi.transpose() * F;
    tau -= r.damping.cwiseProduct(state.phidot);
    tau -= r.stiffness.cwiseProduct(state.phi - c.phi);
    const auto a = compute_acceleration(terms, jacobian.R_bh.transpose() * F, tau);
    Eigen::VectorXd out(6 + 2 * n);
    out << a.dot_Omega, a.phiddot, state.phidot;
    return out;
  };
  Eigen::VectorXd start = Eigen::VectorXd::Zero(6 + 2 * n);
  start.tail(n) = c.phi;
  return rk4(rate, start, r.contact_duration, 50).head(6 + n);
}

/// Order at which error(h) goes to zero, between h and h / 2.
template <class F>
double order(const F& error, double h) {
  return std::log2(error(h) / error(h / 2));
}

}  // namespace

TEST_CASE("with all joints locked the robot is one rigid body") {
  for (int trial = 0; trial < 50; ++trial) {
    const Case c = random_case(401, static_cast<std::uint64_t>(trial));
    const auto d = reference::compute(c.robot, {c.phi, {}, {}});
    const Vector3d f = c.Fbar.head<3>(), t = c.Fbar.tail<3>();
    const Vector3d omega = d.Htilde_omega.inverse() * ((d.hand_position - d.centroid).cross(f) + t);
    Eigen::VectorXd expected = Eigen::VectorXd::Zero(6 + c.robot.n());
    expected.head<3>() = f / d.mass - omega.cross(d.centroid);
    expected.segment<3>(3) = omega;
    CHECK((jump(c, locked(c.robot.n())) - expected).norm() <= 1e-12 * expected.norm());
  }
}

TEST_CASE("growing rotor inertia leads to the locked joint, with an error of 1 / inertia") {
  for (int trial = 0; trial < 20; ++trial) {
    const Case c = random_case(402, static_cast<std::uint64_t>(trial));
    const int n = c.robot.n();
    const Eigen::VectorXd limit = jump(c, locked(n));
    const auto error = [&](double inertia) { return (jump(c, rotors(n, inertia)) - limit).norm(); };
    CHECK(std::abs(error(1e6) / error(1e7) - 10) < 0.1);
    CHECK(error(1e9) <= 1e-5 * limit.norm());
  }
}

TEST_CASE("one locked joint is the robot whose two bodies are one") {
  Case c = random_case(403, 1);
  Random random(403);
  c.robot = random_robot(random, 4, false);
  c.phi = JointVectord::LinSpaced(4, -0.5, 0.9);
  JointResistance resistance;
  resistance.model = ResistanceModel::Locked;
  resistance.locked = {false, true, false, false};
  const Eigen::VectorXd x = jump(c, resistance);
  CHECK(x[7] == 0);
  // Other route: the multiplier of the constraint phidot_2 = 0 in (6).
  const auto d = reference::compute(c.robot, {c.phi, {}, {}});
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(11, 11);
  A.topLeftCorner(10, 10) = d.H;
  A(10, 7) = A(7, 10) = 1;
  Eigen::VectorXd b = Eigen::VectorXd::Zero(11);
  b.head(10) = d.J.transpose() * c.Fbar;
  const Eigen::VectorXd y = test::solve(A, b);
  CHECK((x - y.head(10)).norm() <= 1e-11 * x.norm());
}

TEST_CASE("the servo is a push of duration h to leading order: damping to h, stiffness to h^2") {
  for (int trial = 0; trial < 5; ++trial) {
    const Case c = random_case(404, static_cast<std::uint64_t>(trial));
    const int n = c.robot.n();
    const auto error = [&](double stiffness, double damping) {
      return [&c, n, stiffness, damping](double h) {
        const JointResistance r = servo(n, stiffness, damping, h);
        return (jump(c, r) - frozen_push(c, r)).norm();
      };
    };
    // What is left out begins with D H^-1 D h^2, or with K H^-1 K h^4.
    CHECK(std::abs(order(error(0, 10), 1e-4) - 2) < 0.1);
    CHECK(std::abs(order(error(100, 10), 1e-4) - 2) < 0.1);
    CHECK(std::abs(order(error(100, 0), 1e-3) - 4) < 0.2);
    // And the effect itself is there: order 1 and 2.
    const Eigen::VectorXd free = jump(c, {});
    const auto effect = [&](double stiffness, double damping) {
      return [&, stiffness, damping](double h) {
        return (frozen_push(c, servo(n, stiffness, damping, h)) - free).norm();
      };
    };
    CHECK(std::abs(order(effect(0, 10), 1e-4) - 1) < 0.1);
    CHECK(std::abs(order(effect(100, 0), 1e-3) - 2) < 0.1);
  }
}

TEST_CASE("the effect of the servo in the moving plant is the jump's, to leading order") {
  for (int trial = 0; trial < 3; ++trial) {
    const Case c = random_case(405, static_cast<std::uint64_t>(trial));
    const int n = c.robot.n();
    const Eigen::VectorXd free_jump = jump(c, {});
    const auto error = [&](double h) {
      const JointResistance r = servo(n, 50, 20, h);
      const Eigen::VectorXd effect = plant_push(c, r) - plant_push(c, servo(n, 0, 0, h));
      return (effect - (jump(c, r) - free_jump)).norm();
    };
    CHECK(std::abs(order(error, 1e-3) - 2) < 0.2);
    // Without springs and dampers the push is the jump itself up to the motion within it.
    const auto motion = [&](double h) {
      return (plant_push(c, servo(n, 0, 0, h)) - free_jump).norm();
    };
    CHECK(std::abs(order(motion, 1e-3) - 1) < 0.2);
  }
}

TEST_CASE("the comparison has all four models, with stated values where there are some") {
  const Case c = random_case(406, 0);
  const int n = c.robot.n();
  JointResistance stated = rotors(n, 3);
  const auto list = resistances_to_compare(c.robot, c.phi, stated);
  REQUIRE(list.size() == 4);
  CHECK(list[0].resistance.model == ResistanceModel::Free);
  CHECK(list[1].resistance.rotor_inertia == stated.rotor_inertia);
  CHECK_FALSE(list[1].is_illustrative);
  CHECK(list[2].resistance.model == ResistanceModel::Servo);
  CHECK(list[2].is_illustrative);
  CHECK(list[3].resistance.locked == std::vector<bool>(static_cast<std::size_t>(n), true));
  CHECK_FALSE(list[3].is_illustrative);

  ContactTarget target;
  target.mass = 50;
  target.velocity = Vector3d::UnitX();
  Contact contact;
  contact.restitution = 0.5;
  std::vector<double> impulses;
  for (const ComparedResistance& entry : list) {
    const ContactOutcome outcome = apply_contact(
        c.robot, c.phi, Vector6d::Zero(), JointVectord::Zero(n), entry.resistance, contact, target);
    impulses.push_back(outcome.impulse.Fbar.norm());
  }
  for (const double impulse : impulses) {
    // Resistance makes the hand heavier: never a smaller impulse than with free joints, never a
    // larger one than with all joints locked.
    CHECK(impulse >= impulses[0]);
    CHECK(impulse <= impulses[3]);
  }
}

}  // namespace stillbase
