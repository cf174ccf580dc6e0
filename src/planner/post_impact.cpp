#include <stillbase/planner/post_impact.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <stdexcept>

#include <fmt/format.h>

#include <stillbase/core/constants.hpp>
#include <stillbase/encounter/encounter.hpp>
#include <stillbase/encounter/target_motion.hpp>
#include <stillbase/plan/feature.hpp>

#include "plan/exclusion_words.hpp"
#include "planner/capture_limits.hpp"
#include "planner/contact_case.hpp"

namespace stillbase {

namespace {

constexpr double kRounding = 1e-6;  ///< of a limit that is just kept

/// The words after its name, of the joint that is furthest beyond a limit; empty: none is.
std::string exceeded_joint_limit(const RobotModel& robot, const JointVectord& peaks,
                                 double Joint::*limit, double part, const char* words) {
  const Joint* exceeding = nullptr;
  double largest = part;
  for (int k = 0; k < robot.n(); ++k) {
    const Joint& joint = robot.joints[static_cast<std::size_t>(k)];
    if (!(peaks[k] > largest * (joint.*limit))) continue;
    exceeding = &joint;
    largest = peaks[k] / (joint.*limit);
  }
  return exceeding == nullptr ? "" : fmt::format("{}{}", exceeding->name, words);
}

bool is_grip_open(const GripSpec& grip, const SimulationSummary& summary) {
  const double most = 1 + kRounding;
  return summary.peak_grip_force > most * grip.force.value_or(kInfinity) ||
         summary.peak_grip_moment > most * grip.moment.value_or(kInfinity);
}

/// Of stops, attitude, joint rates and torques up to any instant; empty: none.
/// @param part of the limits but for the stops
std::string exceeded_limit(const CaptureProblem& problem, const SimulationSummary& summary,
                           double part = 1) {
  for (const LimitEvent& event : summary.limits) {
    if (event.kind == LimitKind::LowerStop || event.kind == LimitKind::UpperStop) {
      return problem.robot.joints[static_cast<std::size_t>(event.joint)].name + exclusion::kStop;
    }
  }
  if (summary.attitude_turned > part * problem.post_impact.attitude_change_max) {
    return exclusion::kAttitude;
  }
  std::string rate = exceeded_joint_limit(problem.robot, summary.peak_joint_rates,
                                          &Joint::max_velocity, part, exclusion::kRateLimit);
  if (!rate.empty()) return rate;
  // The plant gives no more than the limit, so what the controller asks for is judged.
  return exceeded_joint_limit(problem.robot, summary.peak_demanded_torques, &Joint::max_effort,
                              part, exclusion::kTorqueLimit);
}

/// As precise as limits are judged by.
SimulationOptions judging_options(const CaptureProblem& problem, const StopCondition& stop) {
  SimulationOptions options = plant_options_of(problem.post_impact, problem.robot);
  options.integrator = IntegratorKind::Dopri5;
  options.relative_tolerance = 1e-8;
  options.absolute_tolerance = 1e-10;
  options.output_period = problem.post_impact.horizon;
  options.stop = stop;
  return options;
}

/// Of a first run at fixed steps, less work than one whose error is controlled. Between
/// instants of sampled control, without friction, the plant moves smoothly, and both end their
/// steps there: they show the same extremes, but for what these numbers leave room for.
struct FirstRun {
  static constexpr double below = 0.99, beyond = 1.01;  ///< part of a limit
  static constexpr double off_stop = 1e-3;              ///< rad, m
  static constexpr double into_stop = 1e-3;             ///< rad/s, m/s: slower joints may turn back
  /// rad that base and joints move in a step: its part of the error of a velocity is a 24th of the
  /// square, 2e-5.
  static constexpr double step_angle = 0.02;
};

bool keeps_off_stops(const RobotModel& robot, const SimulationSummary& summary) {
  for (int k = 0; k < robot.n(); ++k) {
    const Joint& joint = robot.joints[static_cast<std::size_t>(k)];
    if (!(summary.lowest_positions[k] >= joint.lower + FirstRun::off_stop &&
          summary.highest_positions[k] <= joint.upper - FirstRun::off_stop)) {
      return false;
    }
  }
  return true;
}

bool meets_stop(const SimulationSummary& summary) {
  return std::any_of(summary.limits.begin(), summary.limits.end(), [](const LimitEvent& event) {
    return event.kind == LimitKind::LowerStop || event.kind == LimitKind::UpperStop;
  });
}

/// post_impact_failure() where the first run is certain of it; nothing: it is not.
/// @param grasp_use largest part of a limit of grip and wheels that a run uses
std::optional<std::string> failure_at_first_sight(
    const CaptureProblem& problem, const ContactCase& subject, const Controller& controller,
    const StopCondition& stop, const std::function<double(const AfterContact&)>& grasp_use) {
  const PostImpactSpec& spec = problem.post_impact;
  const bool is_smooth = spec.contact.model == ContactModel::Instantaneous &&
                         controller.kind != ControllerKind::Detumble && spec.control_period > 0 &&
                         !spec.joint_friction;
  if (!is_smooth) return std::nullopt;
  SimulationOptions options = judging_options(problem, stop);
  options.integrator = IntegratorKind::Midpoint;
  options.ends_when = [&](const SimulationSummary& so_far) {
    return is_grip_open(spec.grip, so_far) ||
           !exceeded_limit(problem, so_far, FirstRun::beyond).empty();
  };
  const AfterContact run = simulate_after_contact(subject, spec, controller, options);
  if (run.simulation.status != SimulationStatus::Finished) return std::nullopt;
  const SimulationSummary& summary = run.simulation.summary;
  const double rate = summary.peak_base_rate + summary.peak_joint_rate;
  if (!(rate * std::min(options.step, spec.control_period) <= FirstRun::step_angle)) {
    return std::nullopt;
  }
  if (grasp_use(run) > FirstRun::below || is_grip_open(spec.grip, summary)) return std::nullopt;
  if (meets_stop(summary) && !(summary.hardest_stop > FirstRun::into_stop)) return std::nullopt;
  std::string limit = exceeded_limit(problem, summary, FirstRun::beyond);
  if (!limit.empty()) return limit;
  const bool is_far = exceeded_limit(problem, summary, FirstRun::below).empty() &&
                      keeps_off_stops(problem.robot, summary);
  if (!is_far) return std::nullopt;
  const double part = summary.residual_base_rate / spec.residual_base_rate_max;
  if (part > FirstRun::beyond) return exclusion::kBaseRate;
  if (part > FirstRun::below) return std::nullopt;
  return "";
}

/// Half a period of the spring between both bodies is how long a contact lasts without damping.
/// A contact that is over long before the horizon is not what keeps them together there.
std::string endless_contact(const ContactCase& subject, const PostImpactSpec& spec,
                            ControllerKind kind) {
  constexpr double kSoft = 0.5;  // of the horizon: damping makes a contact longer
  const double mass = subject.impulse / ((1 + subject.restitution) * subject.closing_speed);
  const double duration = kPi * std::sqrt(mass / spec.contact.stiffness);
  const char* const cause =
      duration >= kSoft * spec.horizon ? "post_impact.contact.stiffness is too low"
      : kind == ControllerKind::None   ? "without a controller the hand stays against the target"
                                       : "the controller holds the hand against the target";
  return fmt::format(
      "{} of {:.4g} s: a contact of {:.4g} N/m between "
      "an effective {:.4g} kg lasts about {:.4g} s; {}",
      exclusion::kStillTouching, spec.horizon, spec.contact.stiffness, mass, duration, cause);
}

}  // namespace

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

std::optional<ManagedMomentum> managed_momentum(const CaptureProblem& problem,
                                                const Configuration& configuration,
                                                const ImpactSummary& impact,
                                                const StopCondition& stop) {
  if (!problem.target) return std::nullopt;
  const ContactCase subject = contact_case(problem, configuration, impact);
  std::optional<AfterContact> run;
  if (const auto controller = chosen_controller(problem.post_impact)) {
    run = simulate_after_contact(subject, problem.post_impact, *controller,
                                 judging_options(problem, stop));
    if (run->simulation.status != SimulationStatus::Finished) run.reset();
  }
  return account_for_momentum(problem, configuration, impact, subject, run ? &*run : nullptr);
}

std::string post_impact_failure(const CaptureProblem& problem, const Configuration& configuration,
                                const ImpactSummary& impact, const StopCondition& stop) {
  if (problem.post_impact.controllers.empty()) return "";
  return post_impact_failure(problem, encounter_model(at_feature(problem, configuration.feature)),
                             configuration, impact, stop);
}

std::string post_impact_failure(const Plan& plan, const StopCondition& stop) {
  if (plan.status == PlanStatus::Infeasible || !arrives(plan.approach)) return "";
  return post_impact_failure(plan.problem, plan.configuration, plan.impact, stop);
}

std::string post_impact_failure(const CaptureProblem& problem, const EncounterModel& model,
                                const Configuration& configuration, const ImpactSummary& impact,
                                const StopCondition& stop) {
  const PostImpactSpec& spec = problem.post_impact;
  if (spec.controllers.empty()) return "";
  const auto controller = chosen_controller(spec);
  if (!controller) return "no controller " + spec.controllers.front();
  const ContactCase subject = contact_case(problem, model, configuration, impact);
  // Full wheels and an open grip are causes of what else is exceeded then. What the wheels have to
  // take is known without a simulation.
  const auto demand_on_grasp = [&](const AfterContact* run) -> std::string {
    for (const LimitUse& use :
         account_for_momentum(problem, configuration, impact, subject, run).limits) {
      if (is_demand_on_grasp(use) && is_exceeded(use)) return limit_words(use);
    }
    return "";
  };
  if (std::string full = demand_on_grasp(nullptr); !full.empty()) return full;

  const auto grasp_use = [&](const AfterContact& run) {
    double most = 0;
    for (const LimitUse& use :
         account_for_momentum(problem, configuration, impact, subject, &run).limits) {
      if (is_demand_on_grasp(use)) most = std::max(most, use.part());
    }
    return most;
  };
  if (auto failure = failure_at_first_sight(problem, subject, *controller, stop, grasp_use)) {
    return *failure;
  }

  SimulationOptions options = judging_options(problem, stop);
  std::string broken;  // a limit, which nothing that follows makes hold again
  options.ends_when = [&](const SimulationSummary& so_far) {
    broken =
        is_grip_open(spec.grip, so_far) ? exclusion::kGripLoad : exceeded_limit(problem, so_far);
    return !broken.empty();
  };
  const AfterContact run = simulate_after_contact(subject, spec, *controller, options);
  const SimulationResult& result = run.simulation;
  const SimulationSummary& summary = result.summary;
  if (result.status != SimulationStatus::Finished) return to_string(result.status);
  const bool touches = run.encounter && run.encounter->contact.phase == ContactPhase::Touching;
  if (touches && broken.empty()) return endless_contact(subject, spec, controller->kind);
  if (std::string grasp = demand_on_grasp(&run); !grasp.empty()) {
    return broken.empty() ? grasp
                          : fmt::format("{} after {:.3g} s", grasp, result.trace.back().time);
  }
  // What is judged at the horizon says nothing of a run that ended before it.
  if (!broken.empty()) return broken;
  if (std::string limit = exceeded_limit(problem, summary); !limit.empty()) return limit;
  if (summary.residual_base_rate > spec.residual_base_rate_max) return exclusion::kBaseRate;
  // Rest is judged by whether it is reached, which no number of the account decides better.
  if (controller->kind == ControllerKind::Detumble && !summary.rest_time) {
    return exclusion::not_at_rest(spec.horizon);
  }
  return "";
}

}  // namespace stillbase
