#include <stillbase/simulation/plant.hpp>

#include <stillbase/impact/gradient.hpp>

namespace stillbase {
namespace {

InertiaMatrices<double> inertia_with_rotors(const RobotModel& robot,
                                            const Kinematics<double>& kinematics,
                                            const JointVectord& rotor_inertia) {
  InertiaMatrices<double> inertia = compute_inertia(robot, kinematics);
  inertia.H_phi.diagonal() += rotor_inertia;
  return inertia;
}

}  // namespace

PlantState state_at_rest(const Pose& base, const JointVectord& phi) {
  return {base, phi, Vector6d::Zero(), JointVectord::Zero(phi.size())};
}

PlantTerms::PlantTerms(const RobotModel& robot, const JointVectord& rotor_inertia,
                       const PlantState& state)
    : kinematics(compute_kinematics(robot, state.phi)),
      inertia(inertia_with_rotors(robot, kinematics, rotor_inertia)),
      tilde(compute_tilde_inertia(inertia)),
      bias(compute_bias(robot, kinematics, inertia, state.Omega, state.phidot)) {}

PlantAcceleration compute_acceleration(const PlantTerms& terms, const Vector6d& F_b,
                                       const JointVectord& tau, const std::vector<bool>& held) {
  // The jump (6) and the motion (3) have the same matrix; H_phi already holds the rotors.
  const JointVectord nothing_added = JointVectord::Zero(tau.size());
  const InertiaFactor<double> factor = factorize_inertia(terms.inertia, nothing_added, held);
  const Vector6d base = F_b - terms.bias.c_b;
  const JointVectord joints = tau - terms.bias.c_phi;
  const GeneralizedMotion<double> solution = solve_inertia(factor, base, joints);
  return {solution.Omega, solution.phidot};
}

JointVectord holding_torque(const PlantTerms& terms, const PlantAcceleration& acceleration,
                            const JointVectord& tau) {
  JointVectord torque = terms.bias.c_phi - tau;
  torque.noalias() += terms.inertia.H_bphi.transpose() * acceleration.dot_Omega;
  torque.noalias() += terms.inertia.H_phi * acceleration.phiddot;
  return torque;
}

void impose_joint_rate(const PlantTerms& terms, int k, double rate, const std::vector<bool>& held,
                       PlantState& state) {
  const JointVectord nothing_added = JointVectord::Zero(state.phi.size());
  const InertiaFactor<double> factor = factorize_inertia(terms.inertia, nothing_added, held);
  const JointVectord unit = JointVectord::Unit(state.phi.size(), k);
  const auto jump = solve_inertia<double>(factor, Vector6d::Zero(), unit);
  const double impulse = (rate - state.phidot[k]) / jump.phidot[k];
  state.Omega += impulse * jump.Omega;
  state.phidot += impulse * jump.phidot;
  state.phidot[k] = rate;
}

double kinetic_energy(const InertiaMatrices<double>& inertia, const PlantState& state) {
  const Vector6d base = inertia.H_b * state.Omega;
  const Vector6d coupling = inertia.H_bphi * state.phidot;
  const JointVectord arm = inertia.H_phi * state.phidot;
  return 0.5 * state.Omega.dot(base) + state.Omega.dot(coupling) + 0.5 * state.phidot.dot(arm);
}

PlantState state_after_impact(const RobotModel& robot, const JointResistance& resistance,
                              const PlantState& before, const Vector6d& Fbar) {
  const auto posture =
      evaluate_posture(robot, prepare_resistance(resistance, robot.n()), before.phi);
  const ImpactJump<double> jump = compute_jump(posture.factor, posture.jacobian, Fbar);
  PlantState after = before;
  after.Omega += jump.Delta_Omega;
  after.phidot += jump.Delta_phidot;
  return after;
}

}  // namespace stillbase
