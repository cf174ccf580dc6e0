// Drives: gear ratio squared times rotor inertia in the joints' inertia, in every implementation.
#include <catch2/catch.hpp>

#include <stillbase/dynamics/articulated_body.hpp>
#include <stillbase/dynamics/momentum.hpp>
#include <stillbase/impact/gradient.hpp>
#include <stillbase/impact/jump.hpp>

#include "reference/random_state.hpp"
#include "support/coupled_robot.hpp"
#include "support/random_robot.hpp"

using namespace stillbase;
using Eigen::MatrixXd;
using stillbase::reference_test::random_state;

namespace {

/// Drives on all joints but every third.
RobotModel with_drives(RobotModel robot, Random& random) {
  for (int k = 0; k < robot.n(); k += k % 3 == 1 ? 2 : 1) {
    robot.joints[static_cast<std::size_t>(k)].rotor_inertia = random.uniform(1e-5, 1e-3);
    robot.joints[static_cast<std::size_t>(k)].gear_ratio = random.uniform(-160, 160);
  }
  return robot;
}

JointVectord reflected(const RobotModel& robot) {
  JointVectord out(robot.n());
  for (int k = 0; k < robot.n(); ++k) out[k] = robot.joints[k].reflected_inertia();
  return out;
}

RobotModel without_drives(RobotModel robot) {
  for (Joint& joint : robot.joints) joint.rotor_inertia = 0;
  return robot;
}

double largest(const MatrixXd& m) { return m.size() == 0 ? 0 : m.cwiseAbs().maxCoeff(); }

}  // namespace

TEST_CASE("inertia with drives is the same in both implementations of the dynamics") {
  double worst = 0, least_share = kInfinity;
  for (int trial = 0; trial < 200; ++trial) {
    Random random(71, static_cast<std::uint64_t>(trial));
    const RobotModel robot =
        with_drives(random_robot(random, 1 + trial % 12, trial % 3 == 0), random);
    const int n = robot.n();
    const reference::State state = random_state(random, n);
    const auto d = reference::compute(robot, state);
    const JointVectord phi = state.phi;
    const auto inertia = compute_inertia(robot, compute_kinematics<double>(robot, phi));
    MatrixXd H(6 + n, 6 + n);
    H << MatrixXd(inertia.H_b), MatrixXd(inertia.H_bphi), MatrixXd(inertia.H_bphi).transpose(),
        MatrixXd(inertia.H_phi);
    worst = std::max(worst, largest(H - d.H) / largest(d.H));
    const auto bare =
        compute_inertia(without_drives(robot), compute_kinematics<double>(robot, phi));
    const MatrixXd added = MatrixXd(inertia.H_phi) - MatrixXd(bare.H_phi);
    const MatrixXd wanted = reflected(robot).asDiagonal();
    CHECK(largest(added - wanted) <= 1e-12 * (1 + largest(inertia.H_phi)));
    CHECK(MatrixXd(inertia.H_bphi) == MatrixXd(bare.H_bphi));
    least_share = std::min(least_share, largest(wanted) / largest(inertia.H_phi));
  }
  CHECK(worst < 1e-12);
  CHECK(least_share > 0);
}

TEST_CASE("drives of coupled joints count after the congruence in both implementations") {
  double worst = 0;
  for (int trial = 0; trial < 80; ++trial) {
    Random random(72, static_cast<std::uint64_t>(trial));
    const RobotModel open = with_drives(random_robot(random, 2 + trial % 9, false), random);
    const RobotModel robot = with_couplings(open, random);
    const int n = robot.n();
    const reference::State state = random_state(random, n);
    const auto d = reference::compute(robot, state);
    const JointVectord phi = state.phi;
    const auto inertia = compute_inertia(robot, compute_kinematics<double>(robot, phi));
    worst = std::max(worst, largest(MatrixXd(inertia.H_phi) - d.H.bottomRightCorner(n, n)) /
                                largest(inertia.H_phi));
    RobotModel bare = robot;
    for (Joint& joint : bare.coupled_tree) joint.rotor_inertia = 0;
    const MatrixXd added =
        MatrixXd(inertia.H_phi) -
        MatrixXd(compute_inertia(bare, compute_kinematics<double>(bare, phi)).H_phi);
    const MatrixXd G = coupling_matrix(robot);
    const MatrixXd wanted = G.transpose() * reflected(open).asDiagonal() * G;
    CHECK(largest(added - wanted) <= 1e-12 * (1 + largest(inertia.H_phi)));
  }
  CHECK(worst < 1e-12);
}

TEST_CASE("two bodies with a drive between them: the motion by hand") {
  // Both turn about z through their centroids: I_1 omega' + I_2 (omega' + phi'') = 0 and
  // I_2 (omega' + phi'') + r^2 I_r phi'' = tau.
  const double I_1 = 3, I_2 = 0.5, I_r = 2e-4, r = 100, tau = 1.5;
  RobotModel robot;
  robot.base.mass = 10;
  robot.base.inertia = Vector3d(4, 5, I_1).asDiagonal();
  robot.joints.emplace_back();
  robot.joints[0].rotor_inertia = I_r;
  robot.joints[0].gear_ratio = r;
  robot.bodies.emplace_back();
  robot.bodies[0].mass = 2;
  robot.bodies[0].inertia = Vector3d(0.4, 0.6, I_2).asDiagonal();
  robot.hand_body = 0;
  robot.moves_hand = {true};
  const double share = I_2 / (I_1 + I_2);
  const double acceleration = tau / (I_2 + r * r * I_r - I_2 * share);

  const JointVectord phi = JointVectord::Constant(1, 0.7), none = JointVectord::Zero(1),
                     torque = JointVectord::Constant(1, tau);
  const auto kinematics = compute_kinematics<double>(robot, phi);
  const auto dense = solve_inertia<double>(
      factorize_inertia(compute_inertia(robot, kinematics), none, {}), Vector6d::Zero(), torque);
  const auto bodies = factorize_articulated_bodies(robot, kinematics, none, {});
  const auto articulated =
      solve_articulated_bodies<double>(robot, bodies, Vector6d::Zero(), torque);
  for (const auto& motion : {dense, articulated}) {
    CHECK(motion.phidot[0] == Approx(acceleration).epsilon(1e-13));
    CHECK(motion.Omega[5] == Approx(-share * acceleration).epsilon(1e-13));
  }
}

TEST_CASE("articulated bodies and the inertia matrix agree with drives, a locked one drops out") {
  double worst = 0;
  for (int trial = 0; trial < 60; ++trial) {
    Random random(73, static_cast<std::uint64_t>(trial));
    const RobotModel robot =
        with_drives(random_robot(random, 2 + trial % 40, trial % 2 == 0), random);
    const int n = robot.n();
    const reference::State state = random_state(random, n);
    const JointVectord phi = state.phi, torque = state.phidot, none = JointVectord::Zero(n);
    std::vector<bool> locked;
    for (int k = 0; k < n && trial % 3 == 0; ++k) locked.push_back(random.uniform() < 0.4);
    const auto kinematics = compute_kinematics<double>(robot, phi);
    const auto dense = solve_inertia<double>(
        factorize_inertia(compute_inertia(robot, kinematics), none, locked), state.Omega, torque);
    const auto bodies = factorize_articulated_bodies(robot, kinematics, none, locked);
    const auto motion = solve_articulated_bodies<double>(robot, bodies, state.Omega, torque);
    worst = std::max(worst, (dense.phidot - motion.phidot).norm() / dense.phidot.norm());
    worst = std::max(worst, (dense.Omega - motion.Omega).norm() / dense.Omega.norm());
  }
  CHECK(worst < 1e-10);
}

TEST_CASE("jump and gradient with drives are those of rotor inertia as joint resistance") {
  double worst = 0;
  for (int trial = 0; trial < 40; ++trial) {
    Random random(74, static_cast<std::uint64_t>(trial));
    const RobotModel robot =
        with_drives(random_robot(random, 2 + trial % 8, trial % 2 == 0), random);
    const int n = robot.n();
    const JointVectord phi = random_state(random, n).phi;
    const Vector6d F = random_state(random, n).Omega;
    JointResistance rotors;
    rotors.model = ResistanceModel::RotorInertia;
    rotors.rotor_inertia = reflected(robot);
    ResponseWeights<double> weights;
    weights.base = random_vector(random, 1, 1);
    const auto gradient_of = [&](const RobotModel& model, const JointResistance& resistance) {
      const auto posture = evaluate_posture(model, prepare_resistance(resistance, n), phi);
      return response_gradient<double>(model, posture, respond<double>(posture, F), weights);
    };
    const auto drives = gradient_of(robot, {});
    const auto resistance = gradient_of(without_drives(robot), rotors);
    worst = std::max(worst, largest(drives.phi - resistance.phi) / (1 + largest(drives.phi)));
    worst = std::max(worst, largest(drives.F - resistance.F) / (1 + largest(drives.F)));
  }
  CHECK(worst < 1e-11);
}
