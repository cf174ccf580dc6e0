// The record of the search: list of candidates, counts, status, certificate, polish of the path.
// All of it is compared with the problem, not with itself.
#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include <stillbase/core/rotation.hpp>

#include "audit/checks.hpp"
#include "audit/equations.hpp"
#include "audit/exclusions.hpp"
#include "audit/manifold.hpp"
#include "audit/search_record.hpp"
#include "audit/tolerances.hpp"
#include "verification/tolerances.hpp"

namespace stillbase::audit {

using namespace verification;

namespace {

/// What a search does without being told, and how its record is compared.
struct SearchRecordOptions {
  int first_starts = 64;             ///< at least, where the problem states no number
  int isolated_starts = 1024;        ///< the same where the equations leave no freedom
  double unseen_level = 0.05;        ///< of an optimal plan whose starts went on in rounds
  double proven_gap = 1e-3;          ///< relative: the prover goes no further
  double same_configuration = 5e-6;  ///< rad, m, s: distance of equal solutions
};
constexpr SearchRecordOptions kSearch;

/// @param problem whole turns of its joints count as nothing
bool is_same(const CaptureProblem& problem, const Configuration& a, const Configuration& b) {
  Eigen::VectorXd apart = a.phi - b.phi;
  for (int k = 0; k < apart.size(); ++k) {
    if (reaches_every_angle(problem, k)) apart[k] = std::remainder(apart[k], 2 * kPi);
  }
  return a.feature == b.feature && apart.norm() <= kSearch.same_configuration &&
         std::abs(a.contact_time - b.contact_time) <= kSearch.same_configuration &&
         pose_error(a.base, b.base).largest() <= kSearch.same_configuration;
}

void check_list(const Context& context, ClaimList& claims) {
  const Plan& plan = context.plan;
  const std::vector<Candidate>& candidates = plan.candidates;
  Objections objections;
  // The last one may be a sample of the self-motion, added for the approach and reached by no
  // start.
  const bool has_sample =
      candidates.size() > 1 && candidates.back().starts_reached == 0 &&
      candidates.back().family < 0 &&
      is_same(context.problem, candidates.back().configuration, plan.configuration);
  const std::size_t count = candidates.size() - (has_sample ? 1 : 0);
  const std::size_t most = static_cast<std::size_t>(context.problem.search.max_candidates);
  const std::size_t distinct = static_cast<std::size_t>(plan.certificate.distinct_solutions);
  objections.demand(count >= 1, "there is none");
  objections.demand(count <= most, "more than the problem keeps");
  objections.demand(count == std::min(distinct, most),
                    fmt::format("{} listed of {} distinct solutions", count, distinct));
  // Number of starts that ended at each solution, or on each curve of solutions.
  std::vector<int> on_curve(plan.families.size(), 0), ended;
  for (std::size_t i = 0; i < count; ++i) {
    if (candidates[i].family < 0) {
      ended.push_back(candidates[i].starts_reached);
      objections.demand(ended.back() >= 1, fmt::format("{} was reached by no start", i));
    } else {
      on_curve[static_cast<std::size_t>(candidates[i].family)] += candidates[i].starts_reached;
    }
  }
  ended.insert(ended.end(), on_curve.begin(), on_curve.end());
  const int reached = std::accumulate(ended.begin(), ended.end(), 0);
  const auto once = std::count(ended.begin(), ended.end(), 1);
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      objections.demand(
          !is_same(context.problem, candidates[i].configuration, candidates[j].configuration),
          fmt::format("{} repeats {}", i, j));
    }
  }
  const bool is_nominal = context.problem.measure.kind == RiskMeasure::Nominal;
  // The minima of a robust measure are solved from more points than the starts.
  objections.demand(!is_nominal || reached <= plan.certificate.starts,
                    "more starts ended here than were made");
  // Good and Turing's estimate follows from a complete list.
  const bool is_whole =
      count == distinct && plan.certificate.proof.found_by_search ==
                               static_cast<int>(plan.certificate.proof.solutions.size());
  const double unseen = static_cast<double>(once) / std::max(reached, 1);
  objections.demand(
      !is_nominal || !is_whole || std::abs(plan.certificate.unseen - unseen) <= 1e-12,
      fmt::format("unseen is {}, the list gives {}", plan.certificate.unseen, unseen));
  // Minima of a robust measure that are on a curve count beside the starts that ended there, and a
  // shortened list may lack some of them.
  for (std::size_t i = 0; i < on_curve.size(); ++i) {
    const int starts = plan.families[i].starts;
    const bool fits = !is_nominal ? !is_whole || starts <= on_curve[i]
                      : is_whole  ? starts == on_curve[i]
                                  : starts >= on_curve[i];
    objections.demand(fits, fmt::format("{} starts ended on curve {}, the list gives {}", starts, i,
                                        on_curve[i]));
  }
  for (const std::string& what : unlisted_curves(context)) objections.add(what);
  claims.none_wrong("candidates_list", objections,
                    "every distinct solution once, as many as the problem keeps, and the sample of "
                    "self-motion of the approach");
}

/// The optimizer, the one that goes on where it stops short, and the planner of the path.
bool is_known_solver(const Context& context, const std::string& name) {
  const ApproachSpec& approach = context.problem.approach;
  if (name == context.plan.optimizer || name == "ipopt") return true;
  return approach.enabled && (name == approach.planner || name == "reaction_null");
}

/// Rounds of starts: where the problem asks for them, and exp(-k) unseen, of k starts at the best.
void check_rounds(const Context& context, Objections& objections) {
  const Certificate& certificate = context.plan.certificate;
  const CaptureProblem& problem = context.problem;
  const bool is_mean_of_residual = problem.measure.kind == RiskMeasure::Expectation &&
                                   problem.uncertainty.residual_velocity.has_value();
  const bool are_possible =
      problem.search.starts == kAutomaticStarts &&
      (problem.measure.kind == RiskMeasure::WorstCase || is_mean_of_residual) &&
      !simulates_turn(problem) && context.plan.objective.user_terms.empty();
  objections.demand(are_possible || !certificate.had_rounds,
                    "rounds of starts that the problem does not ask for");
  const bool is_solved =
      context.plan.status == PlanStatus::Optimal || context.plan.status == PlanStatus::Feasible;
  const bool may_be_isolated = certificate.starts >= kSearch.isolated_starts;
  objections.demand(!are_possible || !is_solved || may_be_isolated || certificate.had_rounds,
                    "no rounds of starts, which the problem asks for");
  if (!certificate.had_rounds) return;
  if (certificate.unseen == 0) {
    objections.demand(is_zero(context, least_value(context)),
                      "unseen is zero, but the measure is not");
    return;
  }
  const double reached = -std::log(certificate.unseen);
  const bool is_count = std::abs(reached - std::round(reached)) <= 1e-9 * std::max(1.0, reached);
  objections.demand(
      is_count, fmt::format("unseen is {}, which no number of starts gives", certificate.unseen));
}

void check_status(const Context& context, ClaimList& claims) {
  const Plan& plan = context.plan;
  const Certificate& certificate = plan.certificate;
  const Proof& proof = certificate.proof;
  Objections objections;
  objections.demand(plan.optimizer == context.problem.search.optimizer,
                    "the optimizer is " + plan.optimizer + ", the problem's is " +
                        context.problem.search.optimizer);
  const bool was_cut = plan.status == PlanStatus::Limit;
  objections.demand(was_cut || plan.solver_calls.count(plan.optimizer) == 1,
                    "no calls of the optimizer");
  for (const auto& [name, calls] : plan.solver_calls) {
    objections.demand(calls >= 1, fmt::format("{} calls of {}", calls, name));
  }
  const int asked = context.problem.search.starts;
  const int least_starts = was_cut ? 1 : asked == kAutomaticStarts ? kSearch.first_starts : asked;
  objections.demand(certificate.starts >= least_starts,
                    fmt::format("{} starts of {}", certificate.starts, least_starts));
  const auto calls_of_optimizer = plan.solver_calls.find(plan.optimizer);
  objections.demand(was_cut || calls_of_optimizer == plan.solver_calls.end() ||
                        calls_of_optimizer->second >= least_starts,
                    "fewer calls of the optimizer than starts");
  for (const auto& [name, calls] : plan.solver_calls) {
    objections.demand(is_known_solver(context, name), name + " is none of the plan's solvers");
  }
  objections.demand(
      (std::isfinite(certificate.kkt_residual) || was_cut) && certificate.kkt_residual >= 0,
      "the KKT residual is no number");
  const bool all_judged =
      plan.objective.is_judged &&
      std::all_of(plan.candidates.begin(), plan.candidates.end(),
                  [](const Candidate& candidate) { return candidate.is_judged; });
  objections.demand(all_judged || (was_cut && simulates_turn(context.problem)),
                    "worst cases that are not evaluated without a limit that was reached");
  const bool is_stationary = certificate.kkt_residual <= kRecord.stationary;
  objections.demand(plan.status != PlanStatus::Optimal || is_stationary,
                    "stated to be optimal with a large KKT residual");
  check_rounds(context, objections);
  // Too few starts may have ended at the best minimum of a worst case.
  const bool may_be_missed = certificate.had_rounds && certificate.unseen > kSearch.unseen_level;
  objections.demand(plan.status != PlanStatus::Optimal || !may_be_missed,
                    fmt::format("stated to be optimal with a better minimum missed with a "
                                "probability of {}",
                                certificate.unseen));
  const auto& loss = plan.choice.loss_percent;
  const bool is_not_best = plan.choice.better > 0 && (!loss || *loss > 0);
  objections.demand(
      plan.status != PlanStatus::Feasible || !is_stationary || may_be_missed || is_not_best,
      "stated to be only feasible with a small KKT residual");
  objections.demand(!proof.gap || *proof.gap >= 0, "the gap of the proof is negative");
  objections.demand(proof.found_by_search <= static_cast<int>(proof.solutions.size()),
                    "the search found more solutions than there are");
  objections.demand(certificate.max_violation <= context.options.constraint_tolerance,
                    "the status is not infeasible, but the violation is large");
  claims.none_wrong("search_record", objections, "optimizer, calls, starts and status fit");
}

/// What the polish reduces, of the path to the posture at rest from which a hand that moves runs
/// to the contact: its time, or the largest change of the base's attitude from there.
double polished(const Approach& approach) {
  std::size_t rest = approach.times.size() - 1;
  while (rest > 0 && !approach.joint_velocities[rest].isZero(0)) --rest;
  if (approach.polish == PathPolish::Time) {
    return approach.duration - (approach.times.back() - approach.times[rest]);
  }
  const Eigen::Quaterniond to_rest = approach.base_poses[rest].orientation.conjugate();
  double largest = 0;
  for (std::size_t i = 0; i < rest; ++i) {
    const Eigen::Quaterniond turn = to_rest * approach.base_poses[i].orientation;
    largest = std::max(largest, rotation_log(turn).norm());
  }
  return largest;
}

/// The numbers of the polish that the plan states.
void check_polish(const Context& context, ClaimList& claims) {
  const Approach& approach = context.plan.approach;
  const ApproachSpec& wanted = context.problem.approach;
  if (wanted.enabled && approach.status == ApproachStatus::Found &&
      approach.polish != wanted.polish) {
    Objections objections;
    objections.add("not what the problem asks for");
    return claims.none_wrong("approach_polish", objections, "what the polish reduces");
  }
  if (approach.polish == PathPolish::None) {
    claims.at_most("approach_polish_stated",
                   std::max(approach.before_polish, approach.after_polish), 0, "s or rad",
                   "numbers of a polish that was not made");
  }
  if (!context.problem.approach.enabled || approach.status != ApproachStatus::Found ||
      approach.polish == PathPolish::None) {
    return;
  }
  const double stated = approach.after_polish;
  claims.at_most("approach_polish", stated - approach.before_polish, 0, "s or rad",
                 "the polished path is no worse than the planned one");
  claims.at_most("approach_polish_stated", std::abs(stated - polished(approach)), kShared.rounding,
                 "s or rad", "stated result of the polish");
}

/// Whether nothing can be better than the chosen configuration: every solution is enclosed and
/// listed, or its measure is zero or no further above a proven bound than a proof leaves open.
bool is_best_there_is(const Context& context) {
  const Plan& plan = context.plan;
  const Proof& proof = plan.certificate.proof;
  const bool is_whole =
      plan.certificate.distinct_solutions <= static_cast<int>(plan.candidates.size());
  const bool is_enclosed = proof.status == ProofStatus::Complete && !proof.solutions.empty() &&
                           !read_statement(proof).are_zeros;
  if (is_enclosed && is_whole) return true;
  if (plan.choice.better != 0) return false;
  const double value = plan.objective.value;
  const bool is_bounded = proof.lower_bound && *proof.lower_bound > 0;
  return is_bounded ? value - *proof.lower_bound <= kSearch.proven_gap * value
                    : is_zero(context, value);
}

/// What only a repeated search can confirm.
void list_search_record(const Context& context, ClaimList& claims) {
  const Plan& plan = context.plan;
  claims.begin(ClaimGroup::SearchRecord);
  const std::string own = kSearchSays;
  claims.not_verified(
      "search_counts",
      own +
          "certificate.starts beyond those of the problem, certificate.distinct_solutions of a "
          "list that was cut, certificate.unseen of a robust measure or a cut list, "
          "candidates.starts_reached, solver_calls");
  claims.not_verified("search_rounding",
                      own +
                          "certificate.kkt_residual below 1e-5, candidates.max_violation below the "
                          "tolerance of the constraints");
  if (!is_best_there_is(context)) {
    claims.not_verified("search_optimum",
                        own +
                            "status optimal, choice.better, choice.loss_percent: that no better "
                            "candidate is missing in the list");
  }
  if (!plan.families.empty())
    claims.not_verified(
        "search_families",
        own + "families.starts, families.length within what the spacing of the points leaves open");
  const Proof& proof = plan.certificate.proof;
  if (proof.status != ProofStatus::NotApplicable || proof.boxes > 0 ||
      read_statement(proof).had_missed_best) {
    claims.not_verified("search_proof",
                        own +
                            "certificate.proof.found_by_search, certificate.proof.boxes of a "
                            "bound, what certificate.proof.statement says of the search and of "
                            "limits that stopped the proof");
  }
  if (plan.approach.status != ApproachStatus::NotRequested) {
    claims.not_verified("search_approach", own + "approach.detail, approach.polish.before");
  }
  if (const std::string reasons = exclusions_by_search(plan); !reasons.empty()) {
    claims.not_verified("search_exclusions", own + "candidates.excluded of " + reasons);
  }
  if (!plan.warnings.empty()) {
    claims.not_verified("search_warnings", own + "warnings.message: the words and numbers");
  }
  if (!plan.nominal_optimum) {
    claims.not_verified("search_nominal_optimum",
                        own + "that objective.nominal_optimum is not known");
  }
  if (plan.status == PlanStatus::Limit) {
    claims.not_verified("search_limit", own + "status: that a limit came first");
  }
}

}  // namespace

double least_value(const Context& context) {
  double least = kInfinity;
  for (const Candidate& candidate : context.plan.candidates) {
    if (!(candidate.max_violation <= context.options.constraint_tolerance)) continue;
    least = std::min(least, candidate.value);
  }
  return least;
}

bool is_zero(const Context& context, double value) {
  if (!context.plan.objective.user_terms.empty()) return false;
  const double size = objective_power(context.problem).length(value);
  return size <= kRecord.zero * typical_objective(context.problem);
}

void check_search_record(const Context& context, ClaimList& claims) {
  check_list(context, claims);
  check_status(context, claims);
  check_polish(context, claims);
  double violation = 0;
  for (const ConstraintValue& c : context.plan.constraints) {
    violation = std::max({violation, c.lower - c.value, c.value - c.upper});
  }
  claims.at_most("certificate_violation",
                 std::abs(context.plan.certificate.max_violation - violation), 1e-12, "1",
                 "largest violation of the certificate from that of the list");
  list_search_record(context, claims);
}

}  // namespace stillbase::audit
