#include <catch2/catch.hpp>

#include <stillbase/core/random.hpp>
#include <stillbase/dynamics/momentum.hpp>
#include <stillbase/dynamics/reaction_null_space.hpp>
#include <stillbase/impact/gradient.hpp>

#include "support/dense.hpp"
#include "support/random_robot.hpp"

namespace stillbase {
namespace {

struct Posture {
  RobotModel robot;
  PostureImpact<double> at;
  Vector6d Fbar;
};

Posture random_posture(Random& random, int n) {
  Posture out;
  out.robot = random_robot(random, n, random.index(2) == 0);
  JointVectord phi(n);
  for (int k = 0; k < n; ++k) phi[k] = random.uniform(-2, 2);
  out.at = evaluate_posture<double>(out.robot, prepare_resistance({}, n), phi);
  out.Fbar << 10 * random.unit_vector(), random.unit_vector();
  return out;
}

}  // namespace

TEST_CASE("the jump solves (6), and (12), (13), (14) give the same") {
  Random random(51);
  for (int trial = 0; trial < 30; ++trial) {
    const int n = 2 + random.index(8);
    const Posture p = random_posture(random, n);
    const auto jump = compute_jump(p.at.factor, p.at.jacobian, p.Fbar);
    const InertiaMatrices<double>& H = p.at.inertia;
    // (6), both block rows.
    const Vector6d base_row = H.H_b * jump.Delta_Omega + H.H_bphi * jump.Delta_phidot -
                              p.at.jacobian.R_bh.transpose() * p.Fbar;
    const Eigen::VectorXd joint_row = H.H_bphi.transpose() * jump.Delta_Omega +
                                      H.H_phi * jump.Delta_phidot -
                                      p.at.jacobian.J_phi.transpose() * p.Fbar;
    CHECK(base_row.norm() < 1e-10);
    CHECK(joint_row.norm() < 1e-10);
    // (12)
    const HatInertia<double> hat = compute_hat_inertia(H, p.at.jacobian);
    const Eigen::VectorXd by_hat = test::solve(hat.Hhat_phi, hat.Jhat_phi.transpose() * p.Fbar);
    CHECK((by_hat - jump.Delta_phidot).norm() < 1e-9 * (1 + by_hat.norm()));
    // (13)
    const Vector6d by_13 =
        test::solve(H.H_b, p.at.jacobian.R_bh.transpose() * p.Fbar - H.H_bphi * by_hat);
    CHECK((by_13 - jump.Delta_Omega).norm() < 1e-9 * (1 + by_13.norm()));
    // (14), (15)
    const Vector3d by_B = base_reaction_matrix(p.at.factor, p.at.jacobian) * p.Fbar;
    CHECK((by_B - jump.Delta_Omega.tail<3>()).norm() < 1e-10 * (1 + by_B.norm()));
  }
}

TEST_CASE("the momentum gained is that of (16), and splits into base and coupling part") {
  Random random(52);
  for (int trial = 0; trial < 30; ++trial) {
    const Posture p = random_posture(random, 2 + random.index(8));
    const auto jump = compute_jump(p.at.factor, p.at.jacobian, p.Fbar);
    const Momentum<double> gained =
        compute_momentum(p.at.inertia, p.at.tilde, jump.Delta_Omega, jump.Delta_phidot);
    const Vector3d total = momentum_change(p.at.inertia, p.at.jacobian, p.Fbar);
    CHECK((gained.L_g - total).norm() < 1e-10);
    CHECK((gained.P - p.Fbar.head<3>()).norm() < 1e-10);
    const auto response = respond<double>(p.at, p.Fbar);
    CHECK((response.base - gained.base).norm() < 1e-10);
    CHECK((response.coupling() - gained.coupling).norm() < 1e-10);
  }
}

TEST_CASE("the null-space part of the joint reaction carries no angular momentum (10)") {
  Random random(53);
  for (int trial = 0; trial < 30; ++trial) {
    const int n = 4 + random.index(5);
    const Posture p = random_posture(random, n);
    const auto jump = compute_jump(p.at.factor, p.at.jacobian, p.Fbar);
    const ReactionNullSpace space = angular_reaction_null_space(p.at.tilde);
    const JointVelocityParts parts = decompose_joint_velocity(space, jump.Delta_phidot);
    const double size = 1 + p.at.tilde.Htilde_omegaphi.norm() * jump.Delta_phidot.norm();
    CHECK((p.at.tilde.Htilde_omegaphi * parts.rns).norm() < 1e-11 * size);
    CHECK(std::abs(parts.rns.dot(parts.orthogonal)) <
          1e-11 * (1 + jump.Delta_phidot.squaredNorm()));
    CHECK((parts.rns + parts.orthogonal - jump.Delta_phidot).norm() < 1e-12 * (1 + size));
    CHECK((space.P_RNS * space.P_RNS - space.P_RNS).norm() < 1e-12);
    CHECK(space.rank == 3);
  }
}

TEST_CASE("joint rates of the full reaction null space leave the whole base at rest (7)") {
  Random random(54);
  for (int trial = 0; trial < 10; ++trial) {
    const int n = 7 + random.index(3);
    const Posture p = random_posture(random, n);
    const ReactionNullSpace space = full_reaction_null_space(p.at.inertia);
    JointVectord xi(n);
    for (int k = 0; k < n; ++k) xi[k] = random.uniform(-1, 1);
    const JointVectord phidot = space.P_RNS * xi;
    CHECK(space.rank <= 6);
    CHECK(phidot.norm() > 1e-3);
    CHECK(free_floating_base_velocity(p.at.inertia, phidot).norm() < 1e-9);
  }
}

TEST_CASE("joint rates of the translational reaction null space keep the base centroid still") {
  Random random(55);
  for (int trial = 0; trial < 10; ++trial) {
    const int n = 5 + random.index(4);
    const Posture p = random_posture(random, n);
    const ReactionNullSpace space = translational_reaction_null_space(p.at.inertia);
    JointVectord xi(n);
    for (int k = 0; k < n; ++k) xi[k] = random.uniform(-1, 1);
    const Vector6d Omega =
        free_floating_base_velocity(p.at.inertia, JointVectord(space.P_RNS * xi));
    CHECK(Omega.head<3>().norm() < 1e-10);
    CHECK(Omega.tail<3>().norm() > 1e-6);
  }
}

TEST_CASE("locked joints make the robot one rigid body") {
  Random random(56);
  for (int trial = 0; trial < 10; ++trial) {
    const int n = 3 + random.index(5);
    const Posture p = random_posture(random, n);
    const auto factor = factorize_inertia(p.at.inertia, JointVectord::Zero(n),
                                          std::vector<bool>(static_cast<std::size_t>(n), true));
    const auto jump = compute_jump(factor, p.at.jacobian, p.Fbar);
    CHECK(jump.Delta_phidot.norm() == 0);
    const Vector6d rigid = test::solve(p.at.inertia.H_b, p.at.jacobian.R_bh.transpose() * p.Fbar);
    CHECK((jump.Delta_Omega - rigid).norm() < 1e-11 * (1 + rigid.norm()));
  }
}

}  // namespace stillbase
