#include "planner/further_search.hpp"

#include <algorithm>
#include <cmath>

#include <stillbase/formulation/measures/robust.hpp>

#include "planner/candidates.hpp"
#include "planner/self_motion.hpp"

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

/// Puts a candidate into the ranked list, in place of the last one when the list is full.
void insert_ranked(const CaptureProblem& problem, const CertifiedCandidate& one,
                   const WorstCase& worst, const Eigen::VectorXd& x, SearchResult& found) {
  const auto most = static_cast<std::size_t>(problem.search.max_candidates);
  if (found.candidates.size() >= most) {
    found.candidates.pop_back();
    found.certificates.pop_back();
    found.worst_cases.pop_back();
    found.points.pop_back();
  }
  const double rank = rank_of(problem, one.candidate);
  const auto place = std::find_if(found.candidates.begin(), found.candidates.end(),
                                  [&](const Candidate& c) { return rank < rank_of(problem, c); });
  const auto at = place - found.candidates.begin();
  found.candidates.insert(place, one.candidate);
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

void add_candidates_that_hold(const CaptureProblem& problem, const CollisionJudge& collisions,
                              const SearchOptions& search_options, const PlannerOptions& options,
                              AfterImpactJudge& after, SearchResult& found,
                              std::map<std::string, long>& solver_calls) {
  const auto holds = [&](const Candidate& candidate) {
    return candidate.collision_free && after.keeps_limits(candidate.configuration);
  };
  const bool is_solved =
      !found.candidates.empty() && status_of(found.certificates.front()) != PlanStatus::Infeasible;
  if (!is_solved || problem.post_impact.controllers.empty() || path_decides(problem)) return;
  if (std::any_of(found.candidates.begin(), found.candidates.end(), holds)) return;

  int added = 0;
  for (int round = 0; round < options.further_searches && added == 0; ++round) {
    if (options.stop.reached()) return;
    const double scale = 1 - options.further_rate_reserve * (round / 2);
    const CaptureProblem asked =
        round % 2 == 0 ? with_limits_as_constraints(problem, options.further_margin, scale)
                       : problem;
    Formulation formulation(asked);
    formulation.give_up_simulations_at(options.stop);
    SearchOptions further = search_options;
    further.seed = search_options.seed + 7919 * (1 + static_cast<std::uint64_t>(round));
    further.max_candidates = options.further_candidates * search_options.max_candidates;
    const SearchResult other = search(asked, formulation, further);
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
      const CertifiedCandidate certified =
          certify_candidate(problem, other.points[i], candidate, found.certificates.front());
      insert_ranked(problem, certified, other.worst_cases[i], other.points[i], found);
      ++added;
    }
    if (added > 0) count_further(problem, other, added, found);
  }
}

}  // namespace stillbase
