#include <stillbase/simulation/plant.hpp>

#include <algorithm>

#include <stillbase/dynamics/articulated_body.hpp>
#include <stillbase/impact/gradient.hpp>

#include "dynamics/wide_joint_values.hpp"
#include "simulation/motion_kernel.hpp"

namespace stillbase {

PlantState state_at_rest(const Pose& base, const JointVectord& phi) {
  return {base, phi, Vector6d::Zero(), JointVectord::Zero(phi.size())};
}

PlantTerms::PlantTerms(const RobotModel& robot, const JointVectord& rotor_inertia,
                       const PlantState& state)
    : kinematics(compute_kinematics(robot, state.phi)),
      inertia(kernel::inertia_with_rotors<double>(robot, kinematics, rotor_inertia)),
      tilde(compute_tilde_inertia(inertia)),
      bias(compute_bias(robot, kinematics, inertia, state.Omega, state.phidot)) {}

PlantAcceleration compute_acceleration(const PlantTerms& terms, const Vector6d& F_b,
                                       const JointVectord& tau, const std::vector<bool>& held) {
  // The jump (6) and the motion (3) have the same matrix; H_phi already holds the rotors.
  const JointVectord nothing_added = JointVectord::Zero(tau.size());
  const auto factor = factorize_inertia<double>(terms.inertia, terms.tilde, nothing_added, held);
  const auto motion = acceleration_of<double>(factor, terms.bias, F_b, tau);
  return {motion.Omega, motion.phidot};
}

PlantAcceleration compute_acceleration(const RobotModel& robot, const JointVectord& rotor_inertia,
                                       const PlantState& state, const Vector6d& F_b,
                                       const JointVectord& tau, const std::vector<bool>& held) {
  const bool moves_freely = std::find(held.begin(), held.end(), true) == held.end();
  const WideKernel* const wide = wide_kernel(robot);
  if (wide != nullptr && moves_freely) {
    PlantAcceleration out;
    out.phiddot.resize(robot.n());
    wide->motion(robot, WideJointValues(robot, state.phi).plain(), rotor_inertia.data(),
                 {state.Omega.data(), state.phidot.data()}, {F_b.data(), tau.data()},
                 {out.dot_Omega.data(), out.phiddot.data()});
    return out;
  }
  if (robot.n() >= kArticulatedBodyJoints && !robot.is_coupled()) {
    const auto kinematics = compute_kinematics<double>(robot, state.phi);
    const auto bodies = factorize_articulated_bodies(robot, kinematics, rotor_inertia, held);
    const auto motion = articulated_acceleration<double>(robot, kinematics, bodies, state.Omega,
                                                         state.phidot, F_b, tau);
    return {motion.Omega, motion.phidot};
  }
  return compute_acceleration(PlantTerms(robot, rotor_inertia, state), F_b, tau, held);
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
  return kinetic_energy_of<double>(inertia, state.Omega, state.phidot);
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
