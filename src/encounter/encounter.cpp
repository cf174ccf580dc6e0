#include <stillbase/encounter/encounter.hpp>

#include <stillbase/core/error.hpp>
#include <stillbase/encounter/target_motion.hpp>
#include <stillbase/impact/contact.hpp>
#include <stillbase/impact/gradient.hpp>
#include <stillbase/plan/feature.hpp>

#include "encounter/encounter_kernel.hpp"

namespace stillbase {

template TargetKinematics<double> target_kinematics(const EncounterModel&, const double&);
template ContactKinematics<double> contact_kinematics(const EncounterModel&, const Matrix3d&,
                                                      const TargetKinematics<double>&);
template ContactKinematics<double> contact_kinematics(const EncounterModel&, const Matrix3d&,
                                                      const double&);
template ContactRates<double> contact_rates(const EncounterModel&, const TargetKinematics<double>&,
                                            const ContactKinematics<double>&);
template Encounter<double> encounter_along(const EncounterModel&, const ContactKinematics<double>&,
                                           const Scenario&);
template TargetAtHand<double> target_at_hand(const EncounterModel&,
                                             const ContactKinematics<double>&, const Scenario&);
template TargetAtHandRates<double> target_at_hand_rates(const EncounterModel&,
                                                        const ContactKinematics<double>&,
                                                        const ContactRates<double>&,
                                                        const Scenario&);
template void set_rigid_contact(const EncounterModel&, const ContactKinematics<double>&,
                                const Scenario&, RigidContact<double>&);
template double closing_speed_rate(const EncounterModel&, const ContactKinematics<double>&,
                                   const ContactRates<double>&, const Scenario&);
template Matrix3d wanted_hand_axes(const EncounterModel&, const Matrix3d&, const Matrix3d&);

std::pair<Vector3d, Vector3d> tangent_basis(const Vector3d& n) {
  int smallest = 0;
  n.cwiseAbs().minCoeff(&smallest);
  const Vector3d u = n.cross(Vector3d(Vector3d::Unit(smallest))).normalized();
  return {u, n.cross(u)};
}

static MatchedPart matched_part(const HandMotionSpec& hand) {
  switch (hand.velocity) {
    case HandVelocity::Rest:
      return MatchedPart::None;
    case HandVelocity::MatchNormal:
      return MatchedPart::Normal;
    case HandVelocity::MatchLinear:
      return MatchedPart::Linear;
    case HandVelocity::MatchAll:
      return MatchedPart::All;
    case HandVelocity::Stated:
      break;
  }
  if (hand.linear && hand.angular) return MatchedPart::All;
  return hand.linear ? MatchedPart::Linear : MatchedPart::Angular;
}

EncounterModel encounter_model(const CaptureProblem& problem) {
  const auto refuse = [&problem](const std::string& rule, const std::string& message) {
    throw InputError({Finding{problem.source, 0, rule, message}});
  };
  const ImpulseSpec& impulse = problem.impulse;
  EncounterModel out;
  if (impulse.direction) {
    out.frame =
        impulse.direction_frame == Frame::Base ? ContactFrame::Base : ContactFrame::Inertial;
    out.n = *impulse.direction;
    if (impulse.source == ImpulseSource::RigidBody) {
      refuse("impulse-source",
             "impact.direction: the source rigid_body takes its direction from the contact "
             "feature; leave "
             "it out");
    }
  } else {
    if (!problem.target || problem.variables.feature.empty()) {
      refuse("impulse-direction",
             "impact.direction: without it a target with a contact feature is needed");
    }
    out.frame = ContactFrame::Target;
    out.n = chosen_feature(problem).normal;
    out.r = chosen_feature(problem).point;
    out.motion = encounter_motion(problem, Vector3d::Zero(), problem.base.orientation, 0);
    out.first_state = out.motion->state(problem.variables.contact_time_lower);
  }
  std::tie(out.u, out.v) = tangent_basis(out.n);

  out.source = impulse.source;
  out.law = impulse.contact;
  out.magnitude = impulse.magnitude;
  out.restitution = impulse.restitution;
  out.closing_speed = impulse.closing_speed;
  if (out.magnitude_is_given()) out.moment = impulse.moment / impulse.magnitude;
  if (problem.target) {
    out.target_mass = problem.target->mass;
    out.target_inertia = problem.target->inertia;
    out.target_inverse_inertia = problem.target->inverse_inertia();
  }

  const HandMotionSpec& motion = problem.hand_motion;
  if (motion.moves() && (!out.is_rigid_contact() || !out.follows_target() || !out.is_rigid())) {
    refuse("hand-velocity",
           "contact.hand_velocity: needs the contact 'sticking' or 'latch' with a predicted rigid "
           "body");
  }
  out.matched = matched_part(motion);
  out.arrival_rates = motion.rates;
  out.apart << motion.linear.value_or(Vector3d::Zero()), motion.angular.value_or(Vector3d::Zero());

  const HandSpec& hand = problem.hand;
  out.hand_point = hand.position;
  if (hand.orientation) out.stated_hand_axes = hand.orientation->toRotationMatrix();
  out.hand_frame = hand.frame;
  out.hand_axes = rotation_exp(out.n * hand.roll).toRotationMatrix() *
                  rotation_between(hand.approach_axis, -out.n).toRotationMatrix();
  out.approach_axis = hand.approach_axis;
  return out;
}

Scenario nominal_scenario(const EncounterModel& model) {
  Scenario out;
  out.direction = model.n;
  out.restitution = model.restitution;
  return out;
}

Configuration start_configuration(const CaptureProblem& problem) {
  Configuration out;
  out.phi = problem.start;
  out.base = problem.base;
  out.contact_time = problem.variables.contact_time_lower;
  return out;
}

Encounter<double> encounter_at(const EncounterModel& model, const Configuration& configuration) {
  const Matrix3d R_NB = configuration.base.orientation.toRotationMatrix();
  const auto contact = contact_kinematics<double>(model, R_NB, configuration.contact_time);
  return encounter_along<double>(model, contact, nominal_scenario(model));
}

TargetPlacement target_placement(const CaptureProblem& problem, const EncounterModel& model) {
  if (model.follows_target()) return {Matrix3d::Identity(), model.r};
  // The contact at the origin of N.
  const auto motion = encounter_motion(problem, Vector3d::Zero(), problem.base.orientation, 0);
  const TargetState state = motion->state(0);
  const Matrix3d R_NT = state.pose.orientation.toRotationMatrix();
  const Matrix3d R_BN = problem.base.orientation.conjugate().toRotationMatrix();
  return {model.frame == ContactFrame::Base ? Matrix3d(R_BN * R_NT) : R_NT,
          -(R_NT.transpose() * state.pose.position)};
}

void add_target_inverse_inertia(const EncounterModel& model,
                                const ContactKinematics<double>& contact, Matrix3d& W) {
  if (model.magnitude_is_given()) return;
  if (model.is_rigid()) {
    const Matrix3d R_BE = contact.R_EB.transpose();
    const Matrix3d inverse = R_BE * model.target_inverse_inertia * contact.R_EB;
    const Matrix3d lever = skew<double>(R_BE * model.r);
    W += lever.transpose() * inverse * lever;
  }
  W.diagonal().array() += 1 / model.target_mass;
}

double impulse_magnitude(const EncounterModel& model, const Encounter<double>& encounter,
                         double hand_inverse_mass) {
  if (model.magnitude_is_given()) return model.magnitude;
  return normal_impulse(model.restitution, encounter.closing_speed, hand_inverse_mass,
                        encounter.target_inverse_mass);
}

ImpactSummary impact_at(const CaptureProblem& problem, const Configuration& configuration) {
  const std::string& feature = configuration.feature;
  const bool is_chosen = feature.empty() || feature == problem.variables.feature;
  const EncounterModel model =
      is_chosen ? encounter_model(problem) : encounter_model(at_feature(problem, feature));
  return impact_at(problem, model, encounter_at(model, configuration), configuration.phi);
}

ImpactSummary impact_at(const CaptureProblem& problem, const EncounterModel& model,
                        const Encounter<double>& encounter, const JointVectord& phi) {
  if (model.is_rigid_contact()) {
    RigidContact<double> contact;
    set_rigid_contact<double>(model, encounter.contact, nominal_scenario(model), contact);
    const auto summary = [&] {
      return summarize_contact(problem.robot, phi, problem.resistance, contact,
                               encounter.closing_speed);
    };
    const auto exchange_nothing = [&contact] {
      contact.target.velocity.setZero();
      contact.target.omega.setZero();
      contact.matched = MatchedPart::None;
    };
    // That of a hand at rest. One that moves along has been told what it leaves.
    if (!model.hand_moves() && !(encounter.closing_speed > 0)) exchange_nothing();
    const ImpactSummary impact = summary();
    const bool pulls =
        model.law == ContactLaw::Sticking && impact.Fbar.head<3>().dot(encounter.F.head<3>()) < 0;
    if (!pulls) return impact;
    exchange_nothing();
    return summary();
  }
  const ImpactResistance resistance = prepare_resistance(problem.resistance, problem.robot.n());
  const auto posture = evaluate_posture<double>(problem.robot, resistance, phi);
  const auto response = respond<double>(posture, encounter.F);
  const double p = impulse_magnitude(model, encounter, response.hand_inverse_mass);
  return summarize_impact(problem.robot, phi, problem.resistance, p * encounter.F,
                          encounter.closing_speed);
}

}  // namespace stillbase
