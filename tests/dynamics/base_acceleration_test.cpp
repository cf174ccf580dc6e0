// Equations (7) and (9): joint accelerations for a wanted base acceleration. What the base then
// does is computed from the reference's H, c and J, never from the functions under test.
#include <algorithm>
#include <cmath>

#include <catch2/catch.hpp>

#include <stillbase/dynamics/base_acceleration.hpp>
#include <stillbase/dynamics/momentum.hpp>

#include "reference/random_state.hpp"
#include "support/dense.hpp"

using namespace stillbase;
using namespace stillbase::reference_test;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

struct Terms {
  InertiaMatrices<double> inertia;
  BiasForces<double> bias;
  HandJacobian<double> jacobian;
  BaseEquation equation() const { return {inertia, bias, jacobian}; }
};

Terms terms(const RobotModel& robot, const JointVectord& phi, const Vector6d& Omega,
            const JointVectord& phidot) {
  const auto kinematics = compute_kinematics<double>(robot, phi);
  Terms t;
  t.inertia = compute_inertia(robot, kinematics);
  t.bias = compute_bias<double>(robot, kinematics, t.inertia, Omega, phidot);
  t.jacobian = compute_hand_jacobian(robot, kinematics);
  return t;
}

struct Case {
  RobotModel robot;
  reference::State state;
  reference::Dynamics d;
  Terms terms_at;
  ExternalWrenches external;
  JointVectord xi;
};

Case random_case(std::uint64_t seed, int trial, int n, bool tree = false) {
  Random random(seed, static_cast<std::uint64_t>(trial));
  Case c;
  c.robot = random_robot(random, n, tree);
  c.state = random_state(random, n);
  c.d = reference::compute(c.robot, c.state);
  c.terms_at = terms(c.robot, c.state.phi, c.state.Omega, c.state.phidot);
  c.external.F_b << random_vector(random, 10), random_vector(random, 3);
  c.external.F_h << random_vector(random, 10), random_vector(random, 3);
  c.xi.resize(n);
  for (int k = 0; k < n; ++k) c.xi[k] = random.normal();
  return c;
}

/// dot Omega from the upper rows of (3) with the reference's matrices.
Vector6d base_motion(const Case& c, const JointVectord& phiddot) {
  const auto n = phiddot.size();
  VectorXd right = c.external.F_b + c.d.J.leftCols(6).transpose() * c.external.F_h - c.d.c.head(6) -
                   c.d.H.topRightCorner(6, n) * VectorXd(phiddot);
  return test::solve(c.d.H.topLeftCorner(6, 6), right);
}

constexpr double kTolerance = 1e-9;  // coupling matrices of random robots have conditions to 1e4

}  // namespace

TEST_CASE("(7): with more than six joints the base accelerates as wanted under external forces") {
  for (int trial = 0; trial < 200; ++trial) {
    const int n = 7 + trial % 5;
    const Case c = random_case(501, trial, n);
    Vector6d wanted;
    wanted << 0.3, -0.2, 0.5, 0.1, -0.4, 0.2;
    const auto a = joint_acceleration_for_base(c.terms_at.equation(), c.external, wanted, c.xi);
    REQUIRE(a.space.rank == 6);
    CHECK(a.missing.norm() <= 1e-12 * c.d.H.norm());
    CHECK((base_motion(c, a.phiddot) - wanted).norm() <= kTolerance * (1 + a.phiddot.norm()));
    // xi moves the arm, not the base.
    const auto still = joint_acceleration_for_base(c.terms_at.equation(), c.external, wanted,
                                                   JointVectord::Zero(n));
    CHECK((a.phiddot - still.phiddot).norm() > 1e-3);
    CHECK(still.phiddot.norm() <= a.phiddot.norm());
  }
}

TEST_CASE("(9): with more than three joints the base rotates as wanted under external forces") {
  for (int trial = 0; trial < 200; ++trial) {
    const int n = 4 + trial % 5;
    const Case c = random_case(502, trial, n, trial % 3 == 0);
    const Vector3d wanted(0.1, -0.4, 0.2);
    const auto a = joint_acceleration_for_rotation(c.terms_at.equation(), c.external, wanted, c.xi);
    if (a.space.rank < 3) continue;  // several prismatic joints
    CHECK(a.missing.norm() <= 1e-12 * c.d.H.norm());
    const Vector3d turned = base_motion(c, a.phiddot).tail<3>();
    CHECK((turned - wanted).norm() <= kTolerance * (1 + a.phiddot.norm()));
  }
}

TEST_CASE("with base rotation eliminated the base centroid accelerates as wanted") {
  for (int trial = 0; trial < 200; ++trial) {
    const int n = 4 + trial % 5;
    const Case c = random_case(503, trial, n);
    const Vector3d wanted(0.1, -0.4, 0.2);
    const auto a =
        joint_acceleration_for_translation(c.terms_at.equation(), c.external, wanted, c.xi);
    REQUIRE(a.space.rank == 3);
    const Vector3d moved = base_motion(c, a.phiddot).head<3>();
    CHECK((moved - wanted).norm() <= kTolerance * (1 + a.phiddot.norm()));
  }
}

TEST_CASE("what too few joints cannot give is reported and is all that is missing") {
  for (int trial = 0; trial < 100; ++trial) {
    const int n = 1 + trial % 5;
    const Case c = random_case(504, trial, n);
    Vector6d wanted;
    wanted << 0.3, -0.2, 0.5, 0.1, -0.4, 0.2;
    const auto a = joint_acceleration_for_base(c.terms_at.equation(), c.external, wanted, c.xi);
    CHECK(a.space.rank <= n);
    REQUIRE(a.missing.size() == 6);
    CHECK(a.missing.norm() > 1e-3);
    // With the missing wrench applied at the base, the wish comes true.
    Case helped = c;
    helped.external.F_b -= a.missing;
    CHECK((base_motion(helped, a.phiddot) - wanted).norm() <= kTolerance * (1 + a.phiddot.norm()));
    // Least squares: what is missing is normal to everything that joints can do.
    CHECK((c.d.H.topRightCorner(6, n).transpose() * a.missing).norm() <=
          1e-11 * c.d.H.norm() * a.missing.norm());
  }
}

TEST_CASE("base acceleration and joint torque are the two halves of (3)") {
  for (int trial = 0; trial < 100; ++trial) {
    const int n = 1 + trial % 9;
    const Case c = random_case(505, trial, n);
    const Vector6d dot_Omega = base_acceleration(c.terms_at.equation(), c.external, c.xi);
    CHECK((dot_Omega - base_motion(c, c.xi)).norm() <= 1e-10 * (1 + dot_Omega.norm()));
    const JointVectord tau = joint_torque(c.terms_at.equation(), c.external, dot_Omega, c.xi);
    VectorXd x(6 + n), load(6 + n);
    x << dot_Omega, c.xi;
    load << c.external.F_b, tau;
    const VectorXd rest = c.d.H * x + c.d.c - load - c.d.J.transpose() * c.external.F_h;
    CHECK(rest.norm() <= 1e-10 * (c.d.H.norm() * x.norm() + c.d.c.norm()));
  }
}

TEST_CASE("joint rates in each reaction null space leave their part of the base still") {
  // At zero momentum, from the reference's H: the whole base, its attitude, its centroid.
  for (int trial = 0; trial < 200; ++trial) {
    const int n = 4 + trial % 8;
    const Case c = random_case(506, trial, n, trial % 3 == 0);
    const auto& inertia = c.terms_at.inertia;
    const auto base = [&](const VectorXd& phidot) -> Vector6d {
      return test::solve(c.d.H.topLeftCorner(6, 6), -c.d.H.topRightCorner(6, n) * phidot);
    };
    const double scale = base(c.xi).norm();
    const auto angular = angular_reaction_null_space(compute_tilde_inertia(inertia));
    const auto translational = translational_reaction_null_space(inertia);
    const auto full = full_reaction_null_space(inertia);
    CHECK(base(angular.P_RNS * c.xi).tail<3>().norm() <= 1e-12 * scale);
    CHECK(base(translational.P_RNS * c.xi).head<3>().norm() <= 1e-12 * scale);
    CHECK(base(full.P_RNS * c.xi).norm() <= 1e-12 * scale);
    CHECK(angular.rank <= 3);
    CHECK(translational.rank <= 3);
    CHECK(full.rank <= std::min(n, 6));
    CHECK(angular.rank_tolerance == kRankTolerance);
    CHECK((angular.P_RNS * c.xi).norm() > 1e-3);
  }
}

TEST_CASE("the null space of H_vphi alone does not keep the base centroid still") {
  const Case c = random_case(507, 1, 6);
  const Matrix3Xd H_vphi = c.terms_at.inertia.H_bphi.topRows<3>();
  const JointVectord phidot = compute_reaction_null_space(H_vphi).P_RNS * c.xi;
  CHECK(free_floating_base_velocity<double>(c.terms_at.inertia, phidot).head<3>().norm() > 1e-3);
}

TEST_CASE("the base centroid stays where it is while the robot moves by translational (7)") {
  // Closed loop in forward dynamics: zero momentum, joint torques from the wanted dot v, the plant
  // of the reference. The drift is the integrator's: it falls with the fourth power of the step.
  Random random(508);
  const int n = 6;
  const RobotModel robot = random_robot(random, n, false);
  const reference::State start = random_state(random, n);
  JointVectord xi(n), phidot0;
  for (int k = 0; k < n; ++k) xi[k] = random.normal();
  const Terms at = terms(robot, start.phi, Vector6d::Zero(), JointVectord::Zero(n));
  phidot0 = 0.3 * (translational_reaction_null_space(at.inertia).P_RNS * xi);

  // x = position of the base centroid in N, attitude quaternion (w, x, y, z), phi, Omega, phidot.
  const auto rate = [&](const VectorXd& x) -> VectorXd {
    const Eigen::Quaterniond q(x[3], x[4], x[5], x[6]);
    const JointVectord phi = x.segment(7, n), phidot = x.tail(n);
    const Vector6d Omega = x.segment<6>(7 + n);
    const Vector3d v = Omega.head<3>(), omega = Omega.tail<3>();
    const Terms t = terms(robot, phi, Omega, phidot);
    const auto a = joint_acceleration_for_translation(t.equation(), {}, -omega.cross(v),
                                                      JointVectord(0.5 * xi));
    const Vector6d dot_Omega = base_acceleration(t.equation(), {}, a.phiddot);
    const JointVectord tau = joint_torque(t.equation(), {}, dot_Omega, a.phiddot);
    // Forward dynamics by the other program: only the torque goes in.
    const auto d = reference::compute(robot, {phi, phidot, Omega});
    VectorXd load = -d.c;
    load.tail(n) += tau;
    VectorXd out(x.size());
    const Eigen::Quaterniond spin = q * Eigen::Quaterniond(0, omega.x(), omega.y(), omega.z());
    out << q * v, 0.5 * spin.w(), 0.5 * spin.x(), 0.5 * spin.y(), 0.5 * spin.z(), phidot,
        test::solve(d.H, load);
    return out;
  };
  VectorXd x(13 + 2 * n);
  x << Vector3d::Zero(), 1, 0, 0, 0, start.phi,
      free_floating_base_velocity<double>(at.inertia, phidot0), phidot0;
  CHECK(x.segment<3>(7 + n).norm() <= 1e-13);
  const auto run = [&](int steps) {
    VectorXd y = x;
    const double h = 1.0 / steps;
    for (int i = 0; i < steps; ++i) {
      const VectorXd a = rate(y), b = rate(y + h / 2 * a), c = rate(y + h / 2 * b),
                     d = rate(y + h * c);
      y += h / 6 * (a + 2 * b + 2 * c + d);
    }
    return y;
  };
  const VectorXd coarse = run(100), fine = run(200);
  CHECK(fine.head<3>().norm() <= 1e-8);
  CHECK((fine.head<3>().norm() <= coarse.head<3>().norm() / 8 || coarse.head<3>().norm() <= 1e-12));
  // It moved: the arm by a good part of a radian, the base only turned.
  CHECK((fine.segment(7, n) - start.phi).norm() > 0.05);
  CHECK(fine.segment<3>(4).norm() > 1e-3);
}
