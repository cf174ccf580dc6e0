#include "planner/after_impact.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include <stillbase/core/constants.hpp>
#include <stillbase/plan/feature.hpp>
#include <stillbase/planner/post_impact.hpp>

#include "plan/exclusion_words.hpp"
#include "planner/capture_limits.hpp"
#include "planner/contact_case.hpp"

namespace stillbase {

SimulationOptions judging_options(const CaptureProblem& problem, const StopCondition& stop) {
  SimulationOptions options = plant_options_of(problem.post_impact, problem.robot);
  options.integrator = IntegratorKind::Dopri5;
  options.relative_tolerance = 1e-8;
  options.absolute_tolerance = 1e-10;
  options.output_period = problem.post_impact.horizon;
  options.stop = stop;
  return options;
}

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

/// Of a first run at fixed steps, less work than one whose error is controlled. Between
/// instants of sampled control, without friction, the plant moves smoothly, and both end their
/// steps there: they show the same extremes, but for what these numbers leave room for.
struct FirstRun {
  static constexpr double longest_step = 0.01;          ///< s
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

/// Whether fixed steps between instants of control may show what happens.
bool is_smooth(const PostImpactSpec& spec, const Controller& controller) {
  return spec.contact.model == ContactModel::Instantaneous &&
         controller.kind != ControllerKind::Detumble && spec.control_period > 0 &&
         !spec.joint_friction;
}

/// Of base and joints together, at most, from one instant of control to the next.
double largest_step_angle(const PostImpactSpec& spec, const SimulationSummary& summary) {
  const double rate = summary.peak_base_rate + summary.peak_joint_rate;
  return rate * std::min(FirstRun::longest_step, spec.control_period);
}

bool meets_stop(const SimulationSummary& summary) {
  return std::any_of(summary.limits.begin(), summary.limits.end(), [](const LimitEvent& event) {
    return event.kind == LimitKind::LowerStop || event.kind == LimitKind::UpperStop;
  });
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

/// A run to its last digits but eight. Where control ends the steps anyway they are fixed: over the
/// angle of a first run a step of order 4 is off by 3e-11 of a velocity, and takes four
/// derivatives, an adaptive one seven.
/// @param options as judging_options(), for the adaptive one
AfterContact accurate_run(const PostImpactSpec& spec, const ContactCase& subject,
                          const Controller& controller, const SimulationOptions& options) {
  if (is_smooth(spec, controller)) {
    SimulationOptions fixed = options;
    fixed.integrator = IntegratorKind::Rk4;
    fixed.step = FirstRun::longest_step;
    AfterContact run = simulate_after_contact(subject, spec, controller, fixed);
    const SimulationSummary& summary = run.simulation.summary;
    const bool is_finished = run.simulation.status == SimulationStatus::Finished;
    const bool is_slow = largest_step_angle(spec, summary) <= FirstRun::step_angle;
    if ((is_finished && is_slow) || options.stop.reached()) return run;
  }
  return simulate_after_contact(subject, spec, controller, options);
}

/// The time after the impact in one configuration.
class AfterImpact {
 public:
  /// All but `subject` outlive this.
  AfterImpact(const CaptureProblem& problem, const Configuration& configuration,
              const ImpactSummary& impact, const Controller& controller, ContactCase subject)
      : problem_(problem),
        spec_(problem.post_impact),
        configuration_(configuration),
        impact_(impact),
        controller_(controller),
        subject_(std::move(subject)) {}

  const ContactCase& subject() const { return subject_; }

  /// The first limit of grip and wheels that is exceeded; empty: none. Full wheels and an open grip
  /// are causes of what else is exceeded then.
  /// @param run null: what the wheels have to take is known without a simulation
  std::string exceeded_grasp(const AfterContact* run) const {
    for (const LimitUse& use : uses(run)) {
      if (is_demand_on_grasp(use) && is_exceeded(use)) return limit_words(use);
    }
    return "";
  }

  /// This outlives the options.
  SimulationOptions first_run_options(const StopCondition& stop) const {
    SimulationOptions options = judging_options(problem_, stop);
    options.integrator = IntegratorKind::Midpoint;
    options.step = FirstRun::longest_step;
    options.ends_when = [this](const SimulationSummary& so_far) {
      return is_grip_open(spec_.grip, so_far) ||
             !exceeded_limit(problem_, so_far, FirstRun::beyond).empty();
    };
    return options;
  }
  /// The failure where the first run is certain of it; nothing: it is not.
  std::optional<std::string> failure_at_first_sight(const AfterContact& run) const {
    if (run.simulation.status != SimulationStatus::Finished) return std::nullopt;
    const SimulationSummary& summary = run.simulation.summary;
    if (!(largest_step_angle(spec_, summary) <= FirstRun::step_angle)) return std::nullopt;
    if (grasp_use(run) > FirstRun::below || is_grip_open(spec_.grip, summary)) return std::nullopt;
    if (meets_stop(summary) && !(summary.hardest_stop > FirstRun::into_stop)) return std::nullopt;
    std::string limit = exceeded_limit(problem_, summary, FirstRun::beyond);
    if (!limit.empty()) return limit;
    const bool is_far = exceeded_limit(problem_, summary, FirstRun::below).empty() &&
                        keeps_off_stops(problem_.robot, summary);
    if (!is_far) return std::nullopt;
    const double part = summary.residual_base_rate / spec_.residual_base_rate_max;
    if (part > FirstRun::beyond) return exclusion::kBaseRate;
    if (part > FirstRun::below) return std::nullopt;
    return "";
  }

  /// The failure by an accurate run.
  std::string failure(const StopCondition& stop) const {
    SimulationOptions options = judging_options(problem_, stop);
    std::string broken;  // a limit, which nothing that follows makes hold again
    options.ends_when = [&](const SimulationSummary& so_far) {
      broken = is_grip_open(spec_.grip, so_far) ? exclusion::kGripLoad
                                                : exceeded_limit(problem_, so_far);
      return !broken.empty();
    };
    const AfterContact run = accurate_run(spec_, subject_, controller_, options);
    const SimulationResult& result = run.simulation;
    const SimulationSummary& summary = result.summary;
    if (stop.reached()) return exclusion::kNotJudged;
    if (result.status != SimulationStatus::Finished) return to_string(result.status);
    const bool touches = run.encounter && run.encounter->contact.phase == ContactPhase::Touching;
    if (touches && broken.empty()) return endless_contact(subject_, spec_, controller_.kind);
    if (std::string grasp = exceeded_grasp(&run); !grasp.empty()) {
      return broken.empty() ? grasp
                            : fmt::format("{} after {:.3g} s", grasp, result.trace.back().time);
    }
    // What is judged at the horizon says nothing of a run that ended before it.
    if (!broken.empty()) return broken;
    if (std::string limit = exceeded_limit(problem_, summary); !limit.empty()) return limit;
    if (summary.residual_base_rate > spec_.residual_base_rate_max) return exclusion::kBaseRate;
    // Rest is judged by whether it is reached, which no number of the account decides better.
    if (controller_.kind == ControllerKind::Detumble && !summary.rest_time) {
      return exclusion::not_at_rest(spec_.horizon);
    }
    return "";
  }

 private:
  std::vector<LimitUse> uses(const AfterContact* run) const {
    return account_for_momentum(problem_, configuration_, impact_, subject_, run).limits;
  }
  /// Largest part of a limit of grip and wheels that a run uses.
  double grasp_use(const AfterContact& run) const {
    double most = 0;
    for (const LimitUse& use : uses(&run)) {
      if (is_demand_on_grasp(use)) most = std::max(most, use.part());
    }
    return most;
  }

  const CaptureProblem& problem_;
  const PostImpactSpec& spec_;
  const Configuration& configuration_;
  const ImpactSummary& impact_;
  const Controller& controller_;
  const ContactCase subject_;
};

/// Side by side from three on: runs beside each other take as long as two single ones. They differ
/// by rounding, which the margins of a first run hide, however many are judged together.
std::vector<AfterContact> first_runs_of(const std::vector<ContactCase>& subjects,
                                        const PostImpactSpec& spec, const Controller& controller,
                                        const std::vector<SimulationOptions>& options) {
  if (subjects.size() > 2) return simulate_after_contacts(subjects, spec, controller, options);
  std::vector<AfterContact> runs;
  for (std::size_t i = 0; i < subjects.size(); ++i) {
    runs.push_back(simulate_after_contact(subjects[i], spec, controller, options[i]));
  }
  return runs;
}

}  // namespace

AfterContact motion_to_horizon(const CaptureProblem& problem, const ContactCase& subject,
                               const Controller& controller, const StopCondition& stop) {
  return accurate_run(problem.post_impact, subject, controller, judging_options(problem, stop));
}

int simulated_together(const CaptureProblem& problem) {
  const auto controller = chosen_controller(problem.post_impact);
  const bool is_so = controller && is_smooth(problem.post_impact, *controller);
  return is_so ? size_of_group(problem.search.max_candidates, 1) : 1;
}

std::vector<std::string> post_impact_failures(const CaptureProblem& problem,
                                              const EncounterModel& model,
                                              const std::vector<Configuration>& configurations,
                                              const std::vector<ImpactSummary>& impacts,
                                              const StopCondition& stop) {
  const PostImpactSpec& spec = problem.post_impact;
  std::vector<std::string> failures(configurations.size());
  if (spec.controllers.empty()) return failures;
  const auto controller = chosen_controller(spec);
  if (!controller) {
    return {configurations.size(), "no controller " + spec.controllers.front()};
  }
  std::vector<AfterImpact> cases;
  cases.reserve(configurations.size());
  std::vector<std::size_t> first_runs, whole_runs;
  std::vector<ContactCase> subjects;
  std::vector<SimulationOptions> options;
  for (std::size_t i = 0; i < configurations.size(); ++i) {
    cases.emplace_back(problem, configurations[i], impacts[i], *controller,
                       contact_case(problem, model, configurations[i], impacts[i]));
    failures[i] = cases[i].exceeded_grasp(nullptr);
    if (!failures[i].empty()) continue;
    if (!is_smooth(spec, *controller)) {
      whole_runs.push_back(i);
      continue;
    }
    first_runs.push_back(i);
    subjects.push_back(cases[i].subject());
    options.push_back(cases[i].first_run_options(stop));
  }
  const std::vector<AfterContact> runs = first_runs_of(subjects, spec, *controller, options);
  for (std::size_t k = 0; k < runs.size(); ++k) {
    const std::size_t i = first_runs[k];
    if (const auto failure = cases[i].failure_at_first_sight(runs[k])) {
      failures[i] = *failure;
    } else {
      whole_runs.push_back(i);
    }
  }
  for (const std::size_t i : whole_runs) {
    failures[i] = stop.reached() ? exclusion::kNotJudged : cases[i].failure(stop);
  }
  return failures;
}

std::string post_impact_failure(const CaptureProblem& problem, const Configuration& configuration,
                                const ImpactSummary& impact, const StopCondition& stop) {
  if (problem.post_impact.controllers.empty()) return "";
  const EncounterModel model = encounter_model(at_feature(problem, configuration.feature));
  return post_impact_failures(problem, model, {configuration}, {impact}, stop).front();
}

std::string post_impact_failure(const Plan& plan, const StopCondition& stop) {
  if (plan.status == PlanStatus::Infeasible || !arrives(plan.approach)) return "";
  return post_impact_failure(plan.problem, plan.configuration, plan.impact, stop);
}

}  // namespace stillbase
