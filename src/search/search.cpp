#include <stillbase/search/search.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <mutex>
#include <stdexcept>

#include <stillbase/core/constants.hpp>
#include <stillbase/core/parallel.hpp>
#include <stillbase/core/random.hpp>
#include <stillbase/formulation/measures/robust.hpp>
#include <stillbase/nlp/optimizer.hpp>

#include "formulation/measures/residual.hpp"
#include "formulation/projection.hpp"
#include "search/candidate_list.hpp"
#include "search/continua.hpp"
#include "search/local_solves.hpp"
#include "search/measure_search.hpp"
#include "search/nearest_zero.hpp"
#include "search/refinement.hpp"
#include "search/roll.hpp"
#include "search/solution.hpp"
#include "search/start_postures.hpp"

namespace stillbase {

namespace {

/// Of samples, simulations and functions of the user a value costs too much for rounds of starts.
bool may_have_rounds(const CaptureProblem& problem) {
  const RiskMeasure measure = problem.measure.kind;
  const bool is_closed_form = measure == RiskMeasure::Expectation && has_residual(problem);
  return (measure == RiskMeasure::WorstCase || is_closed_form) && !simulates_turn(problem) &&
         problem.user.terms.empty();
}

class Search {
 public:
  Search(const CaptureProblem& problem, const Formulation& formulation,
         const SearchOptions& options)
      : problem_(problem),
        formulation_(formulation),
        options_(options),
        measure_(problem, formulation),
        solves_(problem, formulation, options),
        isolated_(formulation.freedom() == 0),
        simulates_(simulates_turn(problem)),
        jobs_(problem.user.empty() ? jobs_or_processors(options.jobs) : 1),
        postures_(problem, formulation, options, isolated_, jobs_),
        refinement_(problem, formulation, measure_, options, jobs_) {}

  SearchResult run() {
    find_solutions();
    if (out_.stopped && simulates_) keep_best_alone();
    // A curve takes thousands of evaluations: not where each of them is a simulation.
    if (!isolated_ && !simulates_) follow_curves();
    out_.unseen = unseen();
    if (solutions_.empty() && nearest_.x.size() > 0) solutions_.push_back(nearest_);
    const bool feasible = nearest_.violation <= kFeasibilityTolerance;
    if (feasible) {
      if (!isolated_) {
        refine_nominal();
        if (may_move_zeros()) move_zeros();
      }
      state_nominal_optimum();
      if (!measure_.is_nominal() && !isolated_) find_minima_of_measure();
      // Each value takes a simulation, or is a function of the user.
      if (!isolated_ && !simulates_ && problem_.user.empty()) state_rolls();
    }
    out_.distinct_solutions = feasible ? static_cast<int>(solutions_.size()) : 0;
    rank();
    drop_unlisted_rolls(out_.candidates, out_.families);
    out_.stopped = out_.stopped || (simulates_ && options_.stop.reached());
    out_.evaluations = formulation_.evaluations();
    out_.status = out_.stopped ? PlanStatus::Limit
                  : feasible   ? PlanStatus::Feasible
                               : PlanStatus::Infeasible;
    return std::move(out_);
  }

 private:
  using Calls = LocalSolves::Calls;

  /// What a start comes to.
  struct StartResult {
    ProjectionResult posture;
    Solution found;
    Calls calls;
  };
  StartResult result_of(int start) const {
    StartResult out;
    out.posture = postures_.of(start);
    out.found = isolated_ && start >= options_.starts
                    ? judge(problem_, formulation_, formulation_.normalised(out.posture.x))
                    : solves_.solve(out.posture.x, start, out.calls);
    out.found.x = formulation_.normalised(out.found.x);
    return out;
  }

  /// The nominal problem from every start.
  ///
  /// With as many equations as variables the solutions are isolated points and there is nothing to
  /// minimise: Newton steps from many more starts find them, and cost less than one local solve.
  void find_solutions() {
    const PhaseClock::Phase phase(options_.clock, "search.starts");
    const int starts = postures_.starts();
    // Those that are not taken yet: a few, whatever the number of starts.
    std::map<int, StartResult> results;
    std::mutex mutex;  // of the results
    const auto work = [&](int i) {
      StartResult result = result_of(i);
      const std::lock_guard lock(mutex);
      results.emplace(i, std::move(result));
    };
    const auto take = [&](int i) {
      StartResult result;
      {
        const std::lock_guard lock(mutex);
        result = std::move(results.extract(i).mapped());
      }
      if (result.posture.violation <= options_.on_constraints)
        on_constraints_.push_back(result.posture.x);
      for (const auto& [name, calls] : result.calls) out_.solver_calls[name] += calls;
      ++out_.starts;
      if (better(result.found, nearest_)) nearest_ = result.found;
      if (result.found.violation <= kFeasibilityTolerance)
        keep_distinct(formulation_, result.found, solutions_, options_.same_configuration);
      if (options_.on_progress) options_.on_progress(i + 1, starts);
    };
    int done = for_each_index(jobs_, starts, options_.stop, work, take);
    if (done == 0 && starts > 0) {  // something is always known
      work(0);
      take(0);
      done = 1;
    }
    out_.stopped = done < starts;
    if (starts > 0 && nearest_.x.size() == 0) throw std::invalid_argument(undefined_words());
    last_start_ = std::max(done - 1, 0);
    if (solves_.rescuer() == nullptr) return;
    if (measure_.is_nominal()) {
      rescue_solutions();
    } else {
      rescue_best_solution();
    }
  }

  /// Which functions have no value, by the first start.
  std::string undefined_words() const {
    const Eigen::VectorXd x = postures_.of(0).x;
    std::string names;
    for (const ConstraintValue& value : formulation_.report(x)) {
      if (!std::isfinite(value.value)) names += " " + value.name;
    }
    if (names.empty()) names = " the objective";
    return "there is no finite value at any start of" + names;
  }

  /// Goes on from the solutions at which the optimizer stopped short of a minimum, once from each.
  void rescue_solutions() {
    struct End {
      Solution solution;
      Calls calls;
    };
    std::vector<End> ends(solutions_.size());
    const auto work = [&](int i) {
      const auto k = static_cast<std::size_t>(i);
      const Solution& from = solutions_[k];
      ends[k].solution =
          solves_.stopped_short(from) ? solves_.rescued(from, last_start_, ends[k].calls) : from;
      ends[k].solution.x = formulation_.normalised(ends[k].solution.x);
      ends[k].solution.reached = from.reached;
    };
    const auto count = static_cast<int>(solutions_.size());
    if (for_each_index(jobs_, count, options_.stop, work) < count) out_.stopped = true;
    std::vector<Solution> before = std::move(solutions_);
    solutions_.clear();
    for (std::size_t k = 0; k < before.size(); ++k) {
      const bool was_tried = ends[k].solution.x.size() > 0;
      const Solution& end = was_tried ? ends[k].solution : before[k];
      for (const auto& [name, calls] : ends[k].calls) out_.solver_calls[name] += calls;
      if (better(end, nearest_)) nearest_ = end;
      keep_distinct(formulation_, end, solutions_, options_.same_configuration);
    }
  }

  /// The same for the best alone: of another measure the others are but starts.
  void rescue_best_solution() {
    for (int i = 0; i < options_.rescued_minima && !solutions_.empty(); ++i) {
      const auto best =
          std::min_element(solutions_.begin(), solutions_.end(),
                           [](const Solution& a, const Solution& b) { return better(a, b); });
      if (!solves_.stopped_short(*best)) return;
      Solution further = solves_.rescued(*best, last_start_, out_.solver_calls);
      if (!better(further, *best)) return;
      further.x = formulation_.normalised(further.x);
      further.reached = best->reached;
      if (better(further, nearest_)) nearest_ = further;
      solutions_.erase(best);
      keep_distinct(formulation_, further, solutions_, options_.same_configuration);
    }
  }

  /// What is still to be said of a solution takes hundreds of simulations where the objective is
  /// simulated: after a deadline or an interrupt what is known of the best one has to do. The best
  /// by the measure, if that is known of any; else by the nominal value.
  void keep_best_alone() {
    const auto is_ahead = [this](const Solution& a, const Solution& b) {
      const bool a_known = measure_.knows(a.x), b_known = measure_.knows(b.x);
      if (a_known != b_known) return a_known;
      const bool by_measure = a_known && !measure_.is_nominal();
      return by_measure ? measure_.value(a.x) < measure_.value(b.x) : better(a, b);
    };
    const auto best = std::min_element(solutions_.begin(), solutions_.end(), is_ahead);
    if (best != solutions_.end()) solutions_ = {Solution(*best)};
  }

  /// Where the solutions form curves: the best ones of each curve in place of those that the starts
  /// happened to end at.
  void follow_curves() {
    const PhaseClock::Phase phase(options_.clock, "search.curves");
    std::vector<ContinuumMember> members;
    for (const Solution& solution : solutions_) members.push_back({solution.x, solution.reached});
    Continua found = follow_continua(problem_, formulation_, members, options_.is_free,
                                     options_.stop, jobs_, options_.continua);
    out_.families = std::move(found.families);
    out_.stopped = out_.stopped || found.stopped;
    if (out_.families.empty()) return;
    solutions_.clear();
    for (const ContinuumMember& member : found.solutions) {
      Solution solution = judge(problem_, formulation_, member.x);
      solution.reached = member.reached;
      solution.family = member.family;
      if (!(solution.violation <= kFeasibilityTolerance)) continue;
      keep_distinct(formulation_, solution, solutions_, options_.same_configuration);
      if (better(solution, nearest_)) nearest_ = solution;
    }
  }

  /// One solution in place of those that differ in a free roll of the last joint alone.
  void state_rolls() {
    const PhaseClock::Phase phase(options_.clock, "search.curves");
    std::function<double(const Eigen::VectorXd&)> value;
    if (!measure_.is_nominal()) value = [this](const auto& x) { return measure_.value(x); };
    join_rolls(problem_, formulation_, value, options_.is_free, options_.stop, jobs_, solutions_,
               out_.families);
    if (measure_.is_nominal()) out_.unseen = unseen();
  }

  /// Good and Turing's estimate: the share of the starts whose solution, or curve of solutions, no
  /// other start reached.
  double unseen() const {
    int reached = 0, once = 0;
    const auto count = [&](int starts) {
      reached += starts;
      once += starts == 1 ? 1 : 0;
    };
    for (const SolutionFamily& family : out_.families) count(family.starts);
    for (const Solution& solution : solutions_) {
      if (solution.family < 0) count(solution.reached);
    }
    return reached > 0 ? static_cast<double>(once) / reached : 1;
  }

  /// The local minima of the problem's measure, beside the solutions of the nominal problem.
  void find_minima_of_measure() {
    const PhaseClock::Phase phase(options_.clock, "search.measure");
    const bool in_rounds = options_.is_adaptive && may_have_rounds(problem_);
    out_.had_rounds = in_rounds;
    MoreStarts more;
    if (in_rounds) more = [this](int round) { return postures_.fresh(round); };
    const MeasureStarts from = first_starts(in_rounds);
    // A long list is stated where many candidates may fail later on.
    MeasureSearchOptions effort = options_.minima;
    effort.finished_free = std::max(effort.finished_free, options_.max_candidates / 2);
    const MeasureMinima found =
        measure_minima(formulation_, measure_, solves_.optimizer(), solves_.limits(last_start_),
                       from, more, options_.is_free, options_.seed, jobs_, effort);
    out_.solver_calls[options_.optimizer] += found.solver_calls;
    out_.stopped = out_.stopped || found.stopped;
    if (in_rounds) out_.unseen = found.is_zero ? 0 : std::exp(-found.reached);
    std::vector<Solution> minima;
    for (const Eigen::VectorXd& x : found.points) keep_minimum(x, minima);
    rescue_best(minima);
    improve_prediction(minima);
    refinement_.refine_measure(minima);
    // The best by the nominal value stays in the list: another choice when the minima
    // of the measure touch something.
    refine_listed(minima);
    for (Solution& solution : solutions_) {
      const double value = measure_.value(solution.x);
      if (!std::isnan(value)) solution.objective = value;
      if (!std::isnan(value) || minima.empty())
        keep_distinct(formulation_, solution, minima, options_.same_configuration);
    }
    solutions_ = std::move(minima);
  }

  /// Of another measure only the best by the nominal value, which is stated: the others are starts.
  void refine_nominal() {
    if (measure_.is_nominal()) {
      return refinement_.refine_nominal(solutions_, [](const Solution&) { return true; });
    }
    double lowest = kInfinity;
    for (const Solution& solution : solutions_) lowest = std::min(lowest, solution.length());
    const double most = lowest + options_.as_good_before_refinement;
    refinement_.refine_nominal(solutions_,
                               [&](const Solution& solution) { return solution.length() <= most; });
  }

  /// Of the nominal solutions those that the list has room for beside the minima of the measure.
  void refine_listed(const std::vector<Solution>& minima) {
    for_each_index(jobs_, static_cast<int>(solutions_.size()), {}, [this](int i) {
      static_cast<void>(measure_.value(solutions_[static_cast<std::size_t>(i)].x));
    });
    std::vector<double> values;
    for (const Solution& minimum : minima) values.push_back(minimum.objective);
    for (const Solution& solution : solutions_) values.push_back(measure_.value(solution.x));
    std::erase_if(values, [](double value) { return std::isnan(value); });
    const auto room = static_cast<std::size_t>(options_.max_candidates);
    double most = kInfinity;
    if (values.size() > room) {
      const auto last = values.begin() + static_cast<std::ptrdiff_t>(room);
      std::nth_element(values.begin(), last, values.end());
      most = *last;
    }
    refinement_.refine_nominal(solutions_,
                               [&](const Solution& one) { return measure_.value(one.x) <= most; });
  }

  MeasureStarts first_starts(bool in_rounds) const {
    const PhaseClock::Phase phase(options_.clock, "search.screening");
    std::vector<Eigen::VectorXd> solutions;
    for (const Solution& solution : solutions_) solutions.push_back(solution.x);
    return postures_.first(on_constraints_, std::move(solutions), in_rounds);
  }

  void state_nominal_optimum() {
    const PhaseClock::Phase phase(options_.clock, "search.ranking");
    out_.nominal_optimum =
        nominal_optimum(problem_, formulation_, measure_, solutions_, options_.equal_nominal);
  }

  /// With few starts a minimum of the measure can have a lower nominal value than what they found:
  /// the nominal problem is solved from there as well.
  void improve_prediction(const std::vector<Solution>& minima) {
    bool is_better = false;
    for (int time = 0; time < options_.prediction_rounds && !options_.stop.reached(); ++time) {
      double lowest = kInfinity;
      for (const Solution& solution : solutions_) lowest = std::min(lowest, solution.length());
      Solution from;
      for (const Solution& minimum : minima) {
        const Solution nominal = judge(problem_, formulation_, minimum.x);
        if (better(nominal, from)) from = nominal;
      }
      if (!(from.violation <= kFeasibilityTolerance &&
            from.length() < lowest - options_.better_prediction))
        break;
      const Solution further = solves_.minimum(from.x, last_start_, out_.solver_calls);
      const Solution& found = better(further, from) ? further : from;
      keep_distinct(formulation_, refinement_.nominal(found), solutions_,
                    options_.same_configuration);
      is_better = true;
    }
    if (is_better) {
      // There was no zero before: now there may be one, on a curve.
      if (!simulates_ && out_.families.empty()) follow_curves();
      state_nominal_optimum();
    }
  }

  void keep_minimum(const Eigen::VectorXd& x, std::vector<Solution>& minima) {
    const double violation = largest_violation(problem_, formulation_, x);
    if (!(violation <= kFeasibilityTolerance)) return;
    keep_distinct(formulation_, {x, measure_.value(x), violation}, minima,
                  options_.same_configuration);
  }

  /// Goes on from the best minima where the solver stopped short.
  void rescue_best(std::vector<Solution>& minima) {
    for (int i = 0; i < options_.rescued_minima && solves_.rescuer() != nullptr &&
                    !minima.empty() && !options_.stop.reached();
         ++i) {
      const Eigen::VectorXd best =
          std::min_element(minima.begin(), minima.end(), [](const Solution& a, const Solution& b) {
            return better(a, b);
          })->x;
      if (measure_.certify(best).kkt_residual <= kOptimal) return;
      const MeasureSolution further =
          measure_.finish(*solves_.rescuer(), solves_.brief_limits(last_start_), best);
      out_.solver_calls[options_.rescuer] += further.solver_calls;
      const ProjectionResult exact = project_onto_constraints(formulation_, further.x, false, 8);
      if (!(exact.violation <= kFeasibilityTolerance)) return;
      const Eigen::VectorXd x = formulation_.normalised(exact.x);
      if (!(measure_.value(x) < measure_.value(best))) return;
      keep_minimum(x, minima);
    }
  }

  /// Whether nothing tells zeros of the nominal value apart but their way from the start posture.
  bool may_move_zeros() const {
    return measure_.is_nominal() && solves_.looks_for_zeros() && refinement_.is_possible() &&
           problem_.uncertainty.cone_half_angle == 0 && !has_residual(problem_);
  }

  void move_zeros() {
    const PhaseClock::Phase phase(options_.clock, "search.refinement");
    const bool is_complete =
        move_zeros_nearer(problem_, formulation_, options_.moved_zeros, options_.continua.zero,
                          options_.is_free, options_.stop, jobs_, solutions_);
    out_.stopped = out_.stopped || !is_complete;
    std::vector<Solution> moved = std::move(solutions_);
    solutions_.clear();
    for (const Solution& solution : moved)
      keep_distinct(formulation_, solution, solutions_, options_.same_configuration);
  }

  void rank() {
    const PhaseClock::Phase phase(options_.clock, "search.ranking");
    if (simulates_) judge_all();
    list_candidates(problem_, formulation_, measure_, solutions_, options_, jobs_, out_);
  }

  /// Worst cases and measures, for as long as there is time; then only what is known counts.
  void judge_all() {
    for_each_index(jobs_, static_cast<int>(solutions_.size()), options_.stop, [&](int i) {
      const Eigen::VectorXd& x = solutions_[static_cast<std::size_t>(i)].x;
      static_cast<void>(measure_.worst_at(x));
      static_cast<void>(measure_.value(x));
    });
    if (options_.stop.reached()) keep_best_alone();
  }

  const CaptureProblem& problem_;
  const Formulation& formulation_;
  const SearchOptions& options_;
  Measure measure_;
  const LocalSolves solves_;
  const bool isolated_;
  const bool simulates_;
  const int jobs_;
  StartPostures postures_;
  const Refinement refinement_;
  int last_start_ = 0;                           ///< whose seed later solves take
  std::vector<Eigen::VectorXd> on_constraints_;  ///< the starts' postures
  std::vector<Solution> solutions_;
  Solution nearest_;  ///< the best of all that was found
  SearchResult out_;
};

}  // namespace

SearchResult search(const CaptureProblem& problem, const Formulation& formulation,
                    const SearchOptions& options) {
  const ThreadCrew crew(jobs_or_processors(options.jobs));
  return Search(problem, formulation, options).run();
}

}  // namespace stillbase
