#include "app/plan_summary.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>

#include <stillbase/dynamics/inertia.hpp>
#include <stillbase/dynamics/kinematics.hpp>

#include "app/words.hpp"
#include "impact/case_lever.hpp"

namespace stillbase::app {

namespace {

constexpr const char* kLine = "{:<13} {}\n";

std::string line(const char* topic, const std::string& text) {
  return fmt::format(kLine, topic, text);
}

std::string found_words(const Plan& plan) {
  const int starts = plan.certificate.starts;
  const long free = std::count_if(plan.candidates.begin(), plan.candidates.end(),
                                  [](const Candidate& c) { return c.collision_free; });
  if (plan.status == PlanStatus::Infeasible) {
    return fmt::format("no configuration satisfies the constraints ({} starts, {})", starts,
                       plan.optimizer);
  }
  return fmt::format(
      "{}, {}; {} kept, {} of them free of collision ({} starts, {})",
      plan.status == PlanStatus::Limit ? "stopped early, best so far"
                                       : to_string(plan.status) + " configuration",
      count_words(plan.certificate.distinct_solutions, "distinct solution", "distinct solutions"),
      plan.candidates.size(), free, starts, plan.optimizer);
}

std::string violations(const Plan& plan) {
  std::string text;
  for (const ConstraintValue& constraint : plan.constraints) {
    if (constraint.violation <= 1e-9) continue;
    text += line("", fmt::format("{} = {:.6g} misses its bounds by {:.3g}", constraint.name,
                                 constraint.value, constraint.violation));
  }
  return text;
}

/// A case problem without a solution: how far the nearest attempt is from the case.
std::string nearest_words(const Plan& plan) {
  const CaseConstraint wanted = plan.problem.constraints.impact_case;
  if (plan.status != PlanStatus::Infeasible || wanted == CaseConstraint::None) return "";
  const char* names[] = {"", "C", "C1", "C2", "G2", "G3"};
  const CaseJudgement& judgement = plan.impact.judgement;
  return fmt::format(
      "no {} here; nearest residual: total {}, base part {}, coupling part {} of |f| |r_gh| + |t|",
      names[static_cast<int>(wanted)], size_words(judgement.total), size_words(judgement.base),
      size_words(judgement.coupling));
}

std::string certificate_words(const Certificate& certificate) {
  return fmt::format("largest violation {}, KKT residual {}", size_words(certificate.max_violation),
                     std::isfinite(certificate.kkt_residual) ? size_words(certificate.kkt_residual)
                                                             : "not known: a limit came first");
}

/// Noise of the Hessian, which is made of differences, is below this.
constexpr double kFlat = 1e-6;

std::string curvature_words(double smallest) {
  if (smallest > kFlat) return fmt::format("at least {:.3g}: a strict local minimum", smallest);
  if (smallest >= -kFlat) return "none in some direction: neighbours that are as good";
  return fmt::format("{:.3g} in some direction: not a minimum", smallest);
}

std::string unseen_words(const Certificate& certificate) {
  if (certificate.unseen > 0.9) {
    return fmt::format("nearly every start ended at a solution of its own: they form families");
  }
  if (certificate.unseen == 0) {
    return fmt::format("every solution was reached by several of the {} starts",
                       certificate.starts);
  }
  return fmt::format(
      "one more start would end at a new solution with a probability of about {:.2g}",
      certificate.unseen);
}

std::string family_words(const Plan& plan) {
  int closed = 0, open = 0, starts = 0;
  for (const SolutionFamily& family : plan.families) {
    closed += family.is_closed ? 1 : 0;
    open += family.is_complete ? 0 : 1;
    starts += family.starts;
  }
  const int total = static_cast<int>(plan.families.size());
  std::set<int> listed;
  for (const Candidate& candidate : plan.candidates) listed.insert(candidate.family);
  listed.erase(-1);
  std::string text = fmt::format(
      "{} of zeros of the predicted objective, {} closed, where {} of {} starts ended; "
      "listed are the best of {}",
      count_words(total, "curve", "curves"), closed, starts, plan.certificate.starts,
      static_cast<int>(listed.size()) == total ? "each" : fmt::format("{} of them", listed.size()));
  if (open > 0) text += fmt::format(" ({} not followed to the end)", open);
  return text;
}

std::string proof_words(const Proof& proof) {
  std::string text = proof.statement;
  if (proof.gap && proof.lower_bound == 0.0)
    text +=
        fmt::format("; gap of the predicted objective to its global minimum {:.3g}", *proof.gap);
  if (proof.boxes > 0) text += fmt::format(" ({} boxes)", proof.boxes);
  return text;
}

std::string objective_words(const Plan& plan) {
  const ObjectiveValue& objective = plan.objective;
  std::string text = fmt::format("{} {} {} as predicted", objective.name,
                                 size_words(objective.nominal), objective.unit);
  const double cone = plan.problem.uncertainty.cone_half_angle;
  if (cone > 0) {
    text += fmt::format(", {}{} {} at worst within {:.3g} deg of the predicted direction",
                        objective.is_judged ? "" : "at least ", size_words(objective.worst_case),
                        objective.unit, cone * kDegrees);
  }
  if (!objective.is_judged) return text + "; a limit came before more was known";
  const RiskMeasure kind = plan.problem.measure.kind;
  if (kind == RiskMeasure::Expectation || kind == RiskMeasure::Cvar) {
    text += fmt::format(", {} {} over the samples", size_words(objective.value), objective.unit);
  }
  return text;
}

/// The factor is what optimising over the uncertainty is good for.
std::string nominal_optimum_words(const Plan& plan) {
  const NominalOptimum& nominal = *plan.nominal_optimum;
  const ObjectiveValue& objective = plan.objective;
  std::string text = fmt::format(
      "the best for the prediction alone: {} {} as predicted, {} {} {}",
      size_words(nominal.nominal), objective.unit, size_words(nominal.value), objective.unit,
      plan.problem.measure.kind == RiskMeasure::WorstCase ? "at worst" : "over the samples");
  if (nominal.value < objective.value * (1 - 1e-6)) {
    return text +
           "; passed over: it touches something, no approach leads there, or what follows the "
           "impact is beyond the limits";
  }
  constexpr double kZero = 1e-9;  // as in size_words: a factor of what is left is noise
  if (objective.value > kZero) {
    text += fmt::format(" ({:.2f} times)", nominal.value / objective.value);
  }
  return text;
}

std::string impact_words(const Plan& plan) {
  const ImpactSummary& impact = plan.impact;
  const Vector3d f = impact.Fbar.head<3>();
  const double size = f.norm();
  return fmt::format("{:.4g} N s along {} in the base frame, closing at {:.4g} m/s", size,
                     vector_words(size > 0 ? Vector3d(f / size) : f), impact.closing_speed);
}

std::string momentum_words(const ImpactSummary& impact) {
  return fmt::format("base {}, arm {}, total {} N m s; the base starts to turn at {} deg/s",
                     size_words(impact.base.norm()), size_words(impact.coupling.norm()),
                     size_words(impact.total.norm()),
                     size_words(impact.Delta_Omega.tail<3>().norm() * kDegrees));
}

std::string case_words(const Plan& plan) {
  const ImpactSummary& impact = plan.impact;
  const CaseJudgement& judgement = impact.judgement;
  const RobotModel& robot = plan.problem.robot;
  const auto kinematics = compute_kinematics<double>(robot, plan.configuration.phi);
  const bool meet = is_at_centroid(kinematics.r_bh, compute_inertia(robot, kinematics).r_bg);
  return fmt::format("{} ({}residuals: total {}, base {}, coupling {}; joints {})",
                     to_string(judgement.impact_case),
                     meet ? "the hand is at the system's centroid, where an impulse turns nothing "
                            "as a whole; "
                          : "",
                     size_words(judgement.total), size_words(judgement.base),
                     size_words(judgement.coupling), to_string(impact.resistance.model));
}

std::string approach_words(const Approach& approach) {
  if (approach.status == ApproachStatus::NotRequested) return "not asked for";
  if (approach.status != ApproachStatus::Found) {
    return fmt::format("none: {}{}{}", to_string(approach.status),
                       approach.detail.empty() ? "" : ", ", approach.detail);
  }
  std::string text =
      fmt::format("{:.2f} s of motion over {:.3g} rad", approach.duration, approach.path_length);
  if (std::isfinite(approach.min_clearance)) {
    text += fmt::format(", clearance {:.3g} m (hand from target aside)", approach.min_clearance);
  }
  text += fmt::format(", base turns by at most {:.3g} deg", approach.attitude_excursion * kDegrees);
  if (approach.effort_used > 0) {
    text += fmt::format(", {:.2g} % of a joint's effort", 100 * approach.effort_used);
  }
  if (approach.polish == PathPolish::Time) {
    text += fmt::format("; polished from {:.2f} s to {:.2f} s of motion", approach.before_polish,
                        approach.after_polish);
  } else if (approach.polish == PathPolish::Attitude) {
    text += fmt::format("; polished from {:.3g} deg to {:.3g} deg of turn",
                        approach.before_polish * kDegrees, approach.after_polish * kDegrees);
  }
  return text;
}

std::string effort_words(const Plan& plan) {
  std::string text;
  for (const auto& [name, count] : plan.solver_calls) {
    if (!text.empty()) text += ", ";
    text += fmt::format("{} {}", name, count_words(count, "call", "calls"));
  }
  const auto total = plan.timing.find("total");
  if (total != plan.timing.end()) text += fmt::format("; {:.2f} s", total->second);
  return text;
}

/// The feature is named where there was a choice.
std::string contact_words(const Plan& plan) {
  const std::string time = fmt::format("at {:.3f} s", plan.configuration.contact_time);
  const std::size_t choice = plan.problem.variables.features.size();
  if (choice == 0) return time;
  return fmt::format("{}, {} of {} features", time, plan.configuration.feature, choice);
}

}  // namespace

std::string plan_summary(const Plan& plan) {
  std::string text = line("problem", plan.problem.name + ": " + plan.problem.purpose);
  text += line("found", found_words(plan));
  if (!plan.candidates.empty()) {
    if (const std::string nearest = nearest_words(plan); !nearest.empty()) {
      text += line("nearest", nearest);
    }
    text += violations(plan);
    text += line("posture", posture_words(plan.problem.robot, plan.configuration.phi));
    text += line("base", pose_words(plan.configuration.base));
    text += line("contact", contact_words(plan));
    text += line("impulse", impact_words(plan));
    text += line("momentum", momentum_words(plan.impact));
    text += line("case", case_words(plan));
    text += line("objective", objective_words(plan));
    if (plan.nominal_optimum && plan.problem.measure.kind != RiskMeasure::Nominal) {
      text += line("", nominal_optimum_words(plan));
    }
    text += line("certificate", certificate_words(plan.certificate));
    const auto& curvature = plan.certificate.reduced_hessian_min_eigenvalue;
    if (plan.status != PlanStatus::Infeasible && curvature) {
      text += line("curvature", curvature_words(*curvature));
    }
    if (plan.status != PlanStatus::Infeasible &&
        plan.certificate.proof.status != ProofStatus::Complete) {
      text += line("unseen", unseen_words(plan.certificate));
    }
    if (!plan.families.empty()) text += line("families", family_words(plan));
    if (plan.status != PlanStatus::Infeasible) {
      text += line("approach", approach_words(plan.approach));
    }
  }
  if (!plan.candidates.empty()) text += line("proof", proof_words(plan.certificate.proof));
  text += line("effort", effort_words(plan));
  text.pop_back();
  return text;
}

}  // namespace stillbase::app
