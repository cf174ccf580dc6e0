// What the plan states of all solutions at once: the enclosed ones solve the problem, and they and
// the candidates are the same. `reference` cannot repeat the proof that nothing else exists; an
// independent search from many starts looks for solutions outside the boxes. Likewise only the
// proof shows that no configuration is below the lower bound of the measure; but none of the
// candidates may be, and none that a search by `reference` finds.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <stillbase/core/random.hpp>

#include "audit/checks.hpp"
#include "audit/equations.hpp"
#include "audit/tolerances.hpp"

namespace stillbase::audit {

using namespace verification;

namespace {

bool has_index(const std::vector<Candidate>& candidates, int c) {
  return c >= 0 && c < static_cast<int>(candidates.size());
}

/// Residual of the equations in the middle of a box, relative to the size of the momenta and to 1
/// m.
double residual_at(const Context& context, const Configuration& at) {
  const Situation situation(context.problem, at);
  double residual =
      std::max(hand_residual(situation),
               case_residuals(context.problem, situation.response, situation.impulse()).wanted);
  if (read_statement(context.plan.certificate.proof).are_zeros) {
    const Vector3d& n = situation.event.n;
    residual = std::max(residual, objective_along(situation, n) / scale_along(situation, n));
  }
  return residual;
}

/// All words of the statement follow from the other fields.
void demand_statement(const Context& context, Objections& objections) {
  const std::string objection = statement_objection(context);
  objections.demand(objection.empty(), objection);
}

/// The statement of the proof against its own lists and the candidates.
void check_statement(const Context& context, ClaimList& claims) {
  const Plan& plan = context.plan;
  const Proof& proof = plan.certificate.proof;
  Objections objections;
  const bool complete = proof.status == ProofStatus::Complete;
  const ProofStatement statement = read_statement(proof);
  objections.demand(
      complete ? statement.is_proven : statement.is_undecided,
      fmt::format("the statement does not begin with '{}'", complete ? "proven" : "not decided"));
  objections.demand(
      proof.solutions.empty() || statement.solutions == static_cast<int>(proof.solutions.size()),
      "the statement does not count the enclosed solutions");
  objections.demand(complete == proof.undecided.empty(), "undecided boxes do not fit the status");
  // Of the two halves of a box that is examined, a limit may leave both.
  const long unexamined = complete ? 0 : 1;
  objections.demand(proof.boxes + unexamined >=
                        static_cast<long>(proof.solutions.size() + proof.undecided.size()),
                    "fewer boxes were examined than are listed");
  const bool is_bound = proof.lower_bound && *proof.lower_bound > 0;  // see check_bound()
  if (!is_bound) {
    objections.demand(!proof.lower_bound || (*proof.lower_bound == 0 && statement.are_zeros &&
                                             !proof.solutions.empty()),
                      "the lower bound of a zero is zero");
    std::optional<double> least;
    for (const int c : proof.candidates) {
      if (!has_index(plan.candidates, c) || !proof.lower_bound) continue;
      const double gap = plan.candidates[c].objective - *proof.lower_bound;
      least = least ? std::min(*least, gap) : gap;
    }
    objections.demand(
        least.has_value() == proof.gap.has_value() &&
            (!least || std::abs(*least - *proof.gap) <= kRecord.gap * std::abs(*least)),
        "the gap is not that of the best candidate");
  }
  demand_statement(context, objections);
  claims.none_wrong("proof_statement", objections, "words, counts, lower bound and gap fit");
}

/// Solutions that an own search finds are in the boxes.
void check_completeness(const Context& context, const FreeVariables& variables,
                        const Recount& recount, ClaimList& claims) {
  const Proof& proof = context.plan.certificate.proof;
  if (!recount.not_done.empty()) return;
  Objections outside;
  for (const Configuration& at : recount.solutions) {
    const auto holds = [&](const JointBox& box) { return variables.holds(box, at); };
    if (std::any_of(proof.solutions.begin(), proof.solutions.end(), holds) ||
        std::any_of(proof.undecided.begin(), proof.undecided.end(), holds)) {
      continue;
    }
    std::string posture;
    for (const double x : at.phi) {
      posture += fmt::format("{}{:.6f}", posture.empty() ? "" : ", ", x);
    }
    if (!proof.solutions.empty() && proof.solutions.front().contact_time) {
      posture += fmt::format(" at {:.6f} s", at.contact_time);
    }
    outside.add("(" + posture + ")");
  }
  claims.none_wrong("proof_recount", outside,
                    fmt::format("postures that solve the problem and are in no box of the proof: a "
                                "search from {} starts found {} (a search, no proof)",
                                recount.starts, recount.solutions.size()));
}

/// The search for a configuration below a bound.
struct BoundSearchOptions {
  int starts = 100;
  int descents = 4;         ///< from the best starts
  int steps = 60;           ///< of each descent
  double first_step = 0.3;  ///< in each variable, in its unit
  double longer = 1.5;      ///< factor of the step after one that found less
  double shorter = 0.85;    ///< after one that did not: steady where two in seven do
};
constexpr BoundSearchOptions kBoundSearch;

/// Configurations with the hand at its contact that the problem allows, and their measure.
class AllowedConfigurations {
 public:
  explicit AllowedConfigurations(const Context& context)
      : context_(context),
        variables_(context.problem),
        equations_(context.problem, variables_, Equations::Demand::Hand) {}

  Eigen::VectorXd start(int index) const {
    return variables_.sample(low_discrepancy_point(index, variables_.size(), 1));
  }

  /// Projected onto the hand's equations; empty: not possible within the bounds.
  std::optional<Eigen::VectorXd> project(const Eigen::VectorXd& x) const {
    auto out = equations_.solve(x);
    if (!out || !variables_.bring_inside(*out)) return std::nullopt;
    if (!equations_.keeps_inequalities(variables_.at(*out))) return std::nullopt;
    return out;
  }

  double measure(const Eigen::VectorXd& x) const {
    return measure_value(Situation(context_.problem, variables_.at(x)),
                         std::min(kRecord.cone_samples, context_.options.cone_samples));
  }
  double measure(const JointBox& box) const { return measure(variables_.middle_of(box)); }

 private:
  const Context& context_;
  FreeVariables variables_;
  Equations equations_;
};

struct Found {
  Eigen::VectorXd x;
  double value = 0;

  bool operator<(const Found& other) const { return value < other.value; }
};

/// The least measure of random configurations and of random descents from the best of them.
std::optional<double> search_below(const Context& context,
                                   const AllowedConfigurations& configurations) {
  const StopCondition& stop = context.options.stop;
  std::vector<Found> found;
  for (int s = 0; s < kBoundSearch.starts && !stop.reached(); ++s) {
    const auto x = configurations.project(configurations.start(s));
    if (x) found.push_back({*x, configurations.measure(*x)});
  }
  if (found.empty()) return std::nullopt;
  std::sort(found.begin(), found.end());
  if (found.size() > kBoundSearch.descents) found.resize(kBoundSearch.descents);
  for (std::size_t i = 0; i < found.size(); ++i) {
    Random random(7, i);
    double step = kBoundSearch.first_step;
    for (int k = 0; k < kBoundSearch.steps && !stop.reached(); ++k) {
      Eigen::VectorXd x = found[i].x;
      for (double& entry : x) entry += step * random.uniform(-1, 1);
      const auto next = configurations.project(x);
      const double value = next ? configurations.measure(*next) : kInfinity;
      const bool is_better = value < found[i].value;
      if (is_better) found[i] = {*next, value};
      step *= is_better ? kBoundSearch.longer : kBoundSearch.shorter;
    }
  }
  return std::min_element(found.begin(), found.end())->value;
}

/// The least measure of the enclosed solutions: all there is where a case leaves single
/// configurations and the bound counts it.
std::optional<double> least_of_solutions(const Proof& proof,
                                         const AllowedConfigurations& configurations) {
  std::optional<double> least;
  for (const JointBox& box : proof.solutions) {
    const double value = configurations.measure(box);
    least = least ? std::min(*least, value) : value;
  }
  return least;
}

constexpr int kMostVariables = 3;  ///< that a bound is proven over

/// Variables of a problem that a bound cannot do without: of a base attitude that is free about
/// more than one axis two, for only the direction of the impulse in B may matter.
int fewest_variables(const CaptureProblem& problem) {
  const VariableSpec& variables = problem.variables;
  const bool follows_target = !problem.impulse.direction;
  const bool faces_inertial = follows_target ||
                              problem.impulse.direction_frame == Frame::Inertial ||
                              (problem.hand.position && problem.hand.frame == Frame::Inertial);
  int count = static_cast<int>(std::count(variables.joints.begin(), variables.joints.end(), true));
  if (faces_inertial && variables.base_attitude != AttitudeFreedom::Fixed) {
    count += variables.base_attitude == AttitudeFreedom::Axis ? 1 : 2;
  }
  const bool time_is_free = variables.contact_time_upper > variables.contact_time_lower;
  return count + (follows_target && time_is_free ? 1 : 0);
}

/// Words, boxes and gap of the bound. @return the least measure of the candidates
double check_bound_statement(const Context& context, double bound, ClaimList& claims) {
  const Plan& plan = context.plan;
  const Proof& proof = plan.certificate.proof;
  const ProofStatement statement = read_statement(proof);
  Objections objections;
  objections.demand(statement.bounded == context.problem.measure.kind,
                    "the statement does not say what is bounded");
  objections.demand(statement.is_proven || proof.status == ProofStatus::Undecided,
                    "the statement does not begin with 'proven'");
  objections.demand(proof.boxes > 0, "no box was examined");
  const int free = fewest_variables(context.problem);
  objections.demand(
      free <= kMostVariables,
      fmt::format("a bound takes at most {} free variables, here are {}", kMostVariables, free));
  bool is_gap = false;
  double least = plan.objective.value;
  for (const Candidate& candidate : plan.candidates) {
    if (!(candidate.max_violation <= context.options.constraint_tolerance)) continue;
    least = std::min(least, candidate.value);
    const double gap = candidate.value - bound;
    is_gap = is_gap || (proof.gap && std::abs(*proof.gap - gap) <= kRecord.gap * bound);
  }
  objections.demand(is_gap, "the gap is that of no candidate");
  objections.demand(!proof.gap || least - bound <= *proof.gap + kRecord.gap * bound,
                    "a candidate is nearer to the bound than the gap");
  claims.none_wrong("proof_bound_statement", objections, "words, boxes and gap of the bound fit");
  return least;
}

/// A proof that does not apply encloses nothing, and without a bound it says so.
void check_nothing_proven(const Context& context, ClaimList& claims) {
  const Proof& proof = context.plan.certificate.proof;
  Objections objections;
  objections.demand(proof.solutions.empty() && proof.undecided.empty() && proof.candidates.empty(),
                    "boxes of a proof that does not apply");
  objections.demand(proof.found_by_search == 0, "solutions of a proof that does not apply");
  if (!proof.lower_bound) {
    const ProofStatement statement = read_statement(proof);
    objections.demand(!statement.is_proven, "the statement begins with 'proven'");
    objections.demand(proof.statement.rfind("no proof", 0) == 0,
                      "the statement does not begin with 'no proof'");
    objections.demand(!proof.gap, "a gap without a bound");
  }
  demand_statement(context, objections);
  claims.none_wrong("proof_statement", objections, "no solutions are enclosed, and the words fit");
}

}  // namespace

void check_proof(const Context& context, ClaimList& claims) {
  const Plan& plan = context.plan;
  const Proof& proof = plan.certificate.proof;
  if (proof.status == ProofStatus::NotApplicable) return check_nothing_proven(context, claims);
  const FreeVariables variables(context.problem);
  const bool are_zeros = read_statement(proof).are_zeros;
  const Equations equations(context.problem, variables,
                            are_zeros ? Equations::Demand::Zero : Equations::Demand::HandAndCase);
  const Recount recount = search_solutions(context);
  double worst = 0;
  Objections unlisted, unproven;
  std::vector<int> boxes_of(plan.candidates.size(), 0);
  const bool was_cut =
      plan.certificate.distinct_solutions > static_cast<int>(plan.candidates.size());
  for (std::size_t s = 0; s < proof.solutions.size(); ++s) {
    const JointBox& box = proof.solutions[s];
    worst = std::max(worst, residual_at(context, variables.at(variables.middle_of(box))));
    const int c = s < proof.candidates.size() ? proof.candidates[s] : -1;
    const std::size_t index = static_cast<std::size_t>(c);
    if (has_index(plan.candidates, c) &&
        equations.leads_to(box, plan.candidates[index].configuration)) {
      ++boxes_of[index];
    } else if (c >= 0 || !was_cut) {
      unlisted.add(fmt::format("solution {}", s));
    }
  }
  claims.at_most("proof_residual", worst, context.options.constraint_tolerance, "1",
                 "largest relative residual in the middle of an enclosed solution");
  claims.none_wrong("proof_solutions_listed", unlisted,
                    "enclosed solutions without their candidate");
  // With remaining freedom, candidates may be local minima at which the objective is not zero.
  const bool is_whole_list = !recount.asks_for_zero && recount.not_done.empty();
  for (std::size_t c = 0; is_whole_list && c < boxes_of.size(); ++c) {
    const Configuration& at = plan.candidates[c].configuration;
    const bool is_open = std::any_of(proof.undecided.begin(), proof.undecided.end(),
                                     [&](const JointBox& box) { return variables.holds(box, at); });
    unproven.demand(boxes_of[c] == 1 || (boxes_of[c] == 0 && is_open),
                    fmt::format("candidate {} in {} of them", c, boxes_of[c]));
  }
  claims.none_wrong(
      "proof_candidates_enclosed", unproven,
      "candidates that are neither in exactly one enclosed solution nor in an undecided box");
  check_statement(context, claims);
  check_completeness(context, variables, recount, claims);
}

void check_bound(const Context& context, ClaimList& claims) {
  const Proof& proof = context.plan.certificate.proof;
  if (!proof.lower_bound || !(*proof.lower_bound > 0)) return;
  const double bound = *proof.lower_bound;
  const std::string unit = objective_unit_name(context.problem);
  const double least = check_bound_statement(context, bound, claims);
  claims.at_least("proof_bound", least, bound, kRecord.bound * bound, unit,
                  fmt::format("least measure of the candidates; none may be below {:.9g}", bound));

  const AllowedConfigurations configurations(context);
  const bool counts_case = context.problem.constraints.impact_case != CaseConstraint::None &&
                           !read_statement(proof).leaves_out_case;
  const std::optional<double> found = counts_case ? least_of_solutions(proof, configurations)
                                                  : search_below(context, configurations);
  if (!found) return;  // a random search does not reach so few configurations
  claims.at_least("proof_bound_searched", *found, bound, kRecord.bound * bound, unit,
                  fmt::format("least measure of random configurations; none may be below {:.9g} "
                              "(a search, no proof)",
                              bound));
}

}  // namespace stillbase::audit
