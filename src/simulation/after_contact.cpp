#include <stillbase/simulation/after_contact.hpp>

#include <algorithm>
#include <stdexcept>

#include <stillbase/core/rotation.hpp>

namespace stillbase {
namespace {

AfterContact after_latch(const ContactCase& subject, const ContactChoice& choice,
                         const Controller& controller, SimulationOptions options) {
  const LatchedRobot latched =
      latch_target(subject.robot, subject.resistance, subject.before, subject.target->body,
                   subject.target->state, subject.normal_N);
  AfterContact result;
  result.robot = latched.robot;
  result.is_held = latched.impulse.status == ContactStatus::Hit;
  result.latch_impulse = latched.impulse.Fbar;
  // The controller knows the target as `target_scale` states it.
  if (result.is_held && (options.controller_robot || choice.target_scale != 1)) {
    RobotModel known = options.controller_robot.value_or(subject.robot);
    if (choice.target_scale > 0) {
      TargetBody body = subject.target->body;
      body.mass *= choice.target_scale;
      body.inertia *= choice.target_scale;
      known = attach_target(known, body, latched.hand_target);
    }
    options.controller_robot = known;
  }
  result.simulation =
      simulate_post_impact(latched.robot, subject.resistance, latched.state, controller, options);
  return result;
}

AfterContact through_compliant_contact(const ContactCase& subject, const ContactChoice& choice,
                                       const Controller& controller, SimulationOptions options) {
  const MetTarget& target = *subject.target;
  const double effective_mass =
      subject.impulse / ((1 + subject.restitution) * subject.closing_speed);
  EncounterPlant plant;
  plant.mass = target.body.mass;
  plant.inertia = target.body.inertia;
  plant.contact.stiffness = choice.stiffness;
  plant.contact.damping =
      choice.damping ? *choice.damping
                     : contact_damping(subject.restitution, choice.stiffness, effective_mass);
  plant.contact.friction = choice.friction;
  const Kinematics<double> kinematics = compute_kinematics(subject.robot, subject.before.phi);
  const Vector3d hand_N = subject.before.base * kinematics.r_bh;
  const Eigen::Quaterniond R_TN = target.state.pose.orientation.conjugate();
  plant.contact.point = R_TN * Vector3d(hand_N - target.state.pose.position);
  plant.contact.normal = R_TN * subject.normal_N;
  if (subject.resistance.model == ResistanceModel::Servo) {
    plant.servo = {subject.resistance.stiffness, subject.resistance.damping};
    plant.servo_posture = subject.before.phi;
  }

  const double lead = std::min(options.control_period, 0.01);
  TargetPlantState start = target.state;
  start.pose.position -= lead * start.velocity;
  const Vector3d turn = -lead * start.angular_velocity;
  start.pose.orientation =
      (start.pose.orientation * Eigen::Quaterniond(rotation_exp(turn))).normalized();
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

}  // namespace

AfterContact simulate_after_contact(const ContactCase& subject, const ContactChoice& choice,
                                    const Controller& controller,
                                    const SimulationOptions& options) {
  const bool is_contact = subject.impulse > 0 && subject.closing_speed > 0;
  if (choice.model != ContactModel::Jump && !subject.target) {
    throw std::invalid_argument("this model of the contact needs a target");
  }
  if (is_contact && choice.model == ContactModel::Latch) {
    return after_latch(subject, choice, controller, options);
  }
  if (is_contact && choice.model == ContactModel::Compliant) {
    return through_compliant_contact(subject, choice, controller, options);
  }
  AfterContact result;
  result.robot = subject.robot;
  result.simulation =
      simulate_post_impact(subject.robot, subject.resistance, subject.after, controller, options);
  return result;
}

}  // namespace stillbase
