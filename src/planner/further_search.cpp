#include "planner/further_search.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

#include <stillbase/formulation/measures/robust.hpp>
#include <stillbase/plan/free_roll.hpp>

#include "formulation/measures/measure.hpp"
#include "formulation/projection.hpp"
#include "planner/candidates.hpp"
#include "planner/self_motion.hpp"
#include "search/continua.hpp"
#include "search/ranking.hpp"
#include "search/roll.hpp"
#include "search/solution_curve.hpp"

namespace stillbase {

namespace {

/// The problem with limits after the impact as constraints: joints keep `margin` from their stops,
/// and rates right after the nominal impact are at most `scale` times the robot's rate limits,
/// unless rates are constrained or a joint has no limit.
CaptureProblem with_limits_as_constraints(CaptureProblem problem, double margin, double scale) {
  const bool is_limited =
      std::all_of(problem.robot.joints.begin(), problem.robot.joints.end(),
                  [](const Joint& joint) { return std::isfinite(joint.max_velocity); });
  ConstraintSpec& constraints = problem.constraints;
  if (is_limited && constraints.joint_rate_max.size() == 0 && !constraints.joint_rate_scale) {
    constraints.joint_rate_scale = scale;
  }
  constraints.joint_limit_margin = std::max(constraints.joint_limit_margin, margin);
  return problem;
}

/// What the search states of its own solutions and a further one has to be asked for: the curve of
/// zeros on which a candidate is, or the roll of its last joint that is free.
class Continuum {
 public:
  Continuum(const CaptureProblem& problem, const Formulation& formulation,
            const SearchOptions& options)
      : problem_(problem),
        formulation_(formulation),
        options_(options),
        measure_(problem, formulation) {}

  /// Sets the candidate's family, a new one behind the others where it is on none of them.
  /// @return false: but for a free roll the candidate is a listed one
  bool place(const Eigen::VectorXd& x, Candidate& candidate, SearchResult& found) {
    if (formulation_.freedom() == 0 || simulates_turn(problem_)) return true;
    if (place_on_curve(x, candidate, found) || !problem_.user.empty()) return true;
    std::function<double(const Eigen::VectorXd&)> value;
    if (!measure_.is_nominal()) value = [this](const auto& at) { return measure_.value(at); };
    auto roll = roll_through(problem_, formulation_, x, value, options_.jobs);
    if (!roll) return true;
    if (is_listed(*roll, found)) return false;
    add(std::move(*roll), candidate, found);
    return true;
  }

 private:
  static void add(SolutionFamily family, Candidate& candidate, SearchResult& found) {
    family.starts = candidate.starts_reached;
    candidate.family = static_cast<int>(found.families.size());
    found.families.push_back(std::move(family));
  }

  bool place_on_curve(const Eigen::VectorXd& x, Candidate& candidate, SearchResult& found) const {
    const ContinuumOptions& options = options_.continua;
    const Continua own = follow_continua(problem_, formulation_, {{x, candidate.starts_reached}},
                                         {}, options_.stop, 1, options);
    if (own.families.empty()) return false;
    const auto curve =
        trace_curve(formulation_, in_shortest_turns(formulation_, x, options.curve.other_turn),
                    options_.stop, options.curve);
    for (std::size_t i = 0; curve && i < found.families.size(); ++i) {
      SolutionFamily& other = found.families[i];
      if (free_joint(other)) continue;
      const Configuration& middle = other.points[other.points.size() / 2];
      const Eigen::VectorXd there =
          in_shortest_turns(formulation_, formulation_.variables(middle), options.curve.other_turn);
      if (!place_on(formulation_, *curve, there, options.curve)) continue;
      candidate.family = static_cast<int>(i);
      other.starts += candidate.starts_reached;
      return true;
    }
    add(own.families.front(), candidate, found);
    return true;
  }

  bool is_listed(const SolutionFamily& roll, const SearchResult& found) const {
    constexpr double kSameOther = RollOptions{}.same_other;
    const std::optional<int> joint = free_joint(roll);
    return std::any_of(found.families.begin(), found.families.end(), [&](const auto& other) {
      return joint && free_joint(other) == joint &&
             formulation_.distance(formulation_.variables(other.points.front()),
                                   formulation_.variables(roll.points.front())) <= kSameOther;
    });
  }

  const CaptureProblem& problem_;
  const Formulation& formulation_;
  const SearchOptions& options_;
  Measure measure_;
};

/// The best by the nominal value alone may be new.
/// @param equal nominal values that differ by less are one
void compare_nominal_optimum(const Candidate& candidate, double equal, SearchResult& found) {
  if (!found.nominal_optimum) return;
  if (!(candidate.objective < found.nominal_optimum->nominal - equal)) return;
  found.nominal_optimum = NominalOptimum{candidate.configuration, candidate.objective,
                                         candidate.worst_case, candidate.value};
}

/// Puts a candidate into the ranked list, in place of the last one when the list is full.
/// @param equal values that differ by less are one, as in candidate_order()
void insert_ranked(const CaptureProblem& problem, const CertifiedCandidate& one, double equal,
                   const WorstCase& worst, const Eigen::VectorXd& x, SearchResult& found) {
  const auto most = static_cast<std::size_t>(problem.search.max_candidates);
  if (found.candidates.size() >= most) {
    found.candidates.pop_back();
    found.certificates.pop_back();
    found.worst_cases.pop_back();
    found.points.pop_back();
  }
  std::vector<Candidate> all = found.candidates;
  all.push_back(one.candidate);
  const std::vector<std::size_t> order = candidate_order(problem, all, equal);
  const auto at = std::find(order.begin(), order.end(), all.size() - 1) - order.begin();
  found.candidates.insert(found.candidates.begin() + at, one.candidate);
  found.certificates.insert(found.certificates.begin() + at, one.certificate);
  found.worst_cases.insert(found.worst_cases.begin() + at, worst);
  found.points.insert(found.points.begin() + at, x);
}

/// The starts of a further search, and Good and Turing's estimate for the nominal measure.
void count_further(const CaptureProblem& problem, const SearchResult& other, int added,
                   SearchResult& found) {
  found.starts += other.starts;
  found.distinct_solutions += added;
  int reached = 0, once = 0;
  const auto count = [&](int starts) {
    reached += starts;
    once += starts == 1 ? 1 : 0;
  };
  for (const SolutionFamily& family : found.families) count(family.starts);
  for (const Candidate& candidate : found.candidates) {
    if (candidate.family < 0) count(candidate.starts_reached);
  }
  if (problem.measure.kind == RiskMeasure::Nominal && reached > 0) {
    found.unseen = static_cast<double>(once) / reached;
  }
  // A better minimum may have been missed by either search.
  if (found.had_rounds) found.unseen = std::max(found.unseen, other.unseen);
  for (Certificate& certificate : found.certificates) {
    certificate.starts = found.starts;
    certificate.distinct_solutions = found.distinct_solutions;
    certificate.unseen = found.unseen;
  }
}

}  // namespace

void add_candidates_that_hold(const CaptureProblem& problem, const Formulation& formulation,
                              const CollisionJudge& collisions, const SearchOptions& search_options,
                              const PlannerOptions& options, AfterImpactJudge& after,
                              SearchResult& found, std::map<std::string, long>& solver_calls) {
  const auto holds = [&](const Candidate& candidate) {
    return candidate.collision_free && after.keeps_limits(candidate.configuration);
  };
  const bool is_solved =
      !found.candidates.empty() && status_of(found.certificates.front()) != PlanStatus::Infeasible;
  if (!is_solved || problem.post_impact.controllers.empty() || path_decides(problem)) return;
  if (std::any_of(found.candidates.begin(), found.candidates.end(), holds)) return;

  Continuum continuum(problem, formulation, search_options);
  const double equal = search_options.equal_nominal * formulation.objective_unit();
  int added = 0;
  for (int round = 0; round < options.further_searches && added == 0; ++round) {
    if (options.stop.reached()) return;
    const int pairs = round / 2;
    const double scale = 1 - options.further_rate_reserve * pairs;
    const CaptureProblem asked =
        round % 2 == 0 ? with_limits_as_constraints(problem, options.further_margin, scale)
                       : problem;
    Formulation asked_formulation(asked);
    asked_formulation.give_up_simulations_at(options.stop);
    SearchOptions further = search_options;
    further.seed = search_options.seed + 7919 * (1 + static_cast<std::uint64_t>(round));
    further.max_candidates = options.further_candidates * search_options.max_candidates;
    const SearchResult other = search(asked, asked_formulation, further);
    for (const auto& [name, calls] : other.solver_calls) solver_calls[name] += calls;
    if (other.candidates.empty() ||
        status_of(other.certificates.front()) == PlanStatus::Infeasible) {
      continue;
    }
    for (std::size_t i = 0; i < other.candidates.size() && added < problem.approach.max_approaches;
         ++i) {
      if (options.stop.reached()) break;
      Candidate candidate = other.candidates[i];
      candidate.family = -1;
      candidate.starts_reached = std::max(candidate.starts_reached, 1);
      collisions.judge(candidate);
      if (!holds(candidate)) continue;
      if (!continuum.place(other.points[i], candidate, found)) continue;
      const CertifiedCandidate certified = certify_candidate(
          problem, Formulation(problem), other.points[i], candidate, found.certificates.front());
      compare_nominal_optimum(certified.candidate, equal, found);
      insert_ranked(problem, certified, equal, other.worst_cases[i], other.points[i], found);
      ++added;
    }
    if (added == 0) continue;
    drop_unlisted_rolls(found.candidates, found.families);
    count_further(problem, other, added, found);
  }
}

}  // namespace stillbase
