// The lower bound of the measure. Only the proof shows that no posture at all is below it; but none
// of the candidates may be, and none that a search by `reference` finds.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <stillbase/core/random.hpp>

#include "audit/checks.hpp"
#include "audit/equations.hpp"

namespace stillbase::audit {
namespace {

constexpr double kRounding = 1e-9;  ///< relative
constexpr int kBoundStarts = 100;
constexpr int kDescents = 4;  ///< of the best starts
constexpr int kSteps = 60;    ///< of each descent
constexpr int kConeSamples = 60;

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
                         std::min(kConeSamples, context_.options.cone_samples));
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
  for (int s = 0; s < kBoundStarts && !stop.reached(); ++s) {
    const auto x = configurations.project(configurations.start(s));
    if (x) found.push_back({*x, configurations.measure(*x)});
  }
  if (found.empty()) return std::nullopt;
  std::sort(found.begin(), found.end());
  if (found.size() > kDescents) found.resize(kDescents);
  for (std::size_t i = 0; i < found.size(); ++i) {
    Random random(7, i);
    double step = 0.3;
    for (int k = 0; k < kSteps && !stop.reached(); ++k) {
      Eigen::VectorXd x = found[i].x;
      for (double& entry : x) entry += step * random.uniform(-1, 1);
      const auto next = configurations.project(x);
      const double value = next ? configurations.measure(*next) : kInfinity;
      const bool is_better = value < found[i].value;
      if (is_better) found[i] = {*next, value};
      step *= is_better ? 1.5 : 0.85;
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
  bool is_gap = false;
  double least = plan.objective.value;
  for (const Candidate& candidate : plan.candidates) {
    if (!(candidate.max_violation <= context.options.constraint_tolerance)) continue;
    least = std::min(least, candidate.value);
    const double gap = candidate.value - bound;
    is_gap = is_gap || (proof.gap && std::abs(*proof.gap - gap) <= kGapRounding * bound);
  }
  objections.demand(is_gap, "the gap is that of no candidate");
  objections.demand(!proof.gap || least - bound <= *proof.gap + kGapRounding * bound,
                    "a candidate is nearer to the bound than the gap");
  claims.none_wrong("proof_bound_statement", objections, "words, boxes and gap of the bound fit");
  return least;
}

}  // namespace

void check_bound(const Context& context, ClaimList& claims) {
  const Proof& proof = context.plan.certificate.proof;
  if (!proof.lower_bound || !(*proof.lower_bound > 0)) return;
  const double bound = *proof.lower_bound;
  const std::string unit = objective_unit_name(context.problem);
  const double least = check_bound_statement(context, bound, claims);
  claims.at_least("proof_bound", least, bound, kRounding * bound, unit,
                  fmt::format("least measure of the candidates; none may be below {:.9g}", bound));

  const AllowedConfigurations configurations(context);
  const bool counts_case = context.problem.constraints.impact_case != CaseConstraint::None &&
                           !read_statement(proof).leaves_out_case;
  const std::optional<double> found = counts_case ? least_of_solutions(proof, configurations)
                                                  : search_below(context, configurations);
  if (!found) return;  // a random search does not reach so few configurations
  claims.at_least("proof_bound_searched", *found, bound, kRounding * bound, unit,
                  fmt::format("least measure of random configurations; none may be below {:.9g} "
                              "(a search, no proof)",
                              bound));
}

}  // namespace stillbase::audit
