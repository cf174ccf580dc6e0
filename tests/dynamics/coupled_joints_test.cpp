// Joints that follow others: the congruence of the open tree's dynamics, in both implementations.
#include <catch2/catch.hpp>

#include <stillbase/core/random.hpp>
#include <stillbase/dynamics/bias.hpp>
#include <stillbase/dynamics/inertia.hpp>
#include <stillbase/dynamics/jacobian.hpp>
#include <stillbase/impact/jump.hpp>
#include <stillbase/reference/reference.hpp>

#include "support/coupled_robot.hpp"
#include "support/random_robot.hpp"

using namespace stillbase;

namespace {

bool agree(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return (a - b).cwiseAbs().maxCoeff() <= 1e-11 * (1 + b.cwiseAbs().maxCoeff());
}

Eigen::MatrixXd dense(const JointMatrixd& m) {
  Eigen::MatrixXd out(m.rows(), m.cols());
  for (Eigen::Index i = 0; i < m.rows(); ++i) {
    for (Eigen::Index j = 0; j < m.cols(); ++j) out(i, j) = m(i, j);
  }
  return out;
}

}  // namespace

TEST_CASE("coupled joints: every matrix is that of the open tree after the congruence") {
  Random random(11);
  for (int trial = 0; trial < 80; ++trial) {
    const RobotModel open = random_robot(random, 2 + random.index(10), trial % 2 == 0);
    const RobotModel robot = with_couplings(open, random);
    JointVectord phi(robot.n()), rates(robot.n());
    for (int k = 0; k < robot.n(); ++k) {
      phi[k] = random.uniform(-1, 1);
      rates[k] = random.uniform(-1, 1);
    }
    Vector6d Omega;
    Omega << random.unit_vector(), random.unit_vector();
    const Eigen::MatrixXd G = coupling_matrix(robot);
    const JointVectord all = body_positions(robot, phi), all_rates = G * rates;

    const auto kin = compute_kinematics<double>(robot, phi);
    const auto open_kin = compute_kinematics<double>(open, all);
    CHECK(kin.r_bh == open_kin.r_bh);
    const auto inertia = compute_inertia<double>(robot, kin);
    const auto open_inertia = compute_inertia<double>(open, open_kin);
    CHECK(agree(inertia.H_b, open_inertia.H_b));
    CHECK(agree(inertia.H_bphi, open_inertia.H_bphi * G));
    CHECK(agree(dense(inertia.H_phi), G.transpose() * dense(open_inertia.H_phi) * G));
    const auto jacobian = compute_hand_jacobian<double>(robot, kin);
    CHECK(agree(jacobian.J_phi, compute_hand_jacobian<double>(open, open_kin).J_phi * G));
    const auto bias = compute_bias<double>(robot, kin, inertia, Omega, rates);
    const auto open_bias = compute_bias<double>(open, open_kin, open_inertia, Omega, all_rates);
    CHECK(agree(bias.c_b, open_bias.c_b));
    CHECK(agree(bias.c_phi, G.transpose() * open_bias.c_phi));

    // The other implementation, written apart.
    const auto reference = reference::compute(robot, {phi, rates, Omega});
    const int n = robot.n();
    CHECK(agree(reference.H.bottomRightCorner(n, n), dense(inertia.H_phi)));
    CHECK(agree(reference.H.topRightCorner(6, n), inertia.H_bphi));
    CHECK(agree(reference.c.head(6), bias.c_b));
    CHECK(agree(reference.c.tail(n), bias.c_phi));
    CHECK(agree(reference.J.rightCols(n), jacobian.J_phi));
    CHECK(agree(reference.hand_position, kin.r_bh));

    Vector6d F;
    F << random.unit_vector(), 0.3 * random.unit_vector();
    const auto jump = compute_jump<double>(robot, phi, JointVectord::Zero(n), {}, F);
    const auto expected = reference::impact(reference, Eigen::VectorXd::Zero(n), {}, F);
    CHECK(agree(jump.Delta_Omega, expected.Delta_Omega));
    CHECK(agree(jump.Delta_phidot, expected.Delta_phidot));
  }
}
