// What a plan says to be proven, proven again by the program's own prover.
#include <algorithm>
#include <cmath>
#include <string_view>

#include <fmt/format.h>

#include "audit/checks.hpp"
#include "audit/equations.hpp"
#include "audit/smooth_parts.hpp"
#include "audit/tolerances.hpp"
#include "plan/proof_words.hpp"
#include "verification/margins.hpp"

namespace stillbase::audit {

using namespace verification;

namespace {

/// What a repeated proof begins with, and how far it goes.
struct RepeatedProofOptions {
  double limit_margin = 1e-7;  ///< nearer to a limit than this is undecided
  double inside_cone = 1e-10;  ///< rad towards the axis: no direction is outside
  int rim_directions = 24;     ///< that a bound of a worst case begins with
  /// Boxes of a repeated bound, which from other directions may progress slowly: so many times
  /// those stated, and so many more, which are not what an altered plan says.
  long more_boxes = 3, boxes_at_least = 10'000;
  double nearly_best = 1.02;  ///< of the least measure: their worst directions count
};
constexpr RepeatedProofOptions kRepeatedProof;

/// Whether a box's middle keeps the limits on rates, singular values and distances.
WithinLimits judge_limits(const CaptureProblem& problem, const JointBox& box) {
  const FreeVariables variables(problem);
  Configuration at = variables.at(variables.middle_of(box));
  {
    const Situation there(problem, at);
    const bool has_point = problem.hand.position || there.event.feature;
    if (problem.variables.base_position != PositionFreedom::Fixed && has_point) {
      at.base.position +=
          (problem.hand.position ? *problem.hand.position : there.event.feature->point) -
          there.hand_N;
    }
  }
  const double room = least_margin(Situation(problem, at));
  if (room < -kRepeatedProof.limit_margin) return WithinLimits::No;
  return room > kRepeatedProof.limit_margin ? WithinLimits::Yes : WithinLimits::Undecided;
}

bool overlap(const JointBox& a, const JointBox& b) {
  const auto ends_overlap = [](const std::optional<Ends>& one, const std::optional<Ends>& other) {
    if (!one || !other) return one.has_value() == other.has_value();
    return one->lower <= other->upper && other->lower <= one->upper;
  };
  return (a.lower.array() <= b.upper.array()).all() && (b.lower.array() <= a.upper.array()).all() &&
         ends_overlap(a.base_angle, b.base_angle) && ends_overlap(a.contact_time, b.contact_time);
}

void compare_boxes(const char* name, const std::vector<JointBox>& stated,
                   const std::vector<JointBox>& found, Objections& objections) {
  objections.demand(stated.size() == found.size(),
                    fmt::format("{} {} stated, {} found", stated.size(), name, found.size()));
  for (std::size_t i = 0; i < stated.size(); ++i) {
    objections.demand(std::any_of(found.begin(), found.end(),
                                  [&](const JointBox& box) { return overlap(box, stated[i]); }),
                      fmt::format("number {} of the {} is not among those found", i, name));
  }
}

/// The encounters along the worst directions at a configuration. @param nominal encounter
std::vector<WorstEncounter> worst_at(const CaptureProblem& problem,
                                     const Configuration& configuration, const Scenario& nominal) {
  const Situation at(problem, configuration);
  const bool is_in_base =
      problem.impulse.direction && problem.impulse.direction_frame == Frame::Base;
  Eigen::Quaterniond R_EB = Eigen::Quaterniond::Identity();
  if (!problem.impulse.direction) {
    R_EB = at.event.R_NT.conjugate() * at.at.base.orientation;
  } else if (!is_in_base) {
    R_EB = at.at.base.orientation;
  }
  std::vector<WorstEncounter> out;
  for (const Vector3d& d : SmoothParts(at).worst_directions(at)) {
    const double length = std::sqrt(square_of(problem, at.response, at.impulse(d)));
    out.push_back({nominal, objective_power(problem).value(length)});
    out.back().scenario.direction =
        (R_EB * d + kRepeatedProof.inside_cone * nominal.direction).normalized();
  }
  return out;
}

/// Encounters over which a bound is repeated: all samples, or the worst directions of the best
/// candidates and the rim of the cone.
std::vector<Scenario> scenarios_of(const Context& context, double best) {
  const CaptureProblem& problem = context.problem;
  if (is_sampled(problem.measure.kind)) return draw_scenarios(problem);
  const bool is_worst_case = problem.measure.kind == RiskMeasure::WorstCase;
  const bool is_in_base =
      problem.impulse.direction && problem.impulse.direction_frame == Frame::Base;
  // The plane of a wedge may rotate with the base: then only its middle is known beforehand.
  const bool is_known = is_in_base || !problem.uncertainty.cone_plane_normal;
  std::vector<Scenario> out =
      rim_scenarios(problem, is_worst_case && is_known ? kRepeatedProof.rim_directions : 0);
  out.resize(is_worst_case && is_known ? out.size() : 1);
  if (!is_worst_case || !is_known) return out;
  const Vector3d n = out.front().direction;
  for (std::size_t i = 1; i < out.size(); ++i) {
    out[i].direction = (out[i].direction + kRepeatedProof.inside_cone * n).normalized();
  }
  for (const Candidate& candidate : context.plan.candidates) {
    if (candidate.value > kRepeatedProof.nearly_best * best) continue;
    for (const WorstEncounter& worst : worst_at(problem, candidate.configuration, out.front())) {
      out.push_back(worst.scenario);
    }
  }
  return out;
}

/// Whether a statement is this one, or goes on after it.
bool begins_with(const std::string& statement, const std::string& first) {
  if (statement.rfind(first, 0) != 0) return false;
  const std::string_view rest = std::string_view(statement).substr(first.size());
  return rest.empty() || rest.front() == ',' || rest.front() == ';';
}

/// Why nothing was proven, where the problem itself is the reason.
void check_reason(const Proof& stated, const Proof& found, ClaimList& claims) {
  Objections objections;
  objections.demand(begins_with(stated.statement, found.statement),
                    "the statement does not begin with '" + found.statement + "'");
  objections.demand(stated.boxes == found.boxes,
                    fmt::format("{} boxes stated, {} examined", stated.boxes, found.boxes));
  claims.none_wrong("proof_repeated", objections, "why nothing is proven");
}

/// Whether the statement gives a reason that the prover itself would give.
bool is_reason_of_prover(const Context& context) {
  const std::string& text = context.plan.certificate.proof.statement;
  return !text.starts_with(kNothingProven) && !text.starts_with(kUserFunctionsNotEnclosed) &&
         context.problem.variables.features.empty();
}

void check_enclosure(const Context& context, const Proof& found, ClaimList& claims) {
  const Proof& stated = context.plan.certificate.proof;
  Objections objections;
  objections.demand(found.status == stated.status, "the status is " + to_string(stated.status) +
                                                       ", found was " + to_string(found.status));
  compare_boxes("enclosed solutions", stated.solutions, found.solutions, objections);
  compare_boxes("undecided boxes", stated.undecided, found.undecided, objections);
  objections.demand(begins_with(stated.statement, found.statement),
                    "the statement does not begin with '" + found.statement + "'");
  const bool has_bound = stated.statement.find("; ") != std::string::npos;
  objections.demand(has_bound ? stated.boxes >= found.boxes : stated.boxes == found.boxes,
                    fmt::format("{} boxes stated, {} examined", stated.boxes, found.boxes));
  claims.none_wrong("proof_repeated", objections,
                    fmt::format("the proof repeated: {} boxes examined", found.boxes));
}

void check_repeated_bound(const Context& context, const Prover& prover, const Proof& enclosed,
                          ClaimList& claims) {
  const char* const name = "proof_bound_repeated";
  const CaptureProblem& problem = context.problem;
  const double bound = *context.plan.certificate.proof.lower_bound;
  const std::string unit = objective_unit_name(problem);
  const std::string objection = prover.minimum_objection(problem);
  if (!objection.empty()) {
    return claims.none_wrong(
        name,
        [&] {
          Objections out;
          out.add(objection);
          return out;
        }(),
        "the measure of this problem has no bound");
  }
  double best = context.plan.objective.value;
  for (const Candidate& candidate : context.plan.candidates) best = std::min(best, candidate.value);
  MinimumOptions options;
  options.stop = context.options.stop;
  const long stated = std::min(context.plan.certificate.proof.boxes, options.max_boxes);
  options.max_boxes = std::min(options.max_boxes,
                               kRepeatedProof.more_boxes * stated + kRepeatedProof.boxes_at_least);
  options.relative_gap = std::max(0.0, (best - bound) / best);
  options.value_at = [&](const Configuration& at) {
    const Situation there(problem, at);
    if (!configuration_objections(there, context.options).empty()) return kInfinity;
    return measure_value(there, context.cone_samples());
  };
  const std::vector<Scenario> known = scenarios_of(context, best);
  if (problem.measure.kind == RiskMeasure::WorstCase && known.size() > 1) {
    options.worst_at = [&](const Configuration& at) {
      return worst_at(problem, at, known.front());
    };
  }
  const MinimumBound found = prover.prove_minimum(problem, known, enclosed, best, options);
  double least = kInfinity;
  for (const Configuration& at : found.suspects) least = std::min(least, options.value_at(at));
  if (least < bound * (1 - kRecord.bound)) {
    return claims.at_least(name, least, bound, kRecord.bound * bound, unit,
                           "measure of a configuration that the prover found");
  }
  if (found.lower_bound < bound * (1 - kRecord.bound)) {
    return claims.not_verified(
        name, fmt::format("repeated, the bound reaches {:.6g} of the stated {:.6g} {} in {} boxes",
                          found.lower_bound, bound, unit, found.boxes));
  }
  claims.at_least(name, found.lower_bound, bound, kRecord.bound * bound, unit,
                  fmt::format("the bound repeated: {} boxes examined", found.boxes));
}

}  // namespace

void check_repeated_proof(const Context& context, ClaimList& claims) {
  const Plan& plan = context.plan;
  const Proof& stated = plan.certificate.proof;
  const bool is_enclosed = stated.status != ProofStatus::NotApplicable;
  const bool is_bounded = stated.lower_bound && *stated.lower_bound > 0;
  const Prover* prover = context.options.prover;
  if (!is_enclosed && !is_bounded) {
    if (prover == nullptr || plan.status == PlanStatus::Limit || !is_reason_of_prover(context)) {
      return;
    }
  } else if (prover == nullptr || plan.status == PlanStatus::Limit) {
    const char* reason =
        prover == nullptr ? "nothing repeats the proof here" : "a limit may have ended the proof";
    return claims.not_verified("proof_repeated", reason);
  }
  ProofOptions options;
  options.stop = context.options.stop;
  options.judge = [&](const JointBox& box) { return judge_limits(context.problem, box); };
  const Proof found = prover->prove(context.problem, options);
  if (options.stop.reached()) {
    return claims.not_evaluated("proof_repeated", 0, "1", "stopped before its end");
  }
  if (is_enclosed) check_enclosure(context, found, claims);
  if (!is_enclosed && !is_bounded) check_reason(stated, found, claims);
  if (is_bounded) check_repeated_bound(context, *prover, found, claims);
}

}  // namespace stillbase::audit
