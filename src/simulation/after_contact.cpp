#include <stillbase/simulation/after_contact.hpp>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <stillbase/core/constants.hpp>
#include <stillbase/core/rotation.hpp>

namespace stillbase {
namespace {

constexpr double kHorizonsAfter = 10;  ///< that the joints are followed for
constexpr double kNoTravel = 1e-3;     ///< rad (m) over these: joints that rest

Vector3d hand_of(const ContactCase& subject) {
  return subject.before.base * compute_kinematics(subject.robot, subject.before.phi).r_bh;
}

/// Whether the hand moves before the contact.
bool moves(const ContactCase& subject) { return !subject.before.phidot.isZero(0); }

/// The instantaneous impact of the case by a contact law.
ContactOutcome apply_law(const ContactCase& subject, ContactLaw law,
                         const JointResistance& resistance) {
  const PlantState& before = subject.before;
  const TargetAtContact& target = *subject.target;
  const Eigen::Quaterniond R_BN = before.base.orientation.conjugate();
  const Eigen::Quaterniond q_BT = R_BN * target.state.pose.orientation;
  const Matrix3d R_BT = q_BT.toRotationMatrix();
  ContactTarget body;  // in B
  body.mass = target.body.mass;
  body.inertia = R_BT * target.body.inertia * R_BT.transpose();
  body.r = R_BN * Vector3d(hand_of(subject) - target.state.pose.position);
  body.velocity = R_BN * target.state.velocity;
  body.angular_velocity = q_BT * target.state.angular_velocity;
  Contact contact;
  contact.law = law;
  if (law != ContactLaw::Latch) contact.restitution = subject.restitution;
  contact.is_grasped = law == ContactLaw::Latch && moves(subject);
  contact.n = R_BN * subject.normal_N;
  return apply_contact(subject.robot, before.phi, before.Omega, before.phidot, resistance, contact,
                       body);
}

/// @param damping empty: leaves the case's restitution
EncounterPlant compliant_plant(const ContactCase& subject, double stiffness,
                               const std::optional<double>& damping, double friction,
                               double effective_mass) {
  const TargetAtContact& target = *subject.target;
  const Eigen::Quaterniond R_TN = target.state.pose.orientation.conjugate();
  EncounterPlant plant;
  plant.mass = target.body.mass;
  plant.inertia = target.body.inertia;
  plant.contact.stiffness = stiffness;
  plant.contact.damping =
      damping ? *damping : contact_damping(subject.restitution, stiffness, effective_mass);
  plant.contact.friction = friction;
  plant.contact.point = R_TN * Vector3d(hand_of(subject) - target.state.pose.position);
  plant.contact.normal = R_TN * subject.normal_N;
  if (subject.resistance.model == ResistanceModel::Servo) {
    plant.servo = {subject.resistance.stiffness, subject.resistance.damping};
    plant.servo_posture = subject.before.phi;
  }
  return plant;
}

/// The run after a latch, and in `result` what is known without it.
PostImpactRun run_after_latch(const ContactCase& subject, const PostImpactSpec& spec,
                              SimulationOptions options, AfterContact& result) {
  const LatchedRobot latched = latch_target(subject);
  result.robot = latched.robot;
  result.is_held = latched.impulse.status == ContactStatus::Hit;
  result.latch_impulse = latched.impulse.Fbar;
  if (result.is_held) {
    options.grasp.target = HeldTarget{subject.target->body, latched.hand_target};
  }
  // The controller's model has the target scaled by `target_mass_scale`.
  const bool knows_another = subject.known_target || spec.model.target_mass_scale != 1;
  if (result.is_held && (options.controller_robot || knows_another)) {
    RobotModel known = options.controller_robot.value_or(subject.robot);
    TargetBody body = subject.known_target.value_or(subject.target->body);
    body.mass *= spec.model.target_mass_scale;
    body.inertia *= spec.model.target_mass_scale;
    if (spec.model.target_mass_scale > 0) {
      known = attach_target(known, body, latched.hand_target);
    }
    options.controller_robot = known;
    options.grasp.known = HeldTarget{body, latched.hand_target};
  }
  return {latched.robot, subject.resistance, latched.state, std::move(options)};
}

AfterContact through_compliant_contact(const ContactCase& subject, const ContactSpec& contact,
                                       const Controller& controller, SimulationOptions options) {
  const double effective_mass =
      subject.impulse / ((1 + subject.restitution) * subject.closing_speed);
  const EncounterPlant plant = compliant_plant(subject, contact.stiffness, contact.damping,
                                               contact.friction, effective_mass);

  const double lead = std::min(options.control_period, 0.01);
  TargetPlantState start = subject.target->state;
  start.pose.position -= lead * start.velocity;
  const Vector3d rotation = -lead * start.angular_velocity;
  start.pose.orientation =
      (start.pose.orientation * Eigen::Quaterniond(rotation_exp(rotation))).normalized();
  options.start_time = -lead;
  options.horizon += lead;
  AfterContact result;
  result.robot = subject.robot;
  result.encounter = simulate_encounter(subject.robot, subject.resistance, subject.before, start,
                                        plant, controller, options);
  result.encounter->separation_speed = result.encounter->contact.first_separation_speed;
  result.simulation = std::move(result.encounter->simulation);
  return result;
}

/// Generalised velocity [Omega; phidot].
Eigen::VectorXd velocity(const Vector6d& Omega, const JointVectord& phidot) {
  Eigen::VectorXd x(6 + phidot.size());
  x << Omega, phidot;
  return x;
}

}  // namespace

LatchedRobot latch_target(const ContactCase& subject) {
  const PlantState& before = subject.before;
  const TargetAtContact& target = *subject.target;
  const Kinematics<double> kinematics = compute_kinematics(subject.robot, before.phi);
  const Pose hand_N = before.base * Pose{kinematics.r_bh, Eigen::Quaterniond(kinematics.R_hand)};
  const ContactOutcome outcome = apply_law(subject, ContactLaw::Latch, subject.resistance);
  const Pose hand_target = hand_N.inverse() * target.state.pose;
  LatchedRobot latched{subject.robot, before, hand_target, outcome.impulse};
  if (outcome.impulse.status != ContactStatus::Hit) return latched;
  latched.robot = attach_target(subject.robot, target.body, hand_target);
  latched.state.Omega = outcome.after.Omega;
  latched.state.phidot = outcome.after.phidot;
  const Vector3d shift = base_shift(subject.robot, target.body, hand_target);
  latched.state.base.position += before.base.orientation * shift;
  latched.state.Omega.head<3>() += Vector3d(outcome.after.Omega.tail<3>()).cross(shift);
  return latched;
}

bool is_in_contact(const ContactCase& subject) {
  // A hand that moves with the target is held by a latch that gives no impulse, whichever way the
  // target moves.
  const bool is_grasp = subject.law == ContactLaw::Latch && moves(subject);
  return is_grasp || (subject.impulse > 0 && subject.closing_speed > 0);
}

namespace {

/// The run of a case whose contact takes no time, and in `result` what is known without it; of
/// another case that is all, and there is no run.
std::optional<PostImpactRun> prepare(const ContactCase& subject, const PostImpactSpec& spec,
                                     const Controller& controller, const SimulationOptions& options,
                                     AfterContact& result) {
  const bool is_contact = is_in_contact(subject);
  const bool is_compliant = spec.contact.model == ContactModel::Compliant;
  const bool is_latch = subject.law == ContactLaw::Latch;
  if ((is_compliant || is_latch) && !subject.target) {
    throw std::invalid_argument("this contact needs a target");
  }
  if (is_compliant && subject.law != ContactLaw::Frictionless) {
    throw std::invalid_argument("a compliant contact neither sticks nor latches");
  }
  if (is_contact && is_latch) return run_after_latch(subject, spec, options, result);
  if (is_contact && is_compliant) {
    result = through_compliant_contact(subject, spec.contact, controller, options);
    return std::nullopt;
  }
  result.robot = subject.robot;
  return PostImpactRun{subject.robot, subject.resistance, subject.after, options};
}

}  // namespace

AfterContact simulate_after_contact(const ContactCase& subject, const PostImpactSpec& spec,
                                    const Controller& controller,
                                    const SimulationOptions& options) {
  AfterContact result;
  if (const auto run = prepare(subject, spec, controller, options, result)) {
    result.simulation =
        simulate_post_impact(run->robot, run->resistance, run->initial, controller, run->options);
  }
  return result;
}

std::vector<AfterContact> simulate_after_contacts(const std::vector<ContactCase>& subjects,
                                                  const PostImpactSpec& spec,
                                                  const Controller& controller,
                                                  const std::vector<SimulationOptions>& options) {
  if (options.size() != subjects.size()) throw std::invalid_argument("one per case: options");
  std::vector<AfterContact> results(subjects.size());
  std::vector<PostImpactRun> runs;
  std::vector<std::size_t> places;
  for (std::size_t i = 0; i < subjects.size(); ++i) {
    auto run = prepare(subjects[i], spec, controller, options[i], results[i]);
    if (!run) continue;
    runs.push_back(std::move(*run));
    places.push_back(i);
  }
  std::vector<SimulationResult> found = simulate_post_impacts(runs, controller);
  for (std::size_t k = 0; k < places.size(); ++k) {
    results[places[k]].simulation = std::move(found[k]);
  }
  return results;
}

namespace {

/// Whether what follows an instant of a run depends on the state at that instant alone.
bool is_without_memory(const PostImpactSpec& spec, const Controller& controller,
                       const SimulationOptions& options) {
  const bool counts_time =
      controller.kind == ControllerKind::RnsHandback || controller.kind == ControllerKind::Detumble;
  return spec.contact.model == ContactModel::Instantaneous && !counts_time &&
         options.sensors.are_exact() && !options.friction && !options.base_wrench;
}

}  // namespace

std::optional<AfterHorizon> look_beyond_horizon(const ContactCase& subject,
                                                const PostImpactSpec& spec,
                                                const Controller& controller,
                                                const SimulationOptions& options,
                                                const AfterContact& run) {
  if (run.simulation.status != SimulationStatus::Finished) return std::nullopt;
  const JointVectord& phidot = run.simulation.trace.back().state.phidot;
  AfterHorizon out;
  out.joint_rate = phidot.norm();
  out.moves = phidot.size() > 0 &&
              phidot.cwiseAbs().maxCoeff() * kHorizonsAfter * options.horizon > kNoTravel;
  const auto state_first_stop = [&out](const AfterContact& after) {
    for (const LimitEvent& event : after.simulation.summary.limits) {
      if (event.kind != LimitKind::LowerStop && event.kind != LimitKind::UpperStop) continue;
      out.stop_time = event.time;
      out.joint = after.robot.joints[static_cast<std::size_t>(event.joint)].name;
      return;
    }
  };
  state_first_stop(run);  // joints may rest at stops
  if (out.stop_time || !out.moves) return out;
  SimulationOptions longer = options;
  longer.horizon = kHorizonsAfter * options.horizon;
  longer.output_period = 0;
  longer.joint_stops = true;
  longer.ends_at_stop = true;
  // Where control bounds the steps anyway, fixed ones take half the time.
  const bool is_smooth = spec.contact.model == ContactModel::Instantaneous && !longer.friction;
  if (is_smooth && longer.control_period > 0 && longer.control_period <= longer.step) {
    longer.integrator = IntegratorKind::Rk4;
  }
  AfterContact after;
  std::optional<PostImpactRun> rest;  // from the horizon on
  if (is_without_memory(spec, controller, options)) {
    rest = prepare(subject, spec, controller, longer, after);
  }
  if (rest) {
    rest->initial = run.simulation.trace.back().state;
    rest->options.horizon -= options.horizon;
    after.simulation = simulate_post_impact(rest->robot, rest->resistance, rest->initial,
                                            controller, rest->options);
  } else {
    after = simulate_after_contact(subject, spec, controller, longer);
  }
  if (after.simulation.status != SimulationStatus::Finished) return std::nullopt;
  state_first_stop(after);
  if (rest && out.stop_time) *out.stop_time += options.horizon;
  return out;
}

std::vector<ModelCheckRow> check_stiffness(const ContactCase& subject, double friction,
                                           const std::vector<double>& stiffness,
                                           const StopCondition& stop) {
  const RobotModel& robot = subject.robot;
  const JointResistance& resistance = subject.resistance;
  const bool servo = resistance.model == ResistanceModel::Servo;
  if (resistance.model == ResistanceModel::Locked) {
    throw std::invalid_argument("a compliant contact does not take locked joints");
  }
  const JointVectord rotors = added_plant_inertia(resistance, robot.n());
  const InertiaMatrices<double> inertia = PlantTerms(robot, rotors, subject.before).inertia;
  Eigen::MatrixXd H(6 + robot.n(), 6 + robot.n());
  H << inertia.H_b, inertia.H_bphi, inertia.H_bphi.transpose(), inertia.H_phi;
  const Eigen::VectorXd x0 = velocity(subject.before.Omega, subject.before.phidot);
  const auto energy_norm = [&](const Eigen::VectorXd& x) { return std::sqrt(x.dot(H * x)); };

  const JointResistance without_servo = servo ? JointResistance{} : resistance;
  const ContactOutcome rigid = apply_law(subject, ContactLaw::Frictionless, without_servo);
  if (rigid.impulse.status != ContactStatus::Hit) {
    throw std::invalid_argument("hand and target do not close in");
  }
  const ContactOutcome bare = apply_law(subject, ContactLaw::Frictionless, {});
  const double effective_mass =
      rigid.impulse.Fbar.norm() / ((1 + subject.restitution) * rigid.impulse.closing_speed);

  std::vector<ModelCheckRow> rows;
  for (const double k : stiffness) {
    EncounterPlant plant = compliant_plant(subject, k, std::nullopt, friction, effective_mass);
    plant.end_with_contact = true;
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
    const EncounterResult run = simulate_encounter(
        robot, without_servo, subject.before, subject.target->state, plant, Controller{}, options);

    ModelCheckRow row;
    row.stiffness = k;
    row.ended = run.simulation.status == SimulationStatus::Finished && run.contact.contacts > 0 &&
                run.contact.phase != ContactPhase::Touching;
    row.duration = run.contact.first_end - run.contact.first_begin;
    for (const TraceSample& sample : run.simulation.trace) {
      row.peak_force = std::max(row.peak_force, sample.contact_force.norm());
    }
    JointResistance formula = resistance;
    if (servo) formula.contact_duration = row.duration;
    const ContactOutcome jump =
        servo ? apply_law(subject, ContactLaw::Frictionless, formula) : rigid;
    const PlantState& end = run.simulation.trace.back().state;
    const Eigen::VectorXd found = velocity(end.Omega, end.phidot) - x0;
    const auto difference = [&](const ContactOutcome& outcome) {
      const Eigen::VectorXd x = velocity(outcome.after.Omega, outcome.after.phidot) - x0;
      return energy_norm(found - x) / energy_norm(x);
    };
    row.velocity_error = difference(jump);
    row.free_error = difference(bare);
    const double impulse = run.impulse_N.norm(), law = jump.impulse.Fbar.norm();
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
