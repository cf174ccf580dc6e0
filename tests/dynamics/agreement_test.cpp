// The fast dynamics against the plain ones: two implementations that share only the robot model.
#include <cmath>
#include <limits>

#include <catch2/catch.hpp>

#include <stillbase/dynamics/bias.hpp>
#include <stillbase/dynamics/momentum.hpp>
#include <stillbase/impact/jump.hpp>

#include "reference/random_state.hpp"
#include "support/dense.hpp"

using namespace stillbase;
using namespace stillbase::reference_test;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr double kTolerance = 1e-11;

// |a - b| relative to |b|, zero matrices by their absolute value.
double difference(const MatrixXd& a, const MatrixXd& b) {
  const double scale = b.norm();
  return (a - b).norm() / (scale > 0 ? scale : 1);
}

struct Worst {
  double value = 0;
  void add(const MatrixXd& a, const MatrixXd& b) {
    const double d = difference(a, b);
    value = std::isnan(d) ? std::numeric_limits<double>::infinity() : std::max(value, d);
  }
};

}  // namespace

TEST_CASE("dynamics and reference agree on 1000 random robots and states") {
  Worst H, coupling, c, J, pose, momentum, tilde, free_floating;
  for (int trial = 0; trial < 1000; ++trial) {
    Random random(41, static_cast<std::uint64_t>(trial));
    const int n = 1 + trial % 12;
    const RobotModel robot = random_robot(random, n, trial % 3 == 0);
    const reference::State state = random_state(random, n);
    const auto d = reference::compute(robot, state);

    const JointVectord phi = state.phi, phidot = state.phidot;
    const auto kinematics = compute_kinematics<double>(robot, phi);
    const auto inertia = compute_inertia(robot, kinematics);
    const auto jacobian = compute_hand_jacobian(robot, kinematics);
    const auto tilde_inertia = compute_tilde_inertia(inertia);
    const auto bias = compute_bias<double>(robot, kinematics, inertia, state.Omega, phidot);
    const auto momenta = compute_momentum<double>(inertia, tilde_inertia, state.Omega, phidot);

    H.add(inertia.H_b, d.H.topLeftCorner(6, 6));
    H.add(inertia.H_phi, d.H.bottomRightCorner(n, n));
    coupling.add(inertia.H_bphi, d.H.topRightCorner(6, n));
    VectorXd bias_stacked(6 + n);
    bias_stacked << bias.c_b, bias.c_phi;
    c.add(bias_stacked, d.c);
    J.add(jacobian.R_bh, d.J.leftCols(6));
    J.add(jacobian.J_phi, d.J.rightCols(n));
    pose.add(kinematics.r_bh, d.hand_position);
    pose.add(kinematics.R_hand, d.hand_rotation);
    pose.add(inertia.r_bg, d.centroid);
    momentum.add(momenta.P, d.P);
    momentum.add(momenta.L_g, d.L_g);
    tilde.add(tilde_inertia.Htilde_omega, d.Htilde_omega);
    tilde.add(tilde_inertia.Htilde_omegaphi, d.Htilde_omegaphi);
    const VectorXd still =
        test::solve(d.H.topLeftCorner(6, 6), -d.H.topRightCorner(6, n) * state.phidot);
    free_floating.add(free_floating_base_velocity(inertia, phidot), still);
  }
  CHECK(H.value <= kTolerance);
  CHECK(coupling.value <= kTolerance);
  CHECK(c.value <= kTolerance);
  CHECK(J.value <= kTolerance);
  CHECK(pose.value <= kTolerance);
  CHECK(momentum.value <= kTolerance);
  CHECK(tilde.value <= kTolerance);
  CHECK(free_floating.value <= kTolerance);
}

TEST_CASE("jump by dynamics and by reference agree on 1000 random robots and impulses") {
  Worst jump, momentum, hand;
  for (int trial = 0; trial < 1000; ++trial) {
    Random random(42, static_cast<std::uint64_t>(trial));
    const int n = 1 + trial % 12;
    const RobotModel robot = random_robot(random, n, trial % 3 == 0);
    const reference::State state = random_state(random, n);
    Vector6d Fbar;
    Fbar << random_vector(random, 10), random_vector(random, 2);
    JointVectord added = JointVectord::Zero(n);
    std::vector<bool> locked(static_cast<std::size_t>(n), false);
    for (int k = 0; k < n; ++k) {
      if (trial % 4 == 1) added(k) = random.uniform(0, 2);
      if (trial % 4 == 2) locked[static_cast<std::size_t>(k)] = random.uniform() < 0.5;
    }

    const auto d = reference::compute(robot, {state.phi, {}, {}});
    const auto plain = reference::impact(d, added, locked, Fbar);

    const JointVectord phi = state.phi;
    const auto kinematics = compute_kinematics<double>(robot, phi);
    const auto inertia = compute_inertia(robot, kinematics);
    const auto tilde = compute_tilde_inertia(inertia);
    const auto jacobian = compute_hand_jacobian(robot, kinematics);
    const auto factor = factorize_inertia(inertia, added, locked);
    const auto fast = compute_jump<double>(factor, jacobian, Fbar);

    VectorXd x(6 + n), y(6 + n);
    x << fast.Delta_Omega, fast.Delta_phidot;
    y << plain.Delta_Omega, plain.Delta_phidot;
    jump.add(x, y);
    momentum.add(momentum_change<double>(inertia, jacobian, Fbar), plain.total);
    const Vector3d f = Fbar.head<3>();
    const Matrix6d W = extended_inverse_inertia(factor, jacobian);
    const Vector3d pushed = W.topLeftCorner<3, 3>() * f;
    hand.add(MatrixXd::Constant(1, 1, f.dot(pushed) / f.squaredNorm()),
             MatrixXd::Constant(1, 1, plain.hand_inverse_mass));
    momentum.add(
        tilde.Htilde_omega * fast.Delta_Omega.tail<3>() + tilde.Htilde_omegaphi * fast.Delta_phidot,
        plain.total);
  }
  CHECK(jump.value <= kTolerance);
  CHECK(momentum.value <= kTolerance);
  CHECK(hand.value <= kTolerance);
}
