// The controllers against the equations they come from, and the arm that loses rank.
#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <stillbase/dynamics/reaction_null_space.hpp>
#include <stillbase/simulation/simulate.hpp>

#include "simulation/controller_kernel.hpp"
#include "simulation/robots.hpp"

namespace stillbase::test {
namespace {

/// (24), letter by letter.
JointVectord torque_as_printed(const Controller& c, const PlantTerms& terms,
                               const PlantState& state) {
  const Matrix3d& Htilde_omega = terms.tilde.Htilde_omega;
  const Matrix3Xd& Htilde_omegaphi = terms.tilde.Htilde_omegaphi;
  const JointMatrixd& Htilde_phi = terms.tilde.Htilde_phi;
  const TildeBias<double> bias = compute_tilde_bias(terms.inertia, terms.bias);
  const ReactionNullSpace space = angular_reaction_null_space(terms.tilde);
  const Eigen::MatrixXd pinv = space.A_pinv;
  const Eigen::MatrixXd Hbar = Htilde_omegaphi.transpose() - Htilde_phi * pinv * Htilde_omega;
  const Eigen::VectorXd cbar = bias.ctilde_phi - Htilde_phi * pinv * bias.ctilde_omega;
  Eigen::VectorXd tau = -Hbar * c.K_omega * state.Omega.tail<3>() + cbar;
  if (c.kind == ControllerKind::RnsDamped) {
    tau -= Htilde_phi * space.P_RNS * c.K_phi * state.phidot;
  }
  return tau;
}

PlantAcceleration closed_loop(const Controller& c, const PlantTerms& terms,
                              const PlantState& state) {
  return compute_acceleration(terms, Vector6d::Zero(), control_torque(c, terms, state));
}

PlantState struck(const RobotModel& robot, Random& random, double impulse) {
  PlantState state = random_state(random, robot.n(), 0);
  Vector6d Fbar = Vector6d::Zero();
  Fbar.head<3>() = impulse * random.unit_vector();
  return state_after_impact(robot, {}, state, Fbar);
}

}  // namespace

TEST_CASE("controllers have the names of the interface", "[simulation]") {
  CHECK(controller_names() == std::vector<std::string>{"none", "joint_damping",
                                                       "joint_damping_literal", "rns", "rns_damped",
                                                       "rns_handback", "detumble"});
  for (const std::string& name : controller_names()) {
    REQUIRE(controller_from_name(name).has_value());
    CHECK(to_string(*controller_from_name(name)) == name);
  }
  CHECK_FALSE(controller_from_name("rns_magic").has_value());
}

TEST_CASE("with full rank the reaction null space torque is (24)", "[simulation]") {
  int compared = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    Random random(seed, 17);
    const RobotModel robot = random_robot(random, 5, seed % 2 == 1);
    const PlantState state = random_state(random, 5, 0.5);
    const PlantTerms terms(robot, JointVectord::Constant(5, seed % 3 == 0 ? 0.4 : 0.0), state);
    Controller c;
    c.rank_edge = 1e-4;
    c.joint_rate_edge = 1e6;
    for (const ControllerKind kind : {ControllerKind::Rns, ControllerKind::RnsDamped}) {
      c.kind = kind;
      const JointVectord printed = torque_as_printed(c, terms, state);
      const JointVectord torque = control_torque(c, terms, state);
      CHECK((torque - printed).norm() < 1e-9 * printed.norm());
      ++compared;
    }
    // (23): the decay that the controller wants comes out.
    const PlantAcceleration acceleration = closed_loop(c, terms, state);
    const Vector3d wanted = -c.K_omega * state.Omega.tail<3>();
    CHECK((acceleration.dot_Omega.tail<3>() - wanted).norm() < 1e-9 * wanted.norm());
  }
  CHECK(compared == 40);
}

TEST_CASE("joint damping makes the joint rates decay by (18)", "[simulation]") {
  Random random(1, 19);
  const RobotModel robot = random_robot(random, 6, true);
  const PlantState state = random_state(random, 6, 0.5);
  const PlantTerms terms(robot, JointVectord::Constant(6, 0.3), state);
  Controller c;
  c.kind = ControllerKind::JointDamping;
  const PlantAcceleration acceleration = closed_loop(c, terms, state);
  CHECK((acceleration.phiddot + c.K_phi * state.phidot).norm() < 1e-10 * state.phidot.norm());

  c.kind = ControllerKind::JointDampingLiteral;
  const PlantAcceleration literal = closed_loop(c, terms, state);
  const HatInertia<double> hat =
      compute_hat_inertia(terms.inertia, compute_hand_jacobian(robot, terms.kinematics));
  CHECK((hat.Hhat_phi * literal.phiddot + c.K_phi * state.phidot).norm() < 1e-9);
}

TEST_CASE("null-space damping does not touch the base", "[simulation]") {
  Random random(2, 19);
  const RobotModel robot = random_robot(random, 6, false);
  const PlantState state = random_state(random, 6, 0.5);
  const PlantTerms terms(robot, JointVectord::Zero(6), state);
  Controller c;
  c.rank_edge = 1e-4;
  c.joint_rate_edge = 1e6;
  c.kind = ControllerKind::Rns;
  const PlantAcceleration without = closed_loop(c, terms, state);
  c.kind = ControllerKind::RnsDamped;
  const PlantAcceleration with = closed_loop(c, terms, state);
  CHECK((with.dot_Omega - without.dot_Omega).tail<3>().norm() < 1e-10);
  CHECK((with.phiddot - without.phiddot).norm() > 0.1);
}

TEST_CASE("with rank loss the reachable directions have the wanted acceleration", "[simulation]") {
  const RobotModel robot = spart_3dof();
  double printed_miss = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    Random random(seed, 23);
    const PlantState state = random_state(random, 3, 0.3);
    const PlantTerms terms(robot, JointVectord::Zero(3), state);
    const ReactionNullSpace space = angular_reaction_null_space(terms.tilde);
    REQUIRE(space.rank == 2);
    Controller c;
    c.kind = ControllerKind::RnsDamped;
    c.joint_rate_edge = 1e6;
    const PlantAcceleration acceleration = closed_loop(c, terms, state);
    const TildeBias<double> bias = compute_tilde_bias(terms.inertia, terms.bias);
    const Vector3d omega = state.Omega.tail<3>();
    const Vector3d got = terms.tilde.Htilde_omega * acceleration.dot_Omega.tail<3>();
    const Vector3d wanted = -c.K_omega * (terms.tilde.Htilde_omega * omega);
    const Eigen::Matrix<double, 3, 2> U = space.range;
    CHECK((U.transpose() * (got - wanted)).norm() < 1e-8 * wanted.norm());
    // Along the lost direction only the bias acts.
    const Vector3d u = U.col(0).cross(U.col(1));
    CHECK(std::abs(u.dot(got + bias.ctilde_omega)) < 1e-8 * wanted.norm());
    const PlantAcceleration printed =
        compute_acceleration(terms, Vector6d::Zero(), torque_as_printed(c, terms, state));
    const Vector3d printed_got = terms.tilde.Htilde_omega * printed.dot_Omega.tail<3>();
    printed_miss =
        std::max(printed_miss, (U.transpose() * (printed_got - wanted)).norm() / wanted.norm());
  }
  // The law as printed misses in the reachable directions too.
  CHECK(printed_miss > 0.1);
}

TEST_CASE("the SPART arm leaves the lost momentum in the base, with bounded torques",
          "[simulation]") {
  const RobotModel robot = spart_3dof();
  double worst_torque = 0, worst_without_edge = 0;
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    Random random(seed, 29);
    const PlantState state = struck(robot, random, 10);
    Controller c;
    c.kind = ControllerKind::RnsDamped;
    SimulationOptions options;
    options.integrator = IntegratorKind::Fehlberg78;
    options.control_period = 0;
    options.horizon = 10;
    options.max_steps = 100000;
    const SimulationResult result = simulate_post_impact(robot, {}, state, c, options);
    INFO("seed " << seed);
    REQUIRE(result.status == SimulationStatus::Finished);
    const SimulationSummary& summary = result.summary;
    CHECK(summary.lowest_rank <= 2);
    worst_torque = std::max(worst_torque, summary.peak_torque);
    CHECK(summary.peak_joint_rate < 2 * std::max(state.phidot.norm(), c.joint_rate_edge));
    CHECK(summary.relative_momentum_drift < 1e-9);
    for (const TraceSample& sample : result.trace) {
      const PlantTerms terms(robot, JointVectord::Zero(3), sample.state);
      const ReactionNullSpace space = angular_reaction_null_space(terms.tilde);
      const Eigen::Matrix<double, 3, 2> U = space.range;
      const Vector3d u = U.col(0).cross(U.col(1));
      CHECK(std::abs(u.dot(sample.base) - u.dot(sample.total)) < 1e-9);
    }
    c.joint_rate_edge = 1e6;
    worst_without_edge = std::max(
        worst_without_edge, simulate_post_impact(robot, {}, state, c, options).summary.peak_torque);
    // The reported loss is the momentum of the base at the end; its other parts have decayed.
    const TraceSample& last = result.trace.back();
    CHECK(summary.lost_momentum.norm() <= summary.peak_lost_momentum);
    if (summary.lost_momentum.norm() > 0.3) {
      CHECK(summary.lost_direction.norm() == Approx(1));
      CHECK((last.base - summary.lost_momentum).norm() < 0.5 * last.base.norm());
    }
  }
  CHECK(worst_torque < 250);
  CHECK(worst_without_edge > 10 * worst_torque);
}

TEST_CASE("without any reachable direction the controller's torques are finite", "[simulation]") {
  const MomentumTransfer<double> none =
      compute_momentum_transfer<double>(Controller{}, Matrix3Xd::Zero(3, 4), Vector3d(1, 2, 3));
  CHECK(none.rank == 0);
  CHECK(none.joint_rates(Matrix3Xd::Zero(3, 4), Vector3d(1, 2, 3)).norm() == 0);
  CHECK((none.unreachable(Vector3d(1, 2, 3)) - Vector3d(1, 2, 3)).norm() < 1e-15);
}

TEST_CASE("joint rates for the base grow no further than the edge allows", "[simulation]") {
  Controller c;
  const Vector3d L_g(0, 0.3, 4);
  const double edge = momentum_edge<double>(c, 2, L_g.norm());
  for (double sigma = 1; sigma > 1e-12; sigma /= 3) {
    Matrix3Xd A = Matrix3Xd::Zero(3, 3);
    A.diagonal() = Vector3d(2, 1, sigma);
    const MomentumTransfer<double> transfer = compute_momentum_transfer<double>(c, A, L_g);
    CHECK(transfer.joint_rates(A, L_g).norm() <= L_g.norm() / edge * (1 + 1e-12));
    const Vector3d carried = A * transfer.joint_rates(A, L_g);
    CHECK((carried + transfer.unreachable(L_g) - L_g).norm() < 1e-12);
  }
}

/// Three random orthonormal columns.
Eigen::MatrixXd orthonormal(Random& random, int rows) {
  Eigen::MatrixXd out(rows, 3);
  for (double& entry : out.reshaped()) entry = random.normal();
  return Eigen::HouseholderQR<Eigen::MatrixXd>(out).householderQ() *
         Eigen::MatrixXd::Identity(rows, 3);
}

TEST_CASE("the least eigenvalue and its direction are known where the others are apart from it",
          "[simulation]") {
  Random random(9, 45);
  int apart = 0, close = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    const double size = std::pow(10, random.uniform(-6, 6));
    const double b = std::pow(10, random.uniform(-3, 0));
    const double l = trial % 5 == 0 ? 0 : b * std::pow(10, random.uniform(-6, 0));
    const Matrix3d U = orthonormal(random, 3);
    const Matrix3d half = size * U * Vector3d(1, b, l).asDiagonal() * U.transpose();
    const Symmetric3<double> square(0.5 * (half + half.transpose()));
    const LeastEigenvalue<double> least(square);
    INFO("trial " << trial << ": 1, " << b << ", " << l << " times " << size);
    if (b > 0.1 && l < 0.1 * b) {
      CHECK(least.certainty >= 0);
      ++apart;
    }
    if (b < 0.01 || l > 0.95 * b) {
      CHECK(least.certainty < 0);
      ++close;
    }
    if (!(least.certainty >= 0)) continue;
    CHECK(std::abs(least.l - size * l) < 1e-12 * size);
    CHECK(least.sum == Approx(size * (1 + b)).epsilon(1e-12));
    CHECK(least.product == Approx(size * size * b).epsilon(1e-11));
    const Matrix3d N = least.sum * Matrix3d::Identity() - square.M;
    const Matrix3d direction = (square.adjugate - least.l * N) / least.apart;
    CHECK((direction - U.col(2) * U.col(2).transpose()).norm() < 1e-11);
  }
  CHECK(apart > 500);
  CHECK(close > 500);
  for (const Matrix3d& M : {Matrix3d(Matrix3d::Zero()), Matrix3d(Vector3d(2, 0, 0).asDiagonal())}) {
    CHECK(!(LeastEigenvalue<double>(Symmetric3<double>(M)).certainty >= 0));
  }
}

TEST_CASE("the damped inverse is that of the singular directions", "[simulation]") {
  Random random(9, 44);
  int whole = 0, damped = 0;
  for (int trial = 0; trial < 6000; ++trial) {
    // Singular values of all sizes, the least ones zero in a third of the trials.
    const double second = trial % 11 == 0 ? 0 : std::pow(10, random.uniform(-6, 0));
    const double third = trial % 3 == 0 ? 0 : second * std::pow(10, random.uniform(-4, 0));
    const double scale = std::pow(10, random.uniform(-3, 3));
    const Eigen::MatrixXd U = orthonormal(random, 3), W = orthonormal(random, 3 + trial % 5);
    const Vector3d sigma = scale * Vector3d(1, second, third);
    const Matrix3Xd A = U * sigma.asDiagonal() * W.transpose();
    Controller c;
    c.rank_edge = std::array{1e-4, 1e-6, 2e-7}[static_cast<std::size_t>(trial) / 3 % 3];
    const double momentum = trial % 2 == 0 ? 0 : scale * std::pow(10, random.uniform(-6, 1));
    const Vector3d L_g = random.unit_vector() * momentum;
    const double edge = momentum_edge<double>(c, sigma[0], L_g.norm());
    const Matrix3d expected =
        U * sigma.cwiseMax(edge).array().square().inverse().matrix().asDiagonal() * U.transpose();
    const Matrix3d inverse = damped_inverse_square<double>(c, A, L_g);
    INFO("trial " << trial << ": " << sigma.transpose() << ", edge " << edge);
    REQUIRE(inverse.allFinite());
    // A A' is known to the rounding of its largest eigenvalue, the quick inverse to 1e-11.
    const double condition = std::pow(sigma[0] / std::max(sigma[2], edge), 2);
    CHECK((inverse - expected).norm() <= std::max(2e-11, 2e-15 * condition) * expected.norm());
    whole += sigma[2] > edge ? 1 : 0;
    damped += sigma[2] < edge ? 1 : 0;
  }
  CHECK(whole > 1000);
  CHECK(damped > 1000);
  // Nothing to push with, or a joint or two alone.
  for (const double momentum : {0., 1.}) {
    const Vector3d L_g(0, momentum, 0);
    CHECK(damped_inverse_square<double>(Controller{}, Matrix3Xd::Zero(3, 4), L_g).isZero(0));
    for (const int n : {1, 2}) {
      Matrix3Xd A(3, n);
      for (double& entry : A.reshaped()) entry = random.normal();
      const auto transfer = compute_momentum_transfer<double>(Controller{}, A, L_g);
      const Matrix3d expected = transfer.U * transfer.inverse.asDiagonal() * transfer.U.transpose();
      const Matrix3d inverse = damped_inverse_square<double>(Controller{}, A, L_g);
      CHECK((inverse - expected).norm() <= 1e-9 * expected.norm());
    }
  }
}

}  // namespace stillbase::test
