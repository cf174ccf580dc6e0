#include "app/plan_summary.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include <fmt/format.h>

#include <stillbase/dynamics/inertia.hpp>
#include <stillbase/dynamics/kinematics.hpp>
#include <stillbase/plan/free_roll.hpp>
#include <stillbase/search/search.hpp>

#include "app/abort_words.hpp"
#include "app/search_advice.hpp"
#include "app/words.hpp"
#include "io/names.hpp"
#include "plan/exclusion_words.hpp"
#include "planner/capture_limits.hpp"
#include "planner/choice.hpp"

namespace stillbase::app {

namespace {

/// Value for the nominal direction and over the cone.
std::string spread_words(const Plan& plan, double nominal, double worst_case, bool is_judged) {
  const std::string& unit = plan.objective.unit;
  std::string text = fmt::format("nominal {} {}", size_words(nominal), unit);
  const double cone = plan.problem.uncertainty.cone_half_angle;
  if (cone > 0) {
    text += fmt::format(", worst case over the cone of {:.3g} deg {}{} {}", cone * kDegrees,
                        is_judged ? "" : "at least ", size_words(worst_case), unit);
  }
  if (const auto& residual = plan.problem.uncertainty.residual_velocity) {
    text += fmt::format(", worst case over {:g} standard deviations of the relative velocity {} {}",
                        residual->deviations, size_words(worst_case), unit);
  }
  return text;
}

/// How well the relative velocity at the contact is known.
std::string residual_words(const ResidualSummary& residual) {
  const Vector6d deviations = residual.covariance.diagonal().cwiseSqrt();
  const Vector3d linear = deviations.head<3>(), angular = deviations.tail<3>();
  std::string text =
      fmt::format("{} m/s and {} deg/s nominal, standard deviations {} m/s and {} deg/s in B",
                  size_words(residual.velocity.head<3>().norm(), 4),
                  size_words(residual.velocity.tail<3>().norm() * kDegrees, 4),
                  vector_words(linear), vector_words(angular * kDegrees));
  if (residual.separating > 1e-6) {
    text += fmt::format(
        "; {:.3g} % of the velocities separate: there is no contact then, and the "
        "worst case and the mean are upper bounds",
        100 * residual.separating);
  }
  return text;
}

bool has_samples(const Plan& plan) {
  const RiskMeasure kind = plan.problem.measure.kind;
  return kind == RiskMeasure::Expectation || kind == RiskMeasure::Cvar;
}

std::string found_words(const Plan& plan) {
  const ObjectiveValue& objective = plan.objective;
  if (plan.status == PlanStatus::Infeasible) {
    return "no configuration satisfies the constraints; this attempt violates them least";
  }
  std::string text = plan.status == PlanStatus::Limit ? "best configuration before the limit"
                                                      : to_string(plan.status) + " configuration";
  text +=
      fmt::format(": {} {}", objective.name,
                  spread_words(plan, objective.nominal, objective.worst_case, objective.is_judged));
  if (!objective.is_judged) return text + "; a limit came before the measure was known";
  if (has_samples(plan)) {
    const bool is_cvar = plan.problem.measure.kind == RiskMeasure::Cvar;
    const bool is_root = objective_power(plan.problem).exponent == 1;
    text += fmt::format(", {} over the {} {} {}",
                        is_cvar   ? "CVaR"
                        : is_root ? "root mean square"
                                  : "mean",
                        plan.objective.residual ? "relative velocity" : "samples",
                        size_words(objective.value), objective.unit);
  }
  return text;
}

/// The joint in which all configurations differ, by whole turns or not; empty: more differs.
std::string only_difference(const RobotModel& robot, const std::vector<Configuration>& all) {
  constexpr double kSame = 1e-3;  // rad, m, s
  int differing = -1;
  for (const Configuration& at : all) {
    const Configuration& first = all.front();
    if ((at.base.position - first.base.position).norm() > kSame ||
        at.base.orientation.angularDistance(first.base.orientation) > kSame ||
        std::abs(at.contact_time - first.contact_time) > kSame || at.feature != first.feature) {
      return "";
    }
    for (int k = 0; k < robot.n(); ++k) {
      if (std::abs(at.phi[k] - first.phi[k]) <= kSame) continue;
      if (differing >= 0 && differing != k) return "";
      differing = k;
    }
  }
  return differing < 0 ? "" : robot.joints[static_cast<std::size_t>(differing)].name;
}

/// Which candidate was chosen, and what excluded the better ones.
std::string choice_words(const Plan& plan) {
  std::vector<std::pair<std::string, int>> reasons;
  std::vector<Configuration> better;
  for (const Candidate& candidate : plan.candidates) {
    if (candidate.excluded.empty()) continue;
    better.push_back(candidate.configuration);
    const auto known = std::find_if(reasons.begin(), reasons.end(), [&](const auto& entry) {
      return entry.first == candidate.excluded;
    });
    if (known == reasons.end()) {
      reasons.emplace_back(candidate.excluded, 1);
    } else {
      ++known->second;
    }
  }
  const auto chosen =
      std::find_if(plan.candidates.begin(), plan.candidates.end(), [&](const Candidate& c) {
        return is_same_configuration(c.configuration, plan.configuration);
      });
  const auto place = chosen - plan.candidates.begin();
  std::string text =
      fmt::format("candidate {} of {}", plan.choice.better + 1, plan.candidates.size());
  if (place != plan.choice.better) text += fmt::format(" by the measure, listed at {}", place + 1);
  const auto& loss = plan.choice.loss_percent;
  if (!loss) text += ", the least measure being zero";
  if (loss && *loss > 0) text += fmt::format(", {:.3g} % above the least measure", *loss);
  // Of equal measures another order decides which one stands first.
  const char* const rank = loss && *loss <= 0 ? "equal" : "better";
  text += plan.choice.better == 1 ? fmt::format("; the {} one", rank)
                                  : fmt::format("; the {} {} ones", plan.choice.better, rank);
  const std::string joint = only_difference(plan.problem.robot, better);
  if (!joint.empty()) text += fmt::format(" (one posture but for {})", joint);
  constexpr std::size_t kMostReasons = 4;
  for (std::size_t i = 0; i < std::min(reasons.size(), kMostReasons); ++i) {
    text += fmt::format("{}{}{}", i == 0 ? ": " : "; ",
                        plan.choice.better > 1 ? fmt::format("{} ", reasons[i].second) : "",
                        reasons[i].first);
  }
  if (reasons.size() > kMostReasons) text += "; others in the plan (candidates[].excluded)";
  return text;
}

/// What one more step beyond a binding limit would save, in a size that engineers change it by.
std::string binding_words(const BindingLimit& limit, const std::string& unit) {
  const auto size = [&](double x) -> std::pair<double, std::string> {
    if (limit.unit == "rad") return {x * kDegrees, "deg"};
    if (limit.unit == "rad/s") return {x * kDegrees, "deg/s"};
    if (limit.unit == "m") return {1e3 * x, "mm"};
    if (limit.unit == "m/s") return {1e3 * x, "mm/s"};
    return {x, limit.unit};
  };
  const auto [at, words] = size(limit.value);
  const double one = 1 / size(1).first;
  return fmt::format("1 {} beyond the {} end of {}, {:.6g} {}, would save {:.3g} {}", words,
                     limit.is_upper ? "upper" : "lower", limit.name, at, words,
                     one * limit.multiplier, unit);
}

/// The factor is what optimizing over the uncertainty is worth.
std::string nominal_optimum_words(const Plan& plan) {
  const NominalOptimum& nominal = *plan.nominal_optimum;
  const ObjectiveValue& objective = plan.objective;
  std::string text = "optimum for the nominal direction alone: ";
  text += has_samples(plan)
              ? fmt::format(
                    "nominal {} {}, over the {} {} {}", size_words(nominal.nominal), objective.unit,
                    plan.problem.uncertainty.residual_velocity ? "relative velocity" : "samples",
                    size_words(nominal.value), objective.unit)
              : spread_words(plan, nominal.nominal, nominal.value, true);
  if (nominal.value < objective.value * (1 - 1e-6)) {
    return text +
           "; not chosen: it collides, no approach path leads there, or the motion after the "
           "impact exceeds the limits";
  }
  // A factor of what is zero but for rounding means nothing.
  if (objective.value > kZeroSize) {
    text += fmt::format(" ({:.2f} times)", nominal.value / objective.value);
  }
  return text;
}

std::string search_words(const Plan& plan) {
  const auto free = std::count_if(plan.candidates.begin(), plan.candidates.end(),
                                  [](const Candidate& c) { return c.collision_free; });
  const auto judged =
      std::count_if(plan.candidates.begin(), plan.candidates.end(),
                    [](const Candidate& c) { return c.collision != exclusion::kNotJudged; });
  const auto all = static_cast<long>(plan.candidates.size());
  std::string text = fmt::format(
      "{} from {} of {}; {}",
      count_words(plan.certificate.distinct_solutions, "distinct solution", "distinct solutions"),
      count_words(plan.certificate.starts, "start", "starts"), plan.optimizer,
      count_words(all, "candidate", "candidates"));
  if (judged < all) text += fmt::format(", {} of them judged", judged);
  return judged == 0 ? text : text + fmt::format(", {} of them free of collision", free);
}

/// A case problem without a solution: how far the nearest attempt is from the case.
std::string nearest_words(const Plan& plan) {
  const CaseJudgement& judgement = plan.impact.judgement;
  const bool is_latch = plan.problem.impulse.contact == ContactLaw::Latch;
  return fmt::format("no {} here; residuals: total {}, base part {}, coupling part {} of {}",
                     io::word_of(io::kCaseConstraintNames, plan.problem.constraints.impact_case),
                     size_words(judgement.total), size_words(judgement.base),
                     size_words(judgement.coupling),
                     is_latch ? "the target's momentum" : "|f| |r_gh| + |t|");
}

/// The feature is named where there was a choice.
std::string contact_words(const Plan& plan) {
  std::string time = fmt::format("at {:.3f} s", plan.configuration.contact_time);
  const std::size_t choice = plan.problem.variables.features.size();
  if (choice == 0) return time;
  return fmt::format("{}, {} of {} features", time, plan.configuration.feature, choice);
}

std::string impulse_words(const CaptureProblem& problem, const ImpactSummary& impact) {
  const Vector3d f = impact.Fbar.head<3>();
  const double size = f.norm();
  if (impact.before) {
    return fmt::format(
        "{} N s, beside {:.4g} N s on a hand at rest, towards which the "
        "target moves at {:.4g} m/s",
        size_words(size), impact.before->Fbar_at_rest.head<3>().norm(), impact.closing_speed);
  }
  const std::string text = fmt::format("{:.4g} N s along {} in the base frame", size,
                                       vector_words(size > 0 ? Vector3d(f / size) : f));
  // A given impulse comes from no motion.
  if (problem.impulse.source == ImpulseSource::Given) return text + ", as stated";
  return text + fmt::format(", closing at {:.4g} m/s", impact.closing_speed);
}

/// The hand that moves at the contact, and what the base has of it.
std::string hand_words(const MotionBefore& before, const Vector3d& base) {
  return fmt::format(
      "moves at {} m/s and {} deg/s, relative velocity {} m/s and {} deg/s; joints at most "
      "{} rad/s; momentum of the base before {}, after {}, with a hand at rest {} N m s",
      size_words(before.hand_velocity.head<3>().norm(), 4),
      size_words(before.hand_velocity.tail<3>().norm() * kDegrees, 4),
      size_words(before.relative_velocity.head<3>().norm()),
      size_words(before.relative_velocity.tail<3>().norm() * kDegrees),
      size_words(before.phidot.cwiseAbs().maxCoeff(), 4), size_words(before.base.norm()),
      size_words(base.norm()), size_words(before.base_at_rest.norm()));
}

std::string momentum_words(const ImpactSummary& impact) {
  return fmt::format("base {}, arm {}, total {} N m s; base rate after the impact {} deg/s",
                     size_words(impact.base.norm()), size_words(impact.coupling.norm()),
                     size_words(impact.total.norm()),
                     size_words(impact.Omega_after().tail<3>().norm() * kDegrees));
}

std::string case_words(const Plan& plan) {
  const CaseJudgement& judgement = plan.impact.judgement;
  const RobotModel& robot = plan.problem.robot;
  const auto kinematics = compute_kinematics<double>(robot, plan.configuration.phi);
  const bool at_centroid = is_at_centroid(kinematics.r_bh, compute_inertia(robot, kinematics).r_bg);
  return fmt::format("{} ({}residuals: total {}, base {}, coupling {}; joints {})",
                     to_string(judgement.impact_case),
                     at_centroid ? "the hand is at the system centroid: the total is zero for "
                                   "every direction; "
                                 : "",
                     size_words(judgement.total), size_words(judgement.base),
                     size_words(judgement.coupling), to_string(plan.impact.resistance.model));
}

std::string certificate_words(const Certificate& certificate) {
  std::string text =
      fmt::format("largest violation {}, KKT residual {}", size_words(certificate.max_violation),
                  std::isfinite(certificate.kkt_residual) ? size_words(certificate.kkt_residual)
                                                          : "not known: a limit came first");
  const auto& curvature = certificate.reduced_hessian_min_eigenvalue;
  if (!curvature) return text;
  // The Hessian is made of differences, whose noise is below this.
  constexpr double kFlat = 1e-6;
  if (*curvature > kFlat) {
    return text + fmt::format("; curvature at least {:.3g}: a strict local minimum", *curvature);
  }
  if (*curvature >= -kFlat)
    return text + "; no curvature in some direction: equally good neighbours";
  return text + fmt::format("; curvature {:.3g} in some direction: not a minimum", *curvature);
}

std::string coverage_words(const Certificate& certificate, PlanStatus status) {
  if (certificate.had_rounds && certificate.unseen == 0) {
    return "no better minimum is possible: the measure is zero";
  }
  if (certificate.had_rounds) {
    const bool is_likely = certificate.unseen > kUnseenLevel;
    return fmt::format(
        "a better minimum, as easy to reach as this one, was missed with a "
        "probability of about {:.2g}{}",
        certificate.unseen,
        !is_likely                    ? ""
        : status == PlanStatus::Limit ? ": the search was stopped before its end"
                                      : fmt::format(": above {}, so the plan is "
                                                    "'{}' and not 'optimal'",
                                                    kUnseenLevel, to_string(status)));
  }
  constexpr int kFew = 10;  // starts that say nothing of a continuum
  if (certificate.unseen > 0.9 && certificate.starts >= kFew) {
    return "almost every start ended at a solution of its own: the solutions form a continuum";
  }
  if (certificate.unseen == 0) {
    return fmt::format("every solution was reached by several of the {} starts",
                       certificate.starts);
  }
  return fmt::format("one more start would find a new solution with a probability of about {:.2g}",
                     certificate.unseen);
}

std::string curve_words(const Plan& plan) {
  int closed = 0, open = 0, starts = 0, total = 0;
  for (const SolutionFamily& curve : plan.families) {
    if (free_joint(curve)) continue;
    ++total;
    closed += curve.is_closed ? 1 : 0;
    open += curve.is_complete ? 0 : 1;
    starts += curve.starts;
  }
  if (total == 0) return "";
  std::set<int> listed;
  for (const Candidate& candidate : plan.candidates) {
    const int family = candidate.family;
    if (family >= 0 && !free_joint(plan.families[static_cast<std::size_t>(family)])) {
      listed.insert(family);
    }
  }
  std::string text = fmt::format(
      "{} of solutions with a nominal objective of zero, {} closed, reached by {} of {} starts; "
      "the candidates are the best of {}",
      count_words(total, "curve", "curves"), closed, starts, plan.certificate.starts,
      static_cast<int>(listed.size()) == total ? "each" : fmt::format("{} of them", listed.size()));
  if (open > 0) text += fmt::format(" ({} not followed to the end)", open);
  return text;
}

auto chosen_candidate(const Plan& plan) {
  return std::find_if(plan.candidates.begin(), plan.candidates.end(), [&](const auto& c) {
    return is_same_configuration(c.configuration, plan.configuration);
  });
}

/// The free coordinate of the chosen candidate, and how many candidates have one.
std::string roll_words(const Plan& plan) {
  const auto chosen = chosen_candidate(plan);
  if (chosen == plan.candidates.end() || chosen->family < 0) return "";
  const SolutionFamily& family = plan.families[static_cast<std::size_t>(chosen->family)];
  const std::optional<int> joint = free_joint(family);
  if (!joint) return "";
  const auto count =
      std::count_if(plan.families.begin(), plan.families.end(),
                    [](const SolutionFamily& f) { return free_joint(f).has_value(); });
  return fmt::format(
      "{} may have any angle from {:.2f} to {:.2f} deg, nothing depends on it ({} of {} "
      "candidates)",
      plan.problem.robot.joints[static_cast<std::size_t>(*joint)].name,
      family.points.front().phi[*joint] * kDegrees, family.points.back().phi[*joint] * kDegrees,
      count, plan.candidates.size());
}

/// Whole turns that may be added to the chosen configuration, and how many candidates have some.
std::string turn_words(const Plan& plan) {
  const auto chosen = chosen_candidate(plan);
  if (chosen == plan.candidates.end() || chosen->turns.empty()) return "";
  std::vector<std::string> joints;
  for (const JointTurns& turns : chosen->turns) {
    joints.push_back(
        turns.least == turns.most - 1
            ? fmt::format("{} by {:+d} deg", turns.joint, 360 * (turns.least + turns.most))
            : fmt::format("{} by {:+d} to {:+d} deg in steps of 360 deg", turns.joint,
                          360 * turns.least, 360 * turns.most));
  }
  const auto count = std::count_if(plan.candidates.begin(), plan.candidates.end(),
                                   [](const Candidate& c) { return !c.turns.empty(); });
  return fmt::format("the posture stays the same with {} ({} of {} candidates have such turns)",
                     fmt::join(joints, ", "), count, plan.candidates.size());
}

std::string approach_words(const Plan& plan) {
  const Approach& approach = plan.approach;
  if (approach.status == ApproachStatus::NotRequested) return "not asked for";
  if (approach.status != ApproachStatus::Found) {
    return fmt::format("none: {}{}{}; what may help: {}", to_string(approach.status),
                       approach.detail.empty() ? "" : ", ", approach.detail, approach_advice(plan));
  }
  std::string text =
      fmt::format("{:.2f} s of motion over {:.3g} rad", approach.duration, approach.path_length);
  if (std::isfinite(approach.min_clearance)) {
    text += fmt::format(", clearance {:.3g} m (hand and target left out)", approach.min_clearance);
  }
  text += fmt::format(", attitude change of the base at most {:.3g} deg",
                      approach.attitude_excursion * kDegrees);
  if (approach.effort_used > 0) {
    text += fmt::format(", peak torque {:.2g} % of that joint's limit", 100 * approach.effort_used);
  }
  if (approach.abort) text += "; " + abort_words(plan);
  if (approach.polish == PathPolish::Time) {
    text += fmt::format("; polished from {:.2f} s to {:.2f} s", approach.before_polish,
                        approach.after_polish);
  } else if (approach.polish == PathPolish::Attitude) {
    text += fmt::format("; polished from {:.3g} deg to {:.3g} deg",
                        approach.before_polish * kDegrees, approach.after_polish * kDegrees);
  }
  return text;
}

std::string managed_words(const ManagedMomentum& managed, const SensorSpec& sensor) {
  std::string text =
      fmt::format("momentum to be managed: {} N m s, {} N s", size_words(managed.angular.norm()),
                  size_words(managed.linear.norm()));
  if (!managed.least_time || *managed.least_time == 0) return text;
  text += fmt::format("; the wheels alone need at least {:.4g} s while the base keeps its attitude",
                      *managed.least_time);
  if (managed.rest_time) text += ", " + rest_words(sensor, *managed.rest_time);
  if (!managed.remaining || (managed.rest_time && !have_rate_errors(sensor))) return text;
  return text + fmt::format(", {} N m s are left at the horizon", size_words(*managed.remaining));
}

/// The limit of which most is used after the contact, kept or not.
/// @param role "tightest limit", or what else it is
std::string limit_use_words(const LimitUse& use, const std::string& role) {
  const bool is_angle = use.unit == "rad" || use.unit == "rad/s";
  const double scale = is_angle ? kDegrees : 1;
  const std::string unit = use.unit == "rad" ? "deg" : use.unit == "rad/s" ? "deg/s" : use.unit;
  std::string name = to_string(use.limit);
  std::replace(name.begin(), name.end(), '_', ' ');
  std::string text = fmt::format("{}: {} of {}, ", role, name, use.place);
  if (has_no_wheel(use)) {
    return text + fmt::format("{:.4g} {}, and there is no wheel about it", use.value, unit);
  }
  // Of ranges the value is a distance from their middle, which says little.
  const bool is_range = use.limit == CaptureLimit::JointStop || use.place == "contact_time";
  if (!is_range) {
    text += fmt::format("{:.4g} of {:.4g} {}, ", scale * use.value, scale * use.most, unit);
  }
  // A limit that is just kept has no margin, but for rounding.
  const double margin = is_exceeded(use) ? use.margin() : std::max(use.margin(), 0.0);
  return text + fmt::format("margin {:.3g} {}", scale * margin, unit);
}

/// The limit that binds: an exceeded one, else under detumble the one at which a load is held for
/// most of the time, else the one of which most is used.
std::string binding_limit_words(const ManagedMomentum& managed, double horizon) {
  const LimitUse& most = managed.limits.front();
  if (is_exceeded(most)) return limit_use_words(most, "exceeded limit");
  const auto& held = managed.longest_held;
  if (!held) return limit_use_words(most, "tightest limit");
  std::string name = to_string(held->limit);
  std::replace(name.begin(), name.end(), '_', ' ');
  const std::string words =
      fmt::format("{} of {}, at least {:.4g} % of it for {:.4g} s of the {:.4g} s until {}", name,
                  held->place, 100 * kNearLimit, held->time, managed.rest_time.value_or(horizon),
                  managed.rest_time ? "the rest" : "the horizon");
  if (is_bound(managed, horizon)) return "binding limit: " + words;
  return "no limit binds, the controller's gains decide the time until the rest; longest: " + words;
}

std::string proof_words(const Proof& proof) {
  std::string text = proof.statement;
  if (proof.gap && proof.lower_bound == 0.0) {
    text += fmt::format("; gap of the nominal objective to its global minimum {:.3g}", *proof.gap);
  }
  if (proof.boxes > 0) text += fmt::format(" ({} boxes)", proof.boxes);
  return text;
}

std::string solver_words(const Plan& plan) {
  std::string text;
  for (const auto& [name, count] : plan.solver_calls) {
    if (!text.empty()) text += ", ";
    text += fmt::format("{} {}", name, count_words(count, "call", "calls"));
  }
  const auto total = plan.timing.find("total");
  if (total != plan.timing.end()) text += fmt::format("; {:.2f} s", total->second);
  return text;
}

}  // namespace

std::vector<SummaryLine> plan_summary(const Plan& plan, bool is_verbose) {
  const bool is_feasible = plan.status != PlanStatus::Infeasible;
  const Proof& proof = plan.certificate.proof;
  std::vector<SummaryLine> lines{{"problem", plan.problem.name + ": " + plan.problem.purpose},
                                 {"found", found_words(plan)}};
  if (!plan.candidates.empty()) {
    if (is_feasible && plan.nominal_optimum && plan.problem.measure.kind != RiskMeasure::Nominal) {
      lines.push_back({"", nominal_optimum_words(plan)});
    }
    if (!is_feasible && plan.problem.constraints.impact_case != CaseConstraint::None) {
      lines.push_back({"", nearest_words(plan)});
    }
    for (const ConstraintValue& constraint : plan.constraints) {
      if (constraint.violation <= kZeroSize) continue;
      const bool is_plain = constraint.unit.empty() || constraint.unit == "1";
      const std::string unit = is_plain ? "" : " " + constraint.unit;
      lines.push_back(
          {"", fmt::format("{} = {:.4g}{unit} violates its bounds by {:.3g}{unit}", constraint.name,
                           constraint.value, constraint.violation, fmt::arg("unit", unit))});
    }
    if (!is_feasible) lines.push_back({"", search_advice(plan)});
    lines.push_back({"search", search_words(plan)});
    if (plan.choice.better > 0) lines.push_back({"choice", choice_words(plan)});
    lines.push_back({"posture", posture_words(plan.problem.robot, plan.configuration.phi)});
    lines.push_back({"base", pose_words(plan.configuration.base)});
    lines.push_back({"contact", contact_words(plan)});
    if (plan.objective.residual) {
      lines.push_back({"velocity", residual_words(*plan.objective.residual)});
    }
    for (const PlanWarning& warning : plan.warnings) {
      lines.push_back({"warning", warning.code + ": " + warning.message});
    }
    lines.push_back({"impulse", impulse_words(plan.problem, plan.impact)});
    if (plan.impact.before) {
      lines.push_back({"hand", hand_words(*plan.impact.before, plan.impact.base)});
    }
    lines.push_back({"momentum", momentum_words(plan.impact)});
    lines.push_back({"case", case_words(plan)});
    for (std::size_t i = 0; i < plan.binding.size(); ++i) {
      lines.push_back(
          {i == 0 ? "binding" : "", binding_words(plan.binding[i], plan.objective.unit)});
    }
    lines.push_back({"certificate", certificate_words(plan.certificate)});
    if (is_feasible && proof.status != ProofStatus::Complete) {
      lines.push_back({"coverage", coverage_words(plan.certificate, plan.status)});
    }
    for (const auto& [name, words] :
         {std::pair{"curves", curve_words(plan)}, std::pair{"free", roll_words(plan)},
          std::pair{"turns", turn_words(plan)}}) {
      if (!words.empty()) lines.push_back({name, words});
    }
    if (is_feasible) lines.push_back({"approach", approach_words(plan)});
    if (plan.after_horizon) {
      lines.push_back({"afterwards",
                       after_horizon_words(*plan.after_horizon, plan.problem.post_impact.horizon)});
    }
    if (plan.managed_momentum) {
      lines.push_back({plan.after_horizon ? "" : "afterwards",
                       managed_words(*plan.managed_momentum, plan.problem.post_impact.sensor)});
      if (!plan.managed_momentum->limits.empty()) {
        lines.push_back(
            {"", binding_limit_words(*plan.managed_momentum, plan.problem.post_impact.horizon)});
      }
    }
    const bool is_proven = proof.status != ProofStatus::NotApplicable || proof.lower_bound;
    if (is_proven || is_verbose) lines.push_back({"proof", proof_words(proof)});
  }
  const PostImpactSpec& after = plan.problem.post_impact;
  if (has_default_limits(after)) lines.push_back({"limits", limit_words(after)});
  lines.push_back({"solvers", solver_words(plan)});
  return lines;
}

std::string summary_text(const std::vector<SummaryLine>& lines) {
  std::string text;
  for (const SummaryLine& line : lines) {
    text += fmt::format("{}{:<13} {}", text.empty() ? "" : "\n", line.topic, line.words);
  }
  return text;
}

}  // namespace stillbase::app
