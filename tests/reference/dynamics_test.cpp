#include <catch2/catch.hpp>

#include <stillbase/core/rotation.hpp>

#include "reference/random_state.hpp"
#include "support/dense.hpp"

using namespace stillbase;
using namespace stillbase::reference_test;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

VectorXd stacked(const reference::State& state) {
  VectorXd x(6 + state.phi.size());
  x << state.Omega, state.phidot;
  return x;
}

MatrixXd inertia_at(const RobotModel& robot, const VectorXd& phi) {
  return reference::compute(robot, {phi, {}, {}}).H;
}

// d/ds of H(phi + s direction) at s = 0 by a fourth-order central difference.
MatrixXd inertia_derivative(const RobotModel& robot, const VectorXd& phi,
                            const VectorXd& direction) {
  const double h = 1e-3;
  auto H = [&](double s) { return inertia_at(robot, phi + s * direction); };
  return (8 * (H(h) - H(-h)) - (H(2 * h) - H(-2 * h))) / (12 * h);
}

// Everything that moves, for an integration of the free motion.
struct Motion {
  Eigen::Quaterniond q = Eigen::Quaterniond::Identity();  // R_NB
  reference::State state;
};

struct Rate {
  Vector3d omega;
  VectorXd phidot, acceleration;
};

Rate rate(const RobotModel& robot, const Motion& m) {
  const auto d = reference::compute(robot, m.state);
  return {m.state.Omega.tail<3>(), m.state.phidot, test::solve(d.H, -d.c)};
}

// m moved by h along the rate found at `stage`. The Euler parameters are not normalised in between,
// so that the whole step is of the integrator's order.
Motion moved(const Motion& m, const Motion& stage, const Rate& r, double h) {
  Motion next = m;
  const Eigen::Quaterniond w(0, r.omega.x(), r.omega.y(), r.omega.z());
  next.q.coeffs() += 0.5 * h * (stage.q * w).coeffs();
  next.state.phi += h * r.phidot;
  next.state.Omega += h * r.acceleration.head<6>();
  next.state.phidot += h * r.acceleration.tail(m.state.phi.size());
  return next;
}

Motion runge_kutta_step(const RobotModel& robot, const Motion& m, double h) {
  const Rate k1 = rate(robot, m);
  const Motion m2 = moved(m, m, k1, h / 2);
  const Rate k2 = rate(robot, m2);
  const Motion m3 = moved(m, m2, k2, h / 2);
  const Rate k3 = rate(robot, m3);
  const Motion m4 = moved(m, m3, k3, h);
  const Rate k4 = rate(robot, m4);
  Motion next = moved(m, m, k1, h / 6);
  next = moved(next, m2, k2, h / 3);
  next = moved(next, m3, k3, h / 3);
  next = moved(next, m4, k4, h / 6);
  next.q.normalize();
  return next;
}

}  // namespace

TEST_CASE("the inertia matrix is symmetric, positive definite and gives the bodies' energy") {
  Random random(11);
  for (int trial = 0; trial < 40; ++trial) {
    const int n = 1 + random.index(9);
    const RobotModel robot = random_robot(random, n, trial % 2 == 0);
    const reference::State state = random_state(random, n);
    const auto d = reference::compute(robot, state);
    CHECK((d.H - d.H.transpose()).norm() <= 1e-14 * d.H.norm());
    CHECK(test::eigenvalues(d.H).minCoeff() > 0);
    double mass = robot.base.mass;
    for (const Body& body : robot.bodies) mass += body.mass;
    CHECK(d.mass == Approx(mass).epsilon(1e-14));

    // Energy of the bodies by differences of their world positions along the motion.
    double energy = 0;
    const double h = 1e-3;
    auto frames_at = [&](double s) {
      std::vector<Pose> poses;
      const Pose base{s * Vector3d(state.Omega.head<3>()), rotation_exp(s * state.Omega.tail<3>())};
      poses.push_back(base);
      for (int k = 0; k < n; ++k) {
        const Joint& joint = robot.joints[static_cast<std::size_t>(k)];
        const double phi = state.phi(k) + s * state.phidot(k);
        const Pose mount{joint.p, Eigen::Quaterniond(joint.R.matrix())};
        const Pose move = joint.is_prismatic() ? Pose{{0, 0, phi}, Eigen::Quaterniond::Identity()}
                                               : Pose{{0, 0, 0}, rotation_exp({0, 0, phi})};
        poses.push_back(poses[static_cast<std::size_t>(joint.parent + 1)] * mount * move);
      }
      return poses;
    };
    const auto a2 = frames_at(-2 * h), a1 = frames_at(-h), b1 = frames_at(h), b2 = frames_at(2 * h);
    const auto now = frames_at(0);
    for (int k = kBase; k < n; ++k) {
      const std::size_t i = static_cast<std::size_t>(k + 1);
      const Body& body = k == kBase ? robot.base : robot.bodies[i - 1];
      const Vector3d v = (8 * (b1[i] * body.centroid - a1[i] * body.centroid) -
                          (b2[i] * body.centroid - a2[i] * body.centroid)) /
                         (12 * h);
      auto turn = [&](const Pose& p) {
        return rotation_log(now[i].orientation.conjugate() * p.orientation);
      };
      const Vector3d w = (8 * (turn(b1[i]) - turn(a1[i])) - (turn(b2[i]) - turn(a2[i]))) / (12 * h);
      energy += 0.5 * body.mass * v.squaredNorm() + 0.5 * w.dot(body.inertia * w);
    }
    const VectorXd x = stacked(state);
    CHECK(0.5 * x.dot(d.H * x) == Approx(energy).epsilon(1e-7));
  }
}

TEST_CASE("the momenta are the base rows of the inertia matrix, shifted to the system centroid") {
  Random random(12);
  for (int trial = 0; trial < 40; ++trial) {
    const int n = 1 + random.index(9);
    const RobotModel robot = random_robot(random, n, trial % 2 == 0);
    const reference::State state = random_state(random, n);
    const auto d = reference::compute(robot, state);
    const VectorXd momentum = d.H.topRows(6) * stacked(state);
    const Vector3d L_g = momentum.tail<3>() - d.centroid.cross(Vector3d(momentum.head<3>()));
    CHECK((momentum.head<3>() - d.P).norm() <= 1e-12 * (1 + d.P.norm()));
    CHECK((L_g - d.L_g).norm() <= 1e-12 * (1 + L_g.norm()));
    const Vector3d parts =
        d.Htilde_omega * state.Omega.tail<3>() + d.Htilde_omegaphi * state.phidot;
    CHECK((parts - d.L_g).norm() <= 1e-12 * (1 + L_g.norm()));
  }
}

TEST_CASE("the hand Jacobian is the derivative of the hand pose") {
  Random random(13);
  for (int trial = 0; trial < 20; ++trial) {
    const int n = 1 + random.index(9);
    const RobotModel robot = random_robot(random, n, trial % 2 == 0);
    const reference::State state = random_state(random, n);
    const auto d = reference::compute(robot, state);
    const double h = 1e-3;
    auto at = [&](double s) {
      return reference::compute(robot, {state.phi + s * state.phidot, {}, {}});
    };
    const auto a2 = at(-2 * h), a1 = at(-h), b1 = at(h), b2 = at(2 * h);
    auto turn = [&](const reference::Dynamics& x) {
      return rotation_log(
          Eigen::Quaterniond(Matrix3d(x.hand_rotation * d.hand_rotation.transpose())));
    };
    const Vector3d v =
        (8 * (b1.hand_position - a1.hand_position) - (b2.hand_position - a2.hand_position)) /
        (12 * h);
    const Vector3d w = (8 * (turn(b1) - turn(a1)) - (turn(b2) - turn(a2))) / (12 * h);
    const VectorXd V = d.J.rightCols(n) * state.phidot;
    CHECK((V.head<3>() - v).norm() <= 1e-8 * (1 + v.norm()));
    CHECK((V.tail<3>() - w).norm() <= 1e-8 * (1 + w.norm()));
    CHECK((d.J.block<3, 3>(0, 3) + skew(Vector3d(d.hand_position))).norm() <= 1e-15);
  }
}

TEST_CASE("body frames are the product of mounts and joint motions") {
  Random random(16);
  for (int trial = 0; trial < 20; ++trial) {
    const int n = 1 + random.index(9);
    const RobotModel robot = random_robot(random, n, trial % 2 == 0);
    const reference::State state = random_state(random, n);
    const std::vector<Pose> poses = reference::body_poses(robot, state.phi);
    REQUIRE(static_cast<int>(poses.size()) == n);
    for (int k = 0; k < n; ++k) {
      const auto i = static_cast<std::size_t>(k);
      const Joint& joint = robot.joints[i];
      const Pose parent =
          joint.parent == kBase ? Pose{} : poses[static_cast<std::size_t>(joint.parent)];
      const Pose mount{joint.p, Eigen::Quaterniond(joint.R.matrix())};
      const Vector3d axis(0, 0, state.phi(k));
      const Pose move = joint.is_prismatic() ? Pose{axis, Eigen::Quaterniond::Identity()}
                                             : Pose{{0, 0, 0}, rotation_exp(axis)};
      const Pose expected = parent * mount * move;
      CHECK((poses[i].position - expected.position).norm() <= 1e-13);
      CHECK(poses[i].orientation.angularDistance(expected.orientation) <= 1e-13);
    }
    const auto d = reference::compute(robot, {state.phi, {}, {}});
    const Pose& hand_body = poses[static_cast<std::size_t>(robot.hand_body)];
    CHECK((d.hand_position - hand_body * robot.p_hand).norm() <= 1e-13);
  }
}

TEST_CASE("the bias is that of Lagrange in quasi-velocities") {
  // T = 1/2 x' H(phi) x. With p = H x: c_v = (H_dot x)_v + omega x p_v,
  // c_omega = (H_dot x)_omega + omega x p_omega + v x p_v, c_phi = (H_dot x)_phi - dT/dphi.
  Random random(14);
  for (int trial = 0; trial < 30; ++trial) {
    const int n = 1 + random.index(8);
    const RobotModel robot = random_robot(random, n, trial % 2 == 0);
    const reference::State state = random_state(random, n);
    const auto d = reference::compute(robot, state);
    const VectorXd x = stacked(state);
    const VectorXd p = d.H * x;
    const Vector3d v = state.Omega.head<3>(), omega = state.Omega.tail<3>();
    const Vector3d p_v = p.head<3>(), p_omega = p.segment<3>(3);
    const MatrixXd H_dot = inertia_derivative(robot, state.phi, state.phidot);
    VectorXd c = H_dot * x;
    c.head<3>() += omega.cross(p_v);
    c.segment<3>(3) += omega.cross(p_omega) + v.cross(p_v);
    for (int k = 0; k < n; ++k)
      c(6 + k) -= 0.5 * x.dot(inertia_derivative(robot, state.phi, VectorXd::Unit(n, k)) * x);
    CHECK((d.c - c).norm() <= 1e-8 * (1 + c.norm()));
    // Passivity: the bias does no work beyond the change of inertia.
    CHECK(x.dot(d.c) ==
          Approx(0.5 * x.dot(H_dot * x)).epsilon(0).margin(1e-8 * (1 + c.norm()) * x.norm()));
  }
}

TEST_CASE("free motion keeps both momenta in the inertial frame and the energy") {
  Random random(15);
  for (int trial = 0; trial < 4; ++trial) {
    const int n = 2 + random.index(4);
    const RobotModel robot = random_robot(random, n, trial % 2 == 0);
    Motion motion;
    motion.state = random_state(random, n);
    struct Constants {
      Vector3d P, L;
      double energy;
    };
    auto constants = [&](const Motion& m) {
      const auto d = reference::compute(robot, m.state);
      const VectorXd x = stacked(m.state);
      return Constants{m.q * d.P, m.q * d.L_g, 0.5 * x.dot(d.H * x)};
    };
    const Constants before = constants(motion);
    for (int i = 0; i < 400; ++i) motion = runge_kutta_step(robot, motion, 5e-4);
    const Constants after = constants(motion);
    CHECK((after.P - before.P).norm() <= 1e-9 * (1 + before.P.norm()));
    CHECK((after.L - before.L).norm() <= 1e-9 * (1 + before.L.norm()));
    CHECK(after.energy == Approx(before.energy).epsilon(1e-9));
  }
}
