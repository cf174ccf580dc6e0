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
#include "nlp/refinement.hpp"
#include "search/continua.hpp"
#include "search/kink.hpp"
#include "search/measure_search.hpp"
#include "search/nearest_zero.hpp"
#include "search/ranking.hpp"
#include "search/roll.hpp"
#include "search/solution.hpp"
#include "search/start_postures.hpp"
#include "search/zero_watch.hpp"

namespace stillbase {

namespace {

/// The measure's value, from nominal value and worst case where these are the measure. The nominal
/// value where the mean over samples is not known.
double reported(Measure& measure, const Eigen::VectorXd& x, double nominal, double worst) {
  if (measure.is_nominal()) return nominal;
  if (measure.kind() == RiskMeasure::WorstCase) return worst;
  const double value = measure.reported(x);
  return std::isnan(value) ? nominal : value;
}

/// The best posture by the nominal value alone; see NominalOptimum. Empty when a limit came first.
std::optional<NominalOptimum> nominal_optimum(const CaptureProblem& problem,
                                              const Formulation& formulation, Measure& measure,
                                              const std::vector<Solution>& solutions,
                                              double equal) {
  const auto size = [](const Solution& solution) { return std::sqrt(2 * solution.objective); };
  double lowest = kInfinity;
  for (const Solution& solution : solutions) lowest = std::min(lowest, size(solution));
  std::vector<Candidate> best;
  std::vector<const Solution*> solution_of;
  for (const Solution& solution : solutions) {
    if (size(solution) > lowest + equal) continue;
    Candidate candidate;
    candidate.configuration = formulation.configuration(solution.x);
    candidate.worst_case = measure.worst_at(solution.x).value;
    const double measured = measure.value(solution.x);
    if (!measure.knows(solution.x) || std::isnan(measured)) return std::nullopt;
    candidate.objective = nominal_value(problem, formulation, candidate.configuration);
    best.push_back(candidate);
    solution_of.push_back(&solution);
  }
  if (best.empty()) return std::nullopt;
  const std::size_t first =
      candidate_order(problem, best, equal * formulation.objective_unit(), RiskMeasure::Nominal)
          .front();
  const Candidate& at = best[first];
  return NominalOptimum{at.configuration, at.objective, at.worst_case,
                        reported(measure, solution_of[first]->x, at.objective, at.worst_case)};
}

/// Whether what a solver leaves is meant to be a minimum.
bool ends_at_minima(const nlp::OptimizerInfo& info) {
  return info.uses_gradient && !info.global && info.name != "gradient-projection";
}

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
        optimizer_(nlp::make_optimizer(options.optimizer)),
        rescuer_(nlp::make_optimizer(options.rescuer)),
        isolated_(formulation.freedom() == 0),
        simulates_(simulates_turn(problem)),
        jobs_(problem.user.empty() ? jobs_or_processors(options.jobs) : 1),
        postures_(problem, formulation, options, isolated_, jobs_) {
    if (!optimizer_) throw std::invalid_argument("no optimizer named " + options.optimizer);
    looks_for_zeros_ = formulation.has_hessian() && ends_at_minima(optimizer_->info());
    if (!ends_at_minima(optimizer_->info()) || options.optimizer == options.rescuer)
      rescuer_.reset();
    solve_.max_evaluations =
        simulates_ ? options.max_simulated_evaluations : options.max_evaluations;
    solve_.stop = options.stop;
    solve_.optimality_tolerance = kOptimal;
  }

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
        refine(solutions_, [this](const Solution& one) { return refined_nominal(one); });
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
  using Calls = std::map<std::string, long>;

  Solution solved(const nlp::Optimizer& optimizer, const Eigen::VectorXd& x0,
                  const nlp::OptimizeOptions& solve, Calls& calls) const {
    const Eigen::VectorXd x =
        solved_in_shortest_turns(formulation_, x0, [&](const Eigen::VectorXd& from) {
          ++calls[optimizer.info().name];
          return looks_for_zeros_ ? minimize_to_zero(optimizer, formulation_, from, solve)
                                  : optimizer.minimize(formulation_, from, solve).x;
        });
    return polish(problem_, formulation_,
                  judge(problem_, formulation_, formulation_.normalised(x)));
  }

  /// A local solve, and on from where it stopped short of a minimum.
  Solution local_minimum(const Eigen::VectorXd& x0, const nlp::OptimizeOptions& solve,
                         Calls& calls) const {
    const Solution found = solved(*optimizer_, x0, solve, calls);
    return needs_rescue(found) ? rescued(found, calls) : found;
  }
  bool needs_rescue(const Solution& found) const {
    return rescuer_ && found.violation <= kFeasibilityTolerance && !options_.stop.reached() &&
           !is_stationary(formulation_, found.x, {.stationary = kOptimal});
  }
  Solution rescued(const Solution& from, Calls& calls) const {
    const Solution further = solved(*rescuer_, from.x, briefly(), calls);
    return better(further, from) ? further : from;
  }
  nlp::OptimizeOptions briefly() const {
    nlp::OptimizeOptions out = solve_;
    out.max_evaluations = std::min(solve_.max_evaluations, options_.max_rescue_evaluations);
    return out;
  }

  /// What a start comes to.
  struct StartResult {
    ProjectionResult posture;
    Solution found;
    Calls calls;
  };
  StartResult result_of(int start) const {
    StartResult out;
    out.posture = postures_.of(start);
    nlp::OptimizeOptions solve = solve_;
    solve.seed = options_.seed + static_cast<std::uint64_t>(start);
    out.found = isolated_ && start >= options_.starts
                    ? judge(problem_, formulation_, formulation_.normalised(out.posture.x))
                    : solved(*optimizer_, out.posture.x, solve, out.calls);
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
    if (rescuer_) rescue_solutions();
    solve_.seed = options_.seed + static_cast<std::uint64_t>(std::max(done - 1, 0));
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
      ends[k].solution = needs_rescue(from) ? rescued(from, ends[k].calls) : from;
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
    const std::vector<Eigen::VectorXd> from = first_starts(in_rounds);
    // A long list is stated where many candidates may touch something.
    MeasureSearchOptions effort = options_.minima;
    effort.finished = std::max(effort.finished, options_.max_candidates / 2);
    const MeasureMinima found = measure_minima(formulation_, measure_, *optimizer_, solve_, from,
                                               more, options_.seed, jobs_, effort);
    out_.solver_calls[options_.optimizer] += found.solver_calls;
    out_.stopped = out_.stopped || found.stopped;
    if (in_rounds) out_.unseen = found.is_zero ? 0 : std::exp(-found.reached);
    std::vector<Solution> minima;
    for (const Eigen::VectorXd& x : found.points) keep_minimum(x, minima);
    rescue_best(minima);
    improve_prediction(minima);
    refine(minima, [this](const Solution& one) { return refined_by_measure(one); });
    // The best by the nominal value stays in the list: another choice when the minima
    // of the measure touch something.
    for (Solution& solution : solutions_) {
      const double value = measure_.value(solution.x);
      if (!std::isnan(value)) solution.objective = value;
      if (!std::isnan(value) || minima.empty())
        keep_distinct(formulation_, solution, minima, options_.same_configuration);
    }
    solutions_ = std::move(minima);
  }

  std::vector<Eigen::VectorXd> first_starts(bool in_rounds) const {
    const PhaseClock::Phase phase(options_.clock, "search.screening");
    std::vector<Eigen::VectorXd> solutions;
    for (const Solution& solution : solutions_) solutions.push_back(solution.x);
    return postures_.first(on_constraints_, solutions, in_rounds);
  }

  void state_nominal_optimum() {
    const PhaseClock::Phase phase(options_.clock, "search.ranking");
    out_.nominal_optimum =
        nominal_optimum(problem_, formulation_, measure_, solutions_, options_.equal_nominal);
  }

  /// With few starts a minimum of the measure can have a lower nominal value than what they found:
  /// the nominal problem is solved from there as well.
  void improve_prediction(const std::vector<Solution>& minima) {
    const auto size = [](const Solution& solution) { return std::sqrt(2 * solution.objective); };
    bool is_better = false;
    for (int time = 0; time < options_.prediction_rounds && !options_.stop.reached(); ++time) {
      double lowest = kInfinity;
      for (const Solution& solution : solutions_) lowest = std::min(lowest, size(solution));
      Solution from;
      for (const Solution& minimum : minima) {
        const Solution nominal = judge(problem_, formulation_, minimum.x);
        if (better(nominal, from)) from = nominal;
      }
      if (!(from.violation <= kFeasibilityTolerance &&
            size(from) < lowest - options_.better_prediction))
        break;
      const Solution further = local_minimum(from.x, solve_, out_.solver_calls);
      const Solution& found = better(further, from) ? further : from;
      keep_distinct(formulation_, can_refine() ? refined_nominal(found) : found, solutions_,
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
    for (int i = 0;
         i < options_.rescued_minima && rescuer_ && !minima.empty() && !options_.stop.reached();
         ++i) {
      const Eigen::VectorXd best =
          std::min_element(minima.begin(), minima.end(), [](const Solution& a, const Solution& b) {
            return better(a, b);
          })->x;
      if (measure_.certify(best).kkt_residual <= kOptimal) return;
      const MeasureSolution further = measure_.finish(*rescuer_, briefly(), best);
      out_.solver_calls[options_.rescuer] += further.solver_calls;
      const ProjectionResult exact = project_onto_constraints(formulation_, further.x, false, 8);
      if (!(exact.violation <= kFeasibilityTolerance)) return;
      const Eigen::VectorXd x = formulation_.normalised(exact.x);
      if (!(measure_.value(x) < measure_.value(best))) return;
      keep_minimum(x, minima);
    }
  }

  /// Newton steps take exact derivatives.
  bool can_refine() const { return !simulates_ && problem_.user.empty(); }

  /// Minima to their last digits. After a stop some are left as they are.
  template <class Refined>
  void refine(std::vector<Solution>& solutions, const Refined& refined) {
    if (!can_refine()) return;
    const PhaseClock::Phase phase(options_.clock, "search.refinement");
    std::vector<Solution> before = std::move(solutions);
    const auto is_of_curve = [&](const Solution& solution) {
      return std::any_of(before.begin(), before.end(), [&](const Solution& other) {
        return other.family >= 0 &&
               formulation_.distance(other.x, solution.x) <= options_.same_configuration;
      });
    };
    std::vector<Solution> after(before.size());
    for_each_index(jobs_, static_cast<int>(before.size()), {}, [&](int i) {
      const auto k = static_cast<std::size_t>(i);
      after[k] = before[k];
      if (before[k].family >= 0 || options_.stop.reached()) return;
      const Solution end = refined(before[k]);
      // A curve has counted its starts.
      if (end.x != before[k].x && !is_of_curve(end)) after[k] = end;
    });
    solutions.clear();
    for (const Solution& solution : after)
      keep_distinct(formulation_, solution, solutions, options_.same_configuration);
  }

  /// Whether nothing tells zeros of the nominal value apart but their way from the start posture.
  bool may_move_zeros() const {
    return measure_.is_nominal() && looks_for_zeros_ && can_refine() &&
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
  bool is_zero(const Solution& solution) const { return size(solution) <= options_.continua.zero; }

  /// Of the nominal value.
  Solution refined_nominal(const Solution& from) const {
    const bool was_zero = is_zero(from);
    const Eigen::VectorXd x =
        was_zero ? rounded_zero(from.x) : nlp::refined_minimum(formulation_, from.x);
    Solution out = judge(problem_, formulation_, formulation_.normalised(x));
    out.reached = from.reached;
    out.family = from.family;
    return takes_place_of(from, out, was_zero ? options_.continua.zero : size(from)) ? out : from;
  }

  /// Of the measure.
  Solution refined_by_measure(const Solution& from) {
    Solution out = from;
    out.x = formulation_.normalised(measure_.refined(from.x));
    out.objective = measure_.value(out.x);
    out.violation = largest_violation(problem_, formulation_, out.x);
    return takes_place_of(from, out, size(from)) ? out : from;
  }

  /// |y| in typical sizes.
  static double size(const Solution& solution) { return std::sqrt(2 * solution.objective); }

  /// Where constraints were broken by their tolerance the value was too low by as much.
  bool takes_place_of(const Solution& from, const Solution& out, double most) const {
    constexpr double kRounding = 1e-10;
    return out.violation <= kFeasibilityTolerance && size(out) <= most + kRounding &&
           formulation_.distance(from.x, out.x) <= options_.minima.same_basin;
  }

  /// A zero near x. It is seldom alone, and of the place where a solve met the others only the
  /// leading digits are the same with another compiler: the others are rounded off.
  Eigen::VectorXd rounded_zero(const Eigen::VectorXd& x) const {
    constexpr double kPlace = 1e-4;
    const Eigen::VectorXd grid = (x / kPlace).array().round().matrix() * kPlace;
    return project_onto_constraints(
               formulation_, grid.cwiseMax(formulation_.lower()).cwiseMin(formulation_.upper()),
               true, 8)
        .x;
  }

  /// Candidates in their order, with certificates.
  void rank() {
    const PhaseClock::Phase phase(options_.clock, "search.ranking");
    if (simulates_) judge_all();
    for_each_index(jobs_, static_cast<int>(solutions_.size()), {}, [&](int i) {
      const Eigen::VectorXd& x = solutions_[static_cast<std::size_t>(i)].x;
      static_cast<void>(measure_.worst_at(x));
      if (!measure_.is_nominal()) static_cast<void>(measure_.value(x));
    });
    std::vector<Candidate> candidates;
    std::vector<WorstCase> worst;
    for (const Solution& solution : solutions_) {
      Candidate candidate;
      candidate.configuration = formulation_.configuration(solution.x);
      candidate.objective = nominal_value(problem_, formulation_, candidate.configuration);
      worst.push_back(measure_.worst_at(solution.x));
      candidate.worst_case = worst.back().value;
      candidate.max_violation = solution.violation;
      candidate.starts_reached = solution.reached;
      candidate.family = solution.family;
      candidate.value = reported(measure_, solution.x, candidate.objective, candidate.worst_case);
      candidate.is_judged = measure_.knows(solution.x);
      candidates.push_back(candidate);
    }
    std::vector<std::size_t> order = candidate_order(
        problem_, candidates, options_.equal_nominal * formulation_.objective_unit());
    const auto most = static_cast<std::size_t>(options_.max_candidates);
    order.resize(std::min(order.size(), most));
    std::vector<nlp::Certificate> residuals(order.size());
    for_each_index(jobs_, static_cast<int>(order.size()), {}, [&](int i) {
      const auto k = static_cast<std::size_t>(i);
      residuals[k] = measure_.certify(solutions_[order[k]].x);
    });
    for (std::size_t k = 0; k < order.size(); ++k) {
      const std::size_t i = order[k];
      const Candidate& candidate = candidates[i];
      const Eigen::VectorXd& x = solutions_[i].x;
      const nlp::Certificate& kkt = residuals[k];
      Certificate certificate;
      certificate.kkt_residual = kkt.kkt_residual;
      certificate.reduced_hessian_min_eigenvalue = kkt.reduced_hessian_min_eigenvalue;
      certificate.max_violation = candidate.max_violation;
      certificate.starts = out_.starts;
      certificate.distinct_solutions = out_.distinct_solutions;
      certificate.unseen = out_.unseen;
      certificate.had_rounds = out_.had_rounds;
      out_.candidates.push_back(candidate);
      out_.certificates.push_back(certificate);
      out_.worst_cases.push_back(worst[i]);
      out_.points.push_back(x);
    }
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
  std::unique_ptr<nlp::Optimizer> optimizer_, rescuer_;
  nlp::OptimizeOptions solve_;
  const bool isolated_;
  const bool simulates_;
  bool looks_for_zeros_ = false;  ///< of an objective that takes no simulation
  const int jobs_;
  const StartPostures postures_;
  std::vector<Eigen::VectorXd> on_constraints_;  ///< the starts' postures
  std::vector<Solution> solutions_;
  Solution nearest_;  ///< the best of all that was found
  SearchResult out_;
};

}  // namespace

SearchResult search(const CaptureProblem& problem, const Formulation& formulation,
                    const SearchOptions& options) {
  return Search(problem, formulation, options).run();
}

PlanStatus status_of(const Certificate& certificate) {
  if (!(certificate.max_violation <= kFeasibilityTolerance)) return PlanStatus::Infeasible;
  return certificate.kkt_residual <= kOptimal ? PlanStatus::Optimal : PlanStatus::Feasible;
}

}  // namespace stillbase
