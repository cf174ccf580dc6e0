// The lower bound of the measure. That no posture at all is below it is the proof's own word; but
// none of the candidates may be, and neither may what a search by `reference` finds.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <stillbase/core/random.hpp>

#include "verification/checks.hpp"
#include "verification/free_variables.hpp"
#include "verification/recount.hpp"
#include "verification/worst_direction.hpp"

namespace stillbase::verification {
namespace {

constexpr double kRounding = 1e-9;  // relative
constexpr int kStarts = 100;
constexpr int kDescents = 4;
constexpr int kSteps = 60;
constexpr int kConeSamples = 60;

/// Configurations that the problem allows, but for what a bound does not count, and what they are
/// worth.
class Configurations {
 public:
  explicit Configurations(const Context& context)
      : context_(context), problem_(context.problem), variables_(problem_) {
    if (problem_.impulse.direction) return;
    const Configuration last{problem_.start, problem_.base, problem_.variables.contact_time_upper};
    motion_ =
        target_motion(problem_, last, Vector3d::Zero(), problem_.variables.contact_time_lower);
  }

  Eigen::VectorXd start(int index) const {
    const Eigen::VectorXd u = low_discrepancy_point(index, variables_.size(), 1);
    return variables_.sample(u);
  }

  /// Moved by a step of this size in a random direction.
  static Eigen::VectorXd beside(Eigen::VectorXd x, double step, Random& random) {
    for (double& entry : x) entry += step * random.uniform(-1, 1);
    return x;
  }

  /// Brought to where the hand has to be (Gauss-Newton); empty: it does not get there within the
  /// bounds.
  std::optional<Eigen::VectorXd> allowed(Eigen::VectorXd x) const {
    for (int iteration = 0; asks_for_hand() && iteration < 30; ++iteration) {
      const Vector6d off = rows(x);
      if (off.norm() <= 1e-11) break;
      if (iteration == 29) return std::nullopt;
      Eigen::Matrix<double, 6, Eigen::Dynamic> J(6, x.size());
      for (Eigen::Index i = 0; i < x.size(); ++i) {
        const Eigen::VectorXd step = kDifference * Eigen::VectorXd::Unit(x.size(), i);
        J.col(i) = (rows(x + step) - rows(x - step)) / (2 * kDifference);
      }
      Eigen::VectorXd step = -J.completeOrthogonalDecomposition().solve(off);
      if (step.norm() > 0.5) step *= 0.5 / step.norm();
      x += step;
    }
    if (!variables_.bring_inside(x)) return std::nullopt;
    const Configuration at = variables_.at(x);
    const reference::Dynamics dynamics = reference::compute(problem_.robot, {at.phi, {}, {}});
    if (!keeps_inequalities(problem_, event_at(at), at, dynamics)) return std::nullopt;
    return x;
  }

  /// The problem's measure: as predicted, the largest value over the cone, or over its samples.
  double measure(const Configuration& at) const {
    const PostureResponse response = posture_response(problem_, at.phi);
    const RiskMeasure kind = problem_.measure.kind;
    if (kind == RiskMeasure::Expectation || kind == RiskMeasure::Cvar) {
      return sampled_measure(problem_, motion_ ? &*motion_ : nullptr, at, response);
    }
    const ContactEvent event = event_at(at);
    const auto value = [&](const Vector3d& d) {
      return objective_value(problem_, response, impulse_along(problem_, event, response, d));
    };
    if (kind != RiskMeasure::WorstCase) return value(event.n);
    return worst_over_cone(value, event.n, problem_.uncertainty.cone_half_angle,
                           problem_.uncertainty.cone_plane_normal,
                           std::min(kConeSamples, context_.options.cone_samples))
        .value;
  }
  double measure(const Eigen::VectorXd& x) const { return measure(variables_.at(x)); }
  double measure(const JointBox& place) const {
    return measure(variables_.at(variables_.middle_of(place)));
  }

 private:
  static constexpr double kDifference = 1e-6;  ///< rad, m; step of the differences

  bool asks_for_hand() const { return problem_.hand.constraint != HandConstraint::None; }

  ContactEvent event_at(const Configuration& at) const {
    return contact_event(problem_, motion_ ? &*motion_ : nullptr, at);
  }

  Vector6d rows(const Eigen::VectorXd& x) const {
    const Configuration at = variables_.at(x);
    return hand_rows(problem_, event_at(at), at,
                     reference::compute(problem_.robot, {at.phi, {}, {}}));
  }

  const Context& context_;
  const CaptureProblem& problem_;
  FreeVariables variables_;
  std::optional<TargetMotion> motion_;  ///< of a predicted target
};

struct Found {
  Eigen::VectorXd x;
  double value = 0;
};

/// The least measure that random configurations and random steps from the best of them lead to.
std::optional<double> search_below(const Context& context, const Configurations& configurations) {
  std::vector<Found> found;
  for (int s = 0; s < kStarts && !context.options.stop.reached(); ++s) {
    const auto x = configurations.allowed(configurations.start(s));
    if (x) found.push_back({*x, configurations.measure(*x)});
  }
  std::sort(found.begin(), found.end(),
            [](const Found& a, const Found& b) { return a.value < b.value; });
  if (found.size() > kDescents) found.resize(kDescents);
  for (std::size_t i = 0; i < found.size(); ++i) {
    Random random(7, i);
    double step = 0.3;
    for (int k = 0; k < kSteps && !context.options.stop.reached(); ++k) {
      const auto next = configurations.allowed(Configurations::beside(found[i].x, step, random));
      const double value = next ? configurations.measure(*next) : kInfinity;
      if (value < found[i].value) {
        found[i] = {*next, value};
        step *= 1.5;
      } else {
        step *= 0.85;
      }
    }
  }
  if (found.empty()) return std::nullopt;
  return std::min_element(found.begin(), found.end(),
                          [](const Found& a, const Found& b) { return a.value < b.value; })
      ->value;
}

/// Where a case leaves single configurations and the bound counts it, they are all there is.
std::optional<double> least_of_solutions(const Proof& proof, const Configurations& configurations) {
  std::optional<double> least;
  for (const JointBox& place : proof.solutions) {
    const double value = configurations.measure(place);
    least = least ? std::min(*least, value) : value;
  }
  return least;
}

/// What the measure is called in the words of a bound.
std::string measure_words(const CaptureProblem& problem) {
  switch (problem.measure.kind) {
    case RiskMeasure::Nominal:
      return "a predicted ";
    case RiskMeasure::WorstCase:
      return "a worst case";
    case RiskMeasure::Expectation:
      return "an expected ";
    case RiskMeasure::Cvar:
      return "a CVaR of ";
  }
  return "";
}

}  // namespace

void check_bound(const Context& context, ClaimList& claims) {
  const Plan& plan = context.plan;
  const Proof& proof = plan.certificate.proof;
  if (!proof.lower_bound || !(*proof.lower_bound > 0)) return;
  const double bound = *proof.lower_bound;
  const CaptureProblem& problem = context.problem;
  const std::string unit = objective_unit_name(problem);

  std::vector<std::string> objections;
  const auto demand = [&](bool holds, const std::string& what) {
    if (!holds) objections.push_back(what);
  };
  const std::string has = " has " + measure_words(problem);
  demand(proof.statement.find("no posture" + has) != std::string::npos ||
             proof.statement.find("no configuration" + has) != std::string::npos,
         "the statement does not say what is bounded");
  demand(proof.statement.compare(0, 6, "proven") == 0 || proof.status == ProofStatus::Undecided,
         "the statement does not begin with 'proven'");
  demand(proof.boxes > 0, "no box was looked at");
  bool is_gap = false;
  double least = plan.objective.value;
  for (const Candidate& candidate : plan.candidates) {
    if (!(candidate.max_violation <= context.options.constraint_tolerance)) continue;
    least = std::min(least, candidate.value);
    is_gap = is_gap || (proof.gap && *proof.gap == candidate.value - bound);
  }
  demand(is_gap, "the gap is that of no candidate");
  demand(!proof.gap || least - bound <= *proof.gap,
         "a candidate is nearer to the bound than the gap");
  claims.none_wrong("proof_bound_statement", objections, "words, boxes and gap of the bound fit");
  claims.at_least("proof_bound", least, bound, kRounding * bound, unit,
                  fmt::format("least measure of the candidates; none may be below {:.9g}", bound));

  const Configurations configurations(context);
  const bool counts_case = problem.constraints.impact_case != CaseConstraint::None &&
                           proof.statement.find("the case") == std::string::npos;
  const std::optional<double> found = counts_case ? least_of_solutions(proof, configurations)
                                                  : search_below(context, configurations);
  if (!found) return;  // too few configurations to be met by chance
  claims.at_least(
      "proof_bound_searched", *found, bound, kRounding * bound, unit,
      fmt::format("least measure that random configurations lead to; none may be below {:.9g} "
                  "(it proves nothing; the proof does)",
                  bound));
}

}  // namespace stillbase::verification
