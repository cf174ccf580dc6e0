// Why was a candidate that ranks before the chosen one not chosen? What follows from the candidate
// alone is recomputed: collisions by distances of our own, limits after the impact by a simulation.
// What the search for a path knows has to be in one of its own forms, and is left open by name.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>

#include <fmt/format.h>

#include "audit/exclusions.hpp"
#include "plan/exclusion_words.hpp"
#include "verification/clearance.hpp"
#include "verification/contact_case.hpp"
#include "verification/limit_uses.hpp"
#include "verification/moving_shapes.hpp"
#include "verification/tolerances.hpp"

namespace stillbase::audit {

using namespace verification;

namespace {

/// How reasons are compared.
struct ExclusionOptions {
  /// Relative, of a limit after the impact, of a stop rad (m): another integration may see it just
  /// kept.
  double nearly = 1e-3;
  double digits = 1e-3;  ///< relative: reasons have numbers of four digits
};
constexpr ExclusionOptions kExclusions;

/// What follows a prefix; empty: the text does not begin with it.
std::optional<std::string> after_prefix(const std::string& text, const std::string& prefix) {
  if (text.rfind(prefix, 0) != 0) return std::nullopt;
  return text.substr(prefix.size());
}

bool was_cut(const Plan& plan) {
  const ApproachStatus path = plan.approach.status;
  return plan.status == PlanStatus::Limit || path == ApproachStatus::TimeOut ||
         path == ApproachStatus::Stopped || path == ApproachStatus::Interrupted;
}

bool base_follows_path(const ApproachSpec& approach) {
  return approach.enabled && approach.base == BaseMode::Floating && !approach.station_free;
}

/// Least distances of the pairs that may not touch, by name, while the robot waits at a candidate
/// and the target comes in. Those beyond `enough` may be missing.
/// @param room m further within the distance from the contact where the hand may touch the target
std::map<std::string, double> waiting_distances(const Situation& at, const CollisionScene& scene,
                                                double wait, double enough, double room) {
  MovingShapes shapes(at.problem, scene);
  const TargetMotion* const motion = at.target();
  const double contact = at.at.contact_time;
  int steps = 0;
  if (motion != nullptr) {
    const double way = wait * motion->state(contact).linear_velocity.norm();
    steps = static_cast<int>(std::clamp(std::ceil(way / 0.01), 1.0, 2000.0));
  }
  std::map<std::string, double> least;
  for (int i = 0; i <= steps; ++i) {
    std::optional<Pose> target;
    if (motion != nullptr) target = motion->state(contact - wait * i / std::max(steps, 1)).pose;
    shapes.place(at.at.phi, at.at.base, target ? &*target : nullptr);
    for (int pair = 0; pair < shapes.pair_count(); ++pair) {
      if (!shapes.is_present(pair)) continue;
      if (shapes.is_hand_and_target(pair) && shapes.hand_room() >= room) continue;
      const double distance = shapes.distance(pair, enough).upper;
      if (!(distance <= enough)) continue;
      const auto known = least.emplace(shapes.name(pair), distance).first;
      known->second = std::min(known->second, distance);
    }
  }
  return least;
}

/// "b with a" of "a with b".
std::string swapped(const std::string& pair) {
  const std::string with = " with ";
  const std::size_t at = pair.find(with);
  if (at == std::string::npos) return pair;
  return pair.substr(at + with.size()) + with + pair.substr(0, at);
}

/// What is wrong with the collision that a candidate states; empty: nothing.
/// @param scene of the problem's own feature
std::string collision_objection(const Context& context, const CollisionScene& scene,
                                const Candidate& candidate) {
  if (candidate.collision == exclusion::kNotJudged && !candidate.collision_free) {
    return was_cut(context.plan) ? "" : "its collisions are not judged";
  }
  const ApproachSpec& approach = context.problem.approach;
  const double wait = context.problem.hand_motion.moves() ? 0 : approach.wait;
  const double margin = approach.enabled ? approach.clearance : 0;
  const Situation at(context.problem, candidate.configuration,
                     candidate.configuration.contact_time - wait);
  const bool is_same_feature = at.problem.variables.feature == context.problem.variables.feature;
  // At the edge of that distance two codes may see the hand on either side.
  const double room = candidate.collision_free ? -kShared.flat_distance : kShared.flat_distance;
  const auto distances = waiting_distances(at, is_same_feature ? scene : CollisionScene(at.problem),
                                           wait, margin + kShared.flat_distance, room);
  if (!candidate.collision_free) {
    const bool is_found = distances.count(candidate.collision) > 0 ||
                          distances.count(swapped(candidate.collision)) > 0;
    return is_found ? "" : candidate.collision + " are not near each other";
  }
  for (const auto& [pair, distance] : distances) {
    if (distance < margin - kShared.flat_distance) {
      return fmt::format("{} are {:.3g} m from each other", pair, distance);
    }
  }
  return "";
}

/// The motion of a candidate after the impact under the first controller, until something is so.
using IsSo = std::function<bool(const SimulationSummary&)>;
AfterContact simulate(const Situation& at, const StopCondition& stop, const IsSo& is_so) {
  const PostImpactSpec& spec = at.problem.post_impact;
  SimulationOptions options = plant_options_of(spec, at.problem.robot);
  options.integrator = IntegratorKind::Fehlberg78;
  options.relative_tolerance = 1e-9;
  options.absolute_tolerance = 1e-11;
  options.output_period = spec.horizon;
  options.stop = stop;
  options.ends_when = is_so;
  const ContactCase subject =
      contact_case(at.problem, at.target(), at.event, at.response, at.at, at.event.n, at.impulse());
  return simulate_after_contact(subject, spec, *controller_of(spec, spec.controllers.front()),
                                options);
}

/// A stop, a rate, a torque, a grip or an attitude that is beyond its limit at some instant; empty:
/// the words are of none.
IsSo limit_of_an_instant(const CaptureProblem& problem, const std::string& failure) {
  const RobotModel& robot = problem.robot;
  const PostImpactSpec& spec = problem.post_impact;
  constexpr double kMost = 1 - kExclusions.nearly;
  if (failure == exclusion::kAttitude) {
    return [&spec](const SimulationSummary& x) {
      return x.attitude_turned > kMost * spec.attitude_change_max;
    };
  }
  if (failure == exclusion::kGripLoad) {
    return [&spec](const SimulationSummary& x) {
      return x.peak_grip_force > kMost * spec.grip.force.value_or(kInfinity) ||
             x.peak_grip_moment > kMost * spec.grip.moment.value_or(kInfinity);
    };
  }
  for (int k = 0; k < robot.n(); ++k) {
    const std::string& name = robot.joints[k].name;
    if (failure == name + exclusion::kRateLimit) {
      return [&robot, k](const SimulationSummary& x) {
        return x.peak_joint_rates.size() > 0 &&
               x.peak_joint_rates[k] > kMost * robot.joints[k].max_velocity;
      };
    }
    if (failure == name + exclusion::kTorqueLimit) {
      return [&robot, k](const SimulationSummary& x) {
        return x.peak_demanded_torques.size() > 0 &&
               x.peak_demanded_torques[k] > kMost * robot.joints[k].max_effort;
      };
    }
    if (failure != name + exclusion::kStop) continue;
    return [&robot, k](const SimulationSummary& x) {
      if (x.lowest_positions.size() == 0) return false;  // before the first step
      const Joint& joint = robot.joints[k];
      const bool is_near = x.lowest_positions[k] <= joint.lower + kExclusions.nearly ||
                           x.highest_positions[k] >= joint.upper - kExclusions.nearly;
      // An enforced stop is reached within a step.
      return is_near || std::any_of(x.limits.begin(), x.limits.end(), [k](const LimitEvent& event) {
               const LimitKind kind = event.kind;
               return event.joint == k &&
                      (kind == LimitKind::LowerStop || kind == LimitKind::UpperStop);
             });
    };
  }
  return {};
}

/// Words such as "wheel momentum of y: 10.25 N m s of 10 N m s", also with " after 3 s", against
/// the uses that were found.
bool is_use(const LimitUses& uses, const std::string& words) {
  for (const CaptureLimit limit :
       {CaptureLimit::GripForce, CaptureLimit::GripMoment, CaptureLimit::WheelMomentum}) {
    const auto found = uses.find(limit);
    if (found == uses.end()) continue;
    std::string name = to_string(limit);
    std::replace(name.begin(), name.end(), '_', ' ');
    for (const LimitUse& use : found->second) {
      const auto numbers = after_prefix(words, fmt::format("{} of {}: ", name, use.place));
      if (!numbers) continue;
      char* end = nullptr;
      const double value = std::strtod(numbers->c_str(), &end);
      const auto ending =
          after_prefix(end, fmt::format(" {}{}", use.unit, exclusion::of_most(use)));
      if (!ending) return false;
      // A run that ended at the limit had not seen the largest value.
      const bool was_ended = ending->rfind(" after ", 0) == 0;
      const double same = kExclusions.digits * use.value;
      return (ending->empty() || was_ended) && use.value > (1 - kExclusions.nearly) * use.most &&
             value > (1 - kExclusions.nearly) * use.most && value <= use.value + same &&
             (was_ended || value >= use.value - same);
    }
  }
  return false;
}

/// Whether the limit that is named is exceeded after the impact.
bool is_exceeded(const Situation& at, const std::string& failure, const StopCondition& stop) {
  const CaptureProblem& problem = at.problem;
  const PostImpactSpec& spec = problem.post_impact;
  if (spec.controllers.empty()) return false;
  if (const IsSo is_so = limit_of_an_instant(problem, failure)) {
    return is_so(simulate(at, stop, is_so).simulation.summary);
  }
  if (problem.target && is_use(limit_uses(at, nullptr), failure)) return true;
  const bool is_endless = failure.rfind(exclusion::kStillTouching, 0) == 0;
  const bool is_restless = failure == exclusion::not_at_rest(spec.horizon);
  const bool is_use_of_run = failure.find(" of ") != std::string::npos;
  const bool is_known = is_endless || is_restless || is_use_of_run ||
                        failure == exclusion::kBaseRate ||
                        failure == to_string(SimulationStatus::Diverged) ||
                        failure == to_string(SimulationStatus::StepLimit);
  if (!is_known) return false;
  const AfterContact run = simulate(at, stop, {});
  const SimulationSummary& summary = run.simulation.summary;
  if (failure == to_string(run.simulation.status)) return true;
  if (run.simulation.status != SimulationStatus::Finished) return false;
  if (failure == exclusion::kBaseRate) {
    return summary.residual_base_rate > (1 - kExclusions.nearly) * spec.residual_base_rate_max;
  }
  if (is_restless) {
    return chooses(spec, ControllerKind::Detumble) &&
           summary.rest_time.value_or(kInfinity) > (1 - kExclusions.nearly) * spec.horizon;
  }
  if (is_endless) {
    return run.encounter && run.encounter->contact.phase == ContactPhase::Touching;
  }
  return problem.target && is_use(limit_uses(at, &run), failure);
}

/// "<status>" or "<status>, <details>" of a path that was not found.
bool is_failed_path(const std::string& words) {
  const std::string word = words.substr(0, words.find(", "));
  for (int i = 0; i <= static_cast<int>(ApproachStatus::Stopped); ++i) {
    const auto status = static_cast<ApproachStatus>(i);
    const bool fails = status != ApproachStatus::Found && status != ApproachStatus::NotRequested;
    if (fails && word == to_string(status)) return true;
  }
  return false;
}

/// What is wrong with a reason that only the search for a path knows; empty: it may be so.
std::string search_objection(const Context& context, const Candidate& candidate) {
  const ApproachSpec& approach = context.problem.approach;
  const std::string& reason = candidate.excluded;
  const bool is_of_other_feature =
      candidate.configuration.feature != context.plan.configuration.feature;
  const bool path_decides =
      base_follows_path(approach) || (approach.enabled && approach.base == BaseMode::ReactionNull);
  if (const auto status = after_prefix(reason, exclusion::kNoPathOfFeature)) {
    return is_of_other_feature && is_failed_path(*status) ? "" : "no failure of a path";
  }
  if (reason == exclusion::kLimitOfFeature) {
    return is_of_other_feature ? "" : "it has the chosen feature";
  }
  if (reason.rfind(exclusion::kAtPathEnd, 0) == 0 ||
      reason.rfind(exclusion::kAfterPathEnd, 0) == 0 || reason == exclusion::kNoBetterAtPathEnd) {
    const bool is_tried = path_decides && approach.effort == ApproachEffort::Best;
    return is_tried ? "" : "the path does not decide its configuration";
  }
  // A path is looked for to what is free of collision at the contact; where the base follows the
  // path, to all of them in the end.
  const bool is_goal = candidate.collision_free || base_follows_path(approach);
  if (const auto words = after_prefix(reason, exclusion::kNoPath)) {
    if (!is_failed_path(*words)) return "no failure of a path";
    return approach.enabled && is_goal ? "" : "no path was looked for";
  }
  if (reason == exclusion::kOtherPathFirst) {
    const bool is_found = approach.enabled && candidate.collision_free;
    return is_found ? "" : "no path was looked for";
  }
  const bool is_first = approach.effort == ApproachEffort::First;
  if (reason == exclusion::kFirstPathWanted) {
    return is_first ? "" : "approach.effort is another one";
  }
  if (reason == exclusion::kNotTried)
    return is_first && !is_of_other_feature ? "it says not why" : "";
  return "no reason that a search has";
}

}  // namespace

std::string exclusions_by_search(const Plan& plan) {
  std::map<std::string, std::string> numbers;  // of candidates, by reason
  for (std::size_t i = 0; i < plan.candidates.size(); ++i) {
    const std::string& reason = plan.candidates[i].excluded;
    const bool is_recomputed = after_prefix(reason, exclusion::kAtContact) ||
                               after_prefix(reason, exclusion::kAfterImpact);
    if (reason.empty() || is_recomputed) continue;
    std::string& list = numbers[reason.substr(0, reason.find(':'))];
    list += fmt::format("{}{}", list.empty() ? "" : ", ", i);
  }
  std::string text;
  for (const auto& [reason, list] : numbers) {
    text += fmt::format("{}{} ({})", text.empty() ? "" : "; ", list, reason);
  }
  return text;
}

void check_exclusions(const Context& context, ClaimList& claims) {
  const Plan& plan = context.plan;
  const CollisionScene scene(context.problem);
  Objections collisions, reasons;
  bool has_reasons = false;
  std::string open;
  for (std::size_t i = 0; i < plan.candidates.size(); ++i) {
    if (context.options.stop.reached()) {
      return claims.not_evaluated("candidates_collision", 0, "1",
                                  fmt::format("stopped before candidate {}", i));
    }
    const Candidate& candidate = plan.candidates[i];
    const std::string name = fmt::format("candidate {}: ", i);
    const std::string wrong = collision_objection(context, scene, candidate);
    collisions.demand(wrong.empty(), name + wrong);
    if (candidate.excluded.empty()) continue;
    has_reasons = true;
    const std::string stated = fmt::format("{}'{}': ", name, candidate.excluded);
    if (const auto pair = after_prefix(candidate.excluded, exclusion::kAtContact)) {
      reasons.demand(!candidate.collision_free && *pair == candidate.collision,
                     stated + "not the collision that it states");
    } else if (const auto failure = after_prefix(candidate.excluded, exclusion::kAfterImpact)) {
      reasons.demand(candidate.collision_free, stated + "its collision comes first");
      if (*failure == exclusion::kNotJudged) {
        reasons.demand(was_cut(plan), stated + "no limit ended the search");
      } else if (!context.options.post_impact) {
        open += fmt::format("{}{}", open.empty() ? "" : ", ", i);
      } else {
        const Situation at(context.problem, candidate.configuration);
        reasons.demand(is_exceeded(at, *failure, context.options.stop),
                       stated + "that does not happen");
      }
    } else {
      const std::string objection = search_objection(context, candidate);
      reasons.demand(objection.empty(), stated + objection);
    }
  }
  claims.none_wrong("candidates_collision", collisions,
                    "collisions at a candidate while the robot waits there, stated and not found "
                    "or found and not stated");
  if (!has_reasons) return;
  claims.none_wrong("candidates_excluded", reasons,
                    "reasons against candidates that do not hold, or are none");
  if (!open.empty()) {
    claims.not_verified("candidates_excluded_after_impact",
                        "without the time after the impact: candidates " + open);
  }
}

}  // namespace stillbase::audit
