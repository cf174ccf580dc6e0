#include <stillbase/planner/planner.hpp>

#include <algorithm>
#include <chrono>
#include <ctime>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <stillbase/core/parallel.hpp>
#include <stillbase/encounter/left_out.hpp>
#include <stillbase/formulation/measures/robust.hpp>
#include <stillbase/plan/feature.hpp>
#include <stillbase/plan/free_roll.hpp>
#include <stillbase/plan/scenario.hpp>
#include <stillbase/plan/turns.hpp>
#include <stillbase/planner/post_impact.hpp>
#include <stillbase/search/search.hpp>

#include "plan/proof_words.hpp"
#include "planner/approach_stage.hpp"
#include "planner/best_possible.hpp"
#include "planner/binding.hpp"
#include "planner/candidates.hpp"
#include "planner/choice.hpp"
#include "planner/completeness.hpp"
#include "planner/feature_choice.hpp"
#include "planner/further_search.hpp"
#include "planner/other_forms.hpp"

namespace stillbase {

namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Functions of the user need not stand several calls at once.
int jobs_of(const CaptureProblem& problem, const PlannerOptions& options) {
  return problem.user.empty() ? jobs_or_processors(options.jobs) : 1;
}

/// A deadline after half of the remaining time: a plan needs more than its proof.
StopCondition half_of_remaining_time(StopCondition stop) {
  const auto now = StopCondition::Clock::now();
  if (stop.deadline != StopCondition::Clock::time_point::max() && stop.deadline > now) {
    stop.deadline = now + (stop.deadline - now) / 2;
  }
  return stop;
}

/// Bounds the measure from below. The bound's suspects, configurations that may be better, become
/// further starts of the search.
/// @param search_from the search, with more starts
void bound_and_search_suspects(
    const CaptureProblem& problem, const Formulation& formulation, const PlannerOptions& options,
    const std::function<SearchResult(const std::vector<Eigen::VectorXd>&)>& search_from,
    SearchResult& found, Proof& proof) {
  const auto bounded = [&] {
    MinimumOptions effort;
    effort.stop = half_of_remaining_time(options.stop);
    effort.jobs = jobs_of(problem, options);
    effort.on_progress = [&](long boxes) {
      if (!options.on_progress) return;
      options.on_progress("proof", static_cast<int>(boxes), static_cast<int>(effort.max_boxes));
    };
    return bound_measure(options.prover, problem, formulation, found, proof, effort, options.bound);
  };
  bool was_missed = false;
  std::optional<MinimumBound> bound = bounded();
  for (int time = 0; time < options.bound_rounds && bound && !bound->suspects.empty(); ++time) {
    if (options.stop.reached()) break;
    std::vector<Eigen::VectorXd> suspects;
    for (const Configuration& at : bound->suspects) suspects.push_back(formulation.variables(at));
    SearchResult other = search_from(suspects);
    if (!(best_value(other) < (1 - options.improvement) * best_value(found).value())) break;
    was_missed = true;
    found = std::move(other);
    match_candidates(problem, found, proof, options.enclosure);
    bound = bounded();
  }
  state_what_was_missed(proof);
  if (bound) state_bound(*bound, proof);
  // Zeros of the nominal objective are no bound of another measure.
  if (problem.measure.kind != RiskMeasure::Nominal && proof.lower_bound == 0.0) {
    proof.lower_bound.reset();
  }
  if (proof.status == ProofStatus::NotApplicable && is_zero_reached(formulation, found)) {
    proof.statement += "; the best one is zero, no less is possible";
  }
  if (was_missed) {
    proof.statement += "; the best one, which the search had missed, was found in bounding it";
  }
}

/// What a plan asks of its search. @param problem, collisions, options outlive the result
SearchOptions search_options_of(const CaptureProblem& problem, const CollisionJudge& collisions,
                                const PlannerOptions& options) {
  SearchOptions search_options;
  search_options.optimizer = problem.search.optimizer;
  search_options.starts = number_of_starts(problem.search);
  search_options.is_adaptive = problem.search.starts == kAutomaticStarts;
  search_options.seed = problem.search.seed;
  search_options.max_candidates = problem.search.max_candidates;
  search_options.stop = options.stop;
  search_options.jobs = jobs_of(problem, options);
  search_options.clock = options.clock;
  search_options.is_free = [&](const Configuration& at) { return collisions.is_free(at); };
  search_options.on_progress = [&](int done, int total) {
    if (options.on_progress) options.on_progress("search", done, total);
  };
  return search_options;
}

/// Search and proof. Solutions that the search had missed are added.
SearchResult search_and_prove(const CaptureProblem& problem, const Formulation& formulation,
                              SearchOptions search_options, const PlannerOptions& options,
                              Plan& plan, Proof& proof) {
  const auto begin = Clock::now();
  SearchResult found = search(problem, formulation, search_options);

  // From all enclosed solutions as well: what led to one of them may not, with other starts beside.
  const auto search_from = [&](const std::vector<Eigen::VectorXd>& starts) {
    std::vector<Eigen::VectorXd>& more = search_options.more_starts;
    if (more.empty()) more = enclosed_points(problem, proof);
    more.insert(more.end(), starts.begin(), starts.end());
    return search(problem, formulation, search_options);
  };
  plan.solver_calls = found.solver_calls;
  plan.timing["search"] = seconds_since(begin);
  if (!problem.user.empty()) {
    proof.statement = kUserFunctionsNotEnclosed;
    return found;
  }
  const auto proof_begin = Clock::now();
  const PhaseClock::Phase phase(options.clock, "proof.boxes");
  if (options.on_progress) options.on_progress("proof", 0, 1);
  proof = prove_solutions(options.prover, problem, formulation,
                          half_of_remaining_time(options.stop), options.enclosure);
  match_candidates(problem, found, proof, options.enclosure);
  proof.found_by_search =
      static_cast<int>(std::count_if(proof.candidates.begin(), proof.candidates.end(),
                                     [](int candidate) { return candidate >= 0; }));
  if (has_missing_solutions(proof) && !options.stop.reached()) {
    found = search_from({});
    match_candidates(problem, found, proof, options.enclosure);
  }
  bound_and_search_suspects(problem, formulation, options, search_from, found, proof);
  plan.solver_calls = found.solver_calls;
  plan.timing["proof"] = seconds_since(proof_begin);
  return found;
}

/// The roll of a candidate whose other variables came with its path.
void move_roll(const Candidate& candidate, std::vector<SolutionFamily>& families) {
  if (candidate.family < 0) return;
  SolutionFamily& family = families[static_cast<std::size_t>(candidate.family)];
  const std::optional<int> joint = free_joint(family);
  for (Configuration& point : family.points) {
    if (!joint) return;
    const double angle = point.phi[*joint];
    point = candidate.configuration;
    point.phi[*joint] = angle;
  }
}

/// The whole turns that there is room for from each candidate.
void state_turns(Plan& plan) {
  for (Candidate& candidate : plan.candidates) {
    std::optional<int> rolled;
    if (candidate.family >= 0) {
      rolled = free_joint(plan.families[static_cast<std::size_t>(candidate.family)]);
    }
    candidate.turns = whole_turns(plan.problem, candidate.configuration, rolled);
  }
}

/// Puts the configuration that the approach leads to among the candidates, and its certificate and
/// constraints into the plan.
/// @return its index
std::size_t select_candidate(const ChosenApproach& choice, const Formulation& formulation,
                             SearchResult& found, Plan& plan) {
  std::size_t chosen = choice.candidate;
  plan.approach = choice.approach;
  plan.certificate = found.certificates[chosen];
  plan.constraints = formulation.report(found.points[chosen]);
  if (!choice.certified) return chosen;
  plan.certificate = choice.certified->certificate;
  plan.constraints = choice.certified->constraints;
  if (choice.is_sample) {
    found.candidates.push_back(choice.certified->candidate);
    chosen = found.candidates.size() - 1;
  } else {
    found.candidates[chosen] = choice.certified->candidate;
    move_roll(found.candidates[chosen], found.families);
  }
  return chosen;
}

/// Impact, objective and binding limits at the plan's configuration.
/// @param known worst case there, if the search computed it
void describe(const CaptureProblem& problem, const EncounterModel& encounter, const Candidate& best,
              const std::optional<WorstCase>& known, const PlannerOptions& options, Plan& plan) {
  plan.configuration = best.configuration;
  const CaptureProblem at = at_contact(problem, best.configuration);
  const Formulation there =
      base_follows_path(problem) ? Formulation(at) : Formulation(at, encounter);
  plan.impact = impact_at(at, there.encounter_model(), there.encounter(best.configuration),
                          best.configuration.phi);
  plan.objective.name = objective_name(problem);
  plan.objective.unit = objective_unit_name(problem);
  plan.objective.nominal = best.objective;
  plan.objective.value = best.value;
  plan.objective.terms = objective_terms(at, there, best.configuration);
  plan.objective.is_judged = best.is_judged;
  // Simulated terms over a cone or over samples take too many simulations for a remark.
  const bool is_cheap = best.is_judged && !options.stop.reached() &&
                        (!simulates_turn(problem) || problem.measure.kind == RiskMeasure::Nominal);
  for (const UserTerm& term : problem.user.terms) plan.objective.user_terms.push_back(term.name);
  if (status_of(plan.certificate) == PlanStatus::Optimal && is_cheap) {
    plan.binding = binding_limits(at, there, there.variables(best.configuration));
  }
  const WorstCase worst = known ? *known : worst_case(at, there, best.configuration);
  plan.objective.worst_case = worst.value;
  plan.objective.worst_direction = worst.direction;
  if (at.uncertainty.residual_velocity) {
    plan.objective.residual = summarize_residual(at, there, best.configuration);
  }
  for (const LeftOut& one : left_out(at)) {
    plan.warnings.push_back({one.code, one.path() + ": " + one.message});
  }
}

/// Reports of the first of several plans that is not finished: those of the others would be mixed
/// with them.
class ProgressOfFeatures {
 public:
  explicit ProgressOfFeatures(const PlannerOptions& options, std::size_t count)
      : report_(options.on_progress), is_finished_(count) {}

  void report(std::size_t i, const std::string& stage, int done, int total) {
    const std::lock_guard lock(mutex_);
    if (report_ && i == first_) report_(stage, done, total);
  }
  void finish(std::size_t i) {
    const std::lock_guard lock(mutex_);
    is_finished_[i] = true;
    while (first_ < is_finished_.size() && is_finished_[first_]) ++first_;
  }

 private:
  const decltype(PlannerOptions::on_progress)& report_;
  std::mutex mutex_;  // of what follows
  std::vector<bool> is_finished_;
  std::size_t first_ = 0;
};

/// Seconds of plans that were made beside each other as parts of the time that this took.
void share_time(double wall, double processor, PhaseClock* clock,
                const std::vector<PhaseClock>& clocks, std::vector<PlanOfFeature>& plans) {
  double sum = 0;
  for (const PlanOfFeature& one : plans) sum += one.plan.timing.at("total");
  const double part = sum > 0 ? wall / sum : 1;
  for (PlanOfFeature& one : plans) {
    for (auto& [name, seconds] : one.plan.timing) seconds *= part;
  }
  if (clock == nullptr) return;
  for (const PhaseClock& one : clocks) {
    for (const auto& [name, seconds] : one.seconds()) {
      clock->add(name, {seconds.wall * part, sum > 0 ? processor * seconds.wall / sum : 0});
    }
  }
}

/// Plans for every feature that the problem names, and the best of them. Several at a time, unless
/// there is a deadline: it may leave one plan whole, or all of them in parts.
Plan plan_features(const CaptureProblem& problem, const PlannerOptions& options) {
  const std::vector<std::string>& features = problem.variables.features;
  const auto count = static_cast<int>(features.size());
  const bool is_limited = options.stop.deadline != StopCondition::Clock::time_point::max();
  const int jobs = is_limited ? 1 : jobs_of(problem, options);
  const bool is_shared = jobs > 1;
  const auto begin = Clock::now();
  const std::clock_t processor = std::clock();
  ProgressOfFeatures progress(options, features.size());
  std::vector<PhaseClock> clocks(is_shared ? features.size() : 0);
  std::vector<std::optional<PlanOfFeature>> made(features.size());
  const auto work = [&](int index) {
    const auto i = static_cast<std::size_t>(index);
    PlannerOptions own = options;
    if (is_shared) own.clock = &clocks[i];
    if (options.on_progress) {
      own.on_progress = [&, i](const std::string& stage, int done, int total) {
        progress.report(i, stage, done, total);
      };
    }
    made[i] = plan_one_feature(at_feature(problem, features[i]), own);
    progress.finish(i);
  };
  // One is always planned for, whatever has stopped.
  if (for_each_index(jobs, count, options.stop, work) == 0) work(0);
  std::vector<PlanOfFeature> plans;
  for (std::optional<PlanOfFeature>& one : made) {
    if (one) plans.push_back(std::move(*one));
  }
  if (is_shared) {
    share_time(seconds_since(begin), static_cast<double>(std::clock() - processor) / CLOCKS_PER_SEC,
               options.clock, clocks, plans);
  }
  const bool all = plans.size() == features.size() && !options.stop.reached();
  Plan best = best_of_features(std::move(plans));
  if (!all) best.status = PlanStatus::Limit;
  return best;
}

}  // namespace

Plan make_plan(const CaptureProblem& problem, const PlannerOptions& options) {
  const ThreadCrew crew(jobs_of(problem, options));
  Plan plan = problem.variables.features.empty() ? plan_one_feature(problem, options).plan
                                                 : plan_features(problem, options);
  if (!plan.candidates.empty() && plan.status != PlanStatus::Infeasible) {
    AfterImpactAccount account =
        account_after_impact(at_feature(plan.problem, plan.configuration.feature),
                             plan.configuration, plan.impact, options.stop);
    plan.after_horizon = std::move(account.motion);
    plan.managed_momentum = std::move(account.momentum);
  }
  // Of a complete plan: these two were cut by a stop.
  const bool lacks_motion =
      !problem.post_impact.controllers.empty() &&
      (!plan.after_horizon || (plan.managed_momentum && !plan.managed_momentum->remaining));
  if (plan.status != PlanStatus::Infeasible && options.stop.reached() && lacks_motion) {
    plan.status = PlanStatus::Limit;
  }
  return plan;
}

PlanOfFeature plan_one_feature(const CaptureProblem& problem, const PlannerOptions& asked) {
  const auto begin = Clock::now();
  PhaseClock own_clock;
  PlannerOptions options = asked;
  if (options.clock == nullptr) options.clock = &own_clock;
  const std::map<std::string, PhaseClock::Seconds> before = options.clock->seconds();
  Formulation formulation(problem);
  formulation.give_up_simulations_at(options.stop);
  const CollisionJudge collisions(problem, formulation.encounter_model().motion);
  Plan plan;
  plan.problem = problem;
  plan.optimizer = problem.search.optimizer;
  Proof proof;
  const SearchOptions search_options = search_options_of(problem, collisions, options);
  SearchResult found = search_and_prove(problem, formulation, search_options, options, plan, proof);
  take_nearest_turns(problem, found);
  {
    const PhaseClock::Phase phase(options.clock, "collision");
    collisions.judge_all(jobs_of(problem, options), options.stop, found.candidates);
  }
  AfterImpactJudge after(problem, formulation.encounter_model(), options.stop,
                         jobs_of(problem, options), options.clock);
  const bool is_allowed =
      !found.candidates.empty() && status_of(found.certificates.front()) != PlanStatus::Infeasible;
  if (is_allowed) take_forms_that_hold(problem, collisions, options, after, found);
  // Where every solution is enclosed there is nothing to search for.
  if (proof.status == ProofStatus::NotApplicable) {
    add_candidates_that_hold(problem, formulation, collisions, search_options, options, after,
                             found, plan.solver_calls);
  }

  const auto approach_begin = Clock::now();
  ChosenApproach choice;
  const bool solved =
      !found.candidates.empty() && status_of(found.certificates.front()) != PlanStatus::Infeasible;
  if (solved) {
    if (options.on_progress) options.on_progress("after the impact", 0, 1);
    const PhaseClock::Phase phase(options.clock, "approach.choice");
    choice = choose_approach(problem, formulation.encounter_model(), collisions, found, proof,
                             problem.search.seed, after, options, plan.solver_calls);
  }
  if (choice.approach.status == ApproachStatus::TimeOut && options.stop.is_interrupted()) {
    choice.approach.status = ApproachStatus::Interrupted;
  }
  const bool is_cut = choice.approach.status == ApproachStatus::NotRequested &&
                      problem.approach.enabled && options.stop.reached();
  if (is_cut) choice.approach.status = ApproachStatus::Stopped;
  if (choice.approach.status == ApproachStatus::Stopped) {
    choice.approach.detail = "before a path was looked for";
  }
  plan.timing["approach"] = seconds_since(approach_begin);

  if (!found.candidates.empty()) {
    const std::size_t chosen = select_candidate(choice, formulation, found, plan);
    plan.certificate.proof = std::move(proof);
    plan.nominal_optimum = found.nominal_optimum;
    std::optional<WorstCase> known;
    if (!choice.certified) known = found.worst_cases[chosen];
    describe(problem, formulation.encounter_model(), found.candidates[chosen], known, options,
             plan);
    for (const auto& [i, reason] : choice.excluded) {
      if (i != chosen) found.candidates[i].excluded = reason;
    }
    plan.status = found.stopped ? PlanStatus::Limit : status_of(plan.certificate);
    const bool may_be_missed =
        plan.certificate.had_rounds && plan.certificate.unseen > kUnseenLevel;
    if (plan.status == PlanStatus::Optimal && may_be_missed) plan.status = PlanStatus::Feasible;
  }
  plan.candidates = std::move(found.candidates);
  plan.families = std::move(found.families);
  if (solved) state_turns(plan);
  const double equal = SearchOptions{}.equal_nominal * formulation.objective_unit();
  if (solved) state_choice(plan, equal, options.improvement);
  plan.certificate.proof.gap = gap_to_bound(plan);
  for (const auto& [phase, seconds] : options.clock->seconds()) {
    const auto known = before.find(phase);
    plan.timing[phase] = seconds.wall - (known == before.end() ? 0 : known->second.wall);
  }
  plan.timing["total"] = seconds_since(begin);
  const PlanQuality quality = !solved                  ? PlanQuality::Nothing
                              : choice.holds           ? PlanQuality::Holds
                              : arrives(plan.approach) ? PlanQuality::Arrives
                                                       : PlanQuality::Solved;
  plan.is_known_to_hold = quality == PlanQuality::Holds;
  // Stopped in the approach or in the simulation after the impact: the configuration is good, the
  // plan is not complete.
  if (solved && quality != PlanQuality::Holds && options.stop.reached()) {
    plan.status = PlanStatus::Limit;
  }
  return {std::move(plan), quality, equal};
}

}  // namespace stillbase
