#include <stillbase/simulation/model_check.hpp>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <stillbase/core/constants.hpp>
#include <stillbase/impact/contact_impulse.hpp>

namespace stillbase {
namespace {

/// The instantaneous impact of the case.
ContactOutcome jump(const ModelCheckCase& subject, const JointResistance& resistance,
                    const TargetPlantState& target, const Vector3d& hand_N) {
  const Eigen::Quaterniond R_BN = subject.before.base.orientation.conjugate();
  const Matrix3d R_BT = (R_BN * target.pose.orientation).toRotationMatrix();
  ContactTarget body;
  body.mass = subject.target.mass;
  body.inertia = R_BT * subject.target.inertia * R_BT.transpose();
  body.r = R_BN * Vector3d(hand_N - target.pose.position);
  body.velocity = R_BN * target.velocity;
  body.angular_velocity = R_BT * target.angular_velocity;
  Contact contact;
  contact.restitution = subject.restitution;
  contact.n = R_BT * subject.normal_T;
  return apply_contact(subject.robot, subject.before.phi, subject.before.Omega,
                       subject.before.phidot, resistance, contact, body);
}

/// Generalised velocity [Omega; phidot].
Eigen::VectorXd velocity(const Vector6d& Omega, const JointVectord& phidot) {
  Eigen::VectorXd x(6 + phidot.size());
  x << Omega, phidot;
  return x;
}

}  // namespace

std::vector<ModelCheckRow> check_stiffness(const ModelCheckCase& subject,
                                           const std::vector<double>& stiffness,
                                           const StopCondition& stop) {
  const RobotModel& robot = subject.robot;
  const JointVectord rotors = added_plant_inertia(subject.resistance, robot.n());
  const PlantTerms terms(robot, rotors, subject.before);
  const Vector3d hand_N = subject.before.base * terms.kinematics.r_bh;
  TargetPlantState target = subject.target_state;
  target.pose.position = hand_N - target.pose.orientation * subject.point_T;
  const InertiaMatrices<double>& inertia = terms.inertia;
  Eigen::MatrixXd H(6 + robot.n(), 6 + robot.n());
  H << inertia.H_b, inertia.H_bphi, inertia.H_bphi.transpose(), inertia.H_phi;
  const Eigen::VectorXd x0 = velocity(subject.before.Omega, subject.before.phidot);
  const auto energy_norm = [&](const Eigen::VectorXd& x) { return std::sqrt(x.dot(H * x)); };

  JointResistance during = subject.resistance;  // what the compliant run's plant has
  const bool servo = during.model == ResistanceModel::Servo;
  if (during.model == ResistanceModel::Locked) {
    throw std::invalid_argument("the compliant contact knows no locked joints");
  }
  JointResistance free = subject.resistance;
  if (servo) free = {};
  const ContactOutcome rigid = jump(subject, free, target, hand_N);
  if (rigid.impulse.status != ContactStatus::Hit) {
    throw std::invalid_argument("hand and target do not close in");
  }
  const ContactOutcome bare = jump(subject, {}, target, hand_N);
  const double p = rigid.impulse.Fbar.norm();
  const double effective_mass = p / ((1 + subject.restitution) * rigid.impulse.closing_speed);

  std::vector<ModelCheckRow> rows;
  for (const double k : stiffness) {
    EncounterPlant plant = subject.target;
    plant.contact.stiffness = k;
    plant.contact.damping = contact_damping(subject.restitution, k, effective_mass);
    plant.contact.friction = subject.friction;
    plant.contact.point = subject.point_T;
    plant.contact.normal = subject.normal_T;
    plant.end_with_contact = true;
    if (servo) {
      plant.servo = {during.stiffness, during.damping};
      plant.servo_posture = subject.before.phi;
    }
    SimulationOptions options;
    options.integrator = IntegratorKind::Fehlberg78;
    const double half_period = std::sqrt(effective_mass / k) * kPi;
    options.horizon = 20 * half_period;  // a soft, damped contact takes longer than half a period
    options.step = half_period / 50;
    options.control_period = 0;
    options.output_period = half_period / 100;
    options.joint_stops = false;
    options.relative_tolerance = 1e-12;
    options.absolute_tolerance = 1e-15;
    options.stop = stop;
    const EncounterResult run =
        simulate_encounter(robot, free, subject.before, target, plant, Controller{}, options);

    ModelCheckRow row;
    row.stiffness = k;
    row.ended = run.simulation.status == SimulationStatus::Finished && run.contact.contacts > 0 &&
                run.contact.phase != ContactPhase::Touching;
    row.duration = run.contact.first_end - run.contact.first_begin;
    for (const TraceSample& sample : run.simulation.trace) {
      row.peak_force = std::max(row.peak_force, sample.contact_force.norm());
    }
    JointResistance formula = subject.resistance;
    if (servo) formula.contact_duration = row.duration;
    const ContactOutcome predicted = servo ? jump(subject, formula, target, hand_N) : rigid;
    const PlantState& end = run.simulation.trace.back().state;
    const Eigen::VectorXd found = velocity(end.Omega, end.phidot) - x0;
    const auto difference = [&](const ContactOutcome& outcome) {
      const Eigen::VectorXd x = velocity(outcome.after.Omega, outcome.after.phidot) - x0;
      return energy_norm(found - x) / energy_norm(x);
    };
    row.velocity_error = difference(predicted);
    row.free_error = difference(bare);
    const double impulse = run.impulse_N.norm(), law = predicted.impulse.Fbar.norm();
    row.impulse_error = std::abs(impulse - law) / law;
    row.momentum_error = run.momentum_error;
    const Eigen::VectorXd x1 = velocity(end.Omega, end.phidot);
    const Vector3d& w = run.target_end.angular_velocity;
    row.kinetic_energy_after = 0.5 * x1.dot(H * x1) +
                               0.5 * plant.mass * run.target_end.velocity.squaredNorm() +
                               0.5 * w.dot(plant.inertia * w);
    rows.push_back(row);
  }
  return rows;
}

}  // namespace stillbase
