#include <stillbase/planner/post_impact.hpp>

#include <optional>
#include <stdexcept>

#include <fmt/format.h>

#include <stillbase/core/constants.hpp>
#include <stillbase/encounter/encounter.hpp>
#include <stillbase/encounter/target_motion.hpp>
#include <stillbase/plan/feature.hpp>

#include "planner/after_impact.hpp"
#include "planner/capture_limits.hpp"
#include "planner/contact_case.hpp"

namespace stillbase {

ContactCase contact_case(const CaptureProblem& problem, const Configuration& configuration,
                         const ImpactSummary& impact) {
  return contact_case(problem, encounter_model(at_feature(problem, configuration.feature)),
                      configuration, impact);
}

ContactCase contact_case(const CaptureProblem& problem, const EncounterModel& model,
                         const Configuration& configuration, const ImpactSummary& impact) {
  const Eigen::Quaterniond& R_NB = configuration.base.orientation;
  ContactCase subject;
  subject.robot = problem.robot;
  subject.resistance = problem.resistance;
  subject.before = state_at_rest(configuration.base, configuration.phi);
  subject.before.wheel_momentum = problem.post_impact.wheels.preset;
  if (impact.before) {
    subject.before.Omega = impact.before->Omega;
    subject.before.phidot = impact.before->phidot;
  }
  subject.after =
      state_after_impact(problem.robot, problem.resistance, subject.before, impact.Fbar);
  const Vector3d f = impact.Fbar.head<3>();
  subject.impulse = f.norm();
  subject.closing_speed = impact.closing_speed;
  subject.law = problem.impulse.contact;
  subject.restitution = problem.impulse.restitution;
  if (subject.law != ContactLaw::Frictionless) {
    subject.normal_N = R_NB * Vector3d(encounter_at(model, configuration).F.head<3>());
  } else if (subject.impulse > 0) {
    subject.normal_N = R_NB * (f / subject.impulse);
  }

  const auto state = model.follows_target()
                         ? target_at_contact(problem, model.motion, configuration)
                         : target_at_contact(problem, configuration);
  if (!state || problem.impulse.source == ImpulseSource::Given) return subject;
  TargetAtContact target{*problem.target, {}};
  if (problem.impulse.source == ImpulseSource::PointMass) target.body.inertia.setZero();
  target.state.pose = state->pose;
  target.state.velocity = state->linear_velocity;
  target.state.angular_velocity = state->pose.orientation.conjugate() * state->angular_velocity;
  subject.target = target;
  return subject;
}

AfterContact simulate_post_impact(const CaptureProblem& problem, const Configuration& configuration,
                                  const ImpactSummary& impact, const std::string& name,
                                  const StopCondition& stop) {
  const PostImpactSpec& spec = problem.post_impact;
  const auto controller = controller_of(spec, name);
  if (!controller) {
    throw std::invalid_argument(fmt::format("controller {}: unknown; there are {}", name,
                                            fmt::join(controller_names(), ", ")));
  }
  SimulationOptions options = plant_options_of(spec, problem.robot);
  options.integrator = IntegratorKind::Fehlberg78;
  options.stop = stop;
  return simulate_after_contact(contact_case(problem, configuration, impact), spec, *controller,
                                options);
}

std::optional<AfterHorizon> motion_after_horizon(const CaptureProblem& problem,
                                                 const Configuration& configuration,
                                                 const ImpactSummary& impact,
                                                 const std::string& name,
                                                 const StopCondition& stop) {
  const PostImpactSpec& spec = problem.post_impact;
  const auto controller = controller_of(spec, name);
  if (!controller) return std::nullopt;
  const SimulationOptions options = judging_options(problem, stop);
  const ContactCase subject = contact_case(problem, configuration, impact);
  const AfterContact run = simulate_after_contact(subject, spec, *controller, options);
  return look_beyond_horizon(subject, spec, *controller, options, run);
}

AfterImpactAccount account_after_impact(const CaptureProblem& problem,
                                        const Configuration& configuration,
                                        const ImpactSummary& impact, const StopCondition& stop) {
  const PostImpactSpec& spec = problem.post_impact;
  const ContactCase subject = contact_case(problem, configuration, impact);
  AfterImpactAccount out;
  std::optional<AfterContact> run;
  if (const auto controller = chosen_controller(spec)) {
    const SimulationOptions options = judging_options(problem, stop);
    run = motion_to_horizon(problem, subject, *controller, stop);
    out.motion = look_beyond_horizon(subject, spec, *controller, options, *run);
    if (run->simulation.status != SimulationStatus::Finished) run.reset();
  }
  if (problem.target) {
    out.momentum =
        account_for_momentum(problem, configuration, impact, subject, run ? &*run : nullptr);
  }
  return out;
}

}  // namespace stillbase
