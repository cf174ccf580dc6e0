#include <stillbase/search/trade_off.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <stdexcept>

#include <stillbase/core/constants.hpp>
#include <stillbase/core/parallel.hpp>
#include <stillbase/core/random.hpp>
#include <stillbase/formulation/measures/robust.hpp>
#include <stillbase/nlp/certificate.hpp>
#include <stillbase/nlp/optimizer.hpp>
#include <stillbase/search/search.hpp>

#include "formulation/projection.hpp"
#include "search/solution.hpp"

namespace stillbase {

namespace {

CaptureProblem with_objective(CaptureProblem problem, ObjectiveQuantity quantity) {
  ObjectiveTerm alone{quantity};
  for (const ObjectiveTerm& stated : problem.objective) {
    if (stated.quantity == quantity) alone.after = stated.after;
  }
  problem.objective = {alone};
  problem.measure = {};
  problem.user.terms.clear();
  return problem;
}

/// Least second quantity while the first is at most `level`, > 0.
class LimitedProgram final : public nlp::Problem {
 public:
  LimitedProgram(const Formulation& first, const Formulation& second, double level)
      : first_(first),
        second_(second),
        limit_(std::pow(first.objective_power().length(level) / first.objective_unit(), 2) / 2),
        m_(second.num_constraints()) {}

  int num_variables() const override { return second_.num_variables(); }
  int num_constraints() const override { return m_ + 1; }
  Eigen::VectorXd lower() const override { return second_.lower(); }
  Eigen::VectorXd upper() const override { return second_.upper(); }
  Eigen::VectorXd constraint_lower() const override {
    return joined(second_.constraint_lower(), -nlp::kInfinity);
  }
  Eigen::VectorXd constraint_upper() const override {
    return joined(second_.constraint_upper(), 1);
  }
  bool may_have_kinks(int i) const override { return i < m_ && second_.may_have_kinks(i); }
  void evaluate(const Eigen::VectorXd& x, nlp::Evaluation& out) const override {
    second_.evaluate(x, out);
    auto& of_first = out.workspace.as<nlp::Evaluation>();
    first_.evaluate(x, of_first);
    out.constraints = joined(out.constraints, of_first.objective / limit_);
    out.jacobian.conservativeResize(m_ + 1, x.size());
    out.jacobian.row(m_) = of_first.gradient.transpose() / limit_;
  }
  void evaluate_value(const Eigen::VectorXd& x, nlp::Evaluation& out) const override {
    second_.evaluate_value(x, out);
    auto& of_first = out.workspace.as<nlp::Evaluation>();
    first_.evaluate_value(x, of_first);
    out.constraints = joined(out.constraints, of_first.objective / limit_);
  }
  bool has_hessian() const override { return first_.has_hessian() && second_.has_hessian(); }
  void lagrangian_hessian(const Eigen::VectorXd& x, double sigma,
                          const Eigen::VectorXd& multipliers, Eigen::MatrixXd& out) const override {
    const Eigen::VectorXd none = Eigen::VectorXd::Zero(first_.num_constraints());
    Eigen::MatrixXd of_first;
    first_.lagrangian_hessian(x, multipliers[m_] / limit_, none, of_first);
    second_.lagrangian_hessian(x, sigma, multipliers.head(m_), out);
    out += of_first;
  }

 private:
  static Eigen::VectorXd joined(const Eigen::VectorXd& a, double b) {
    Eigen::VectorXd out(a.size() + 1);
    out << a, b;
    return out;
  }

  const Formulation& first_;
  const Formulation& second_;
  double limit_;
  int m_;
};

/// The two problems, and what every part of the search needs.
class FrontSearch {
 public:
  FrontSearch(const CaptureProblem& problem, ObjectiveQuantity first, ObjectiveQuantity second,
              const TradeOffOptions& options, TradeOff& out)
      : first_problem_(with_objective(problem, first)),
        second_problem_(with_objective(problem, second)),
        first_(first_problem_),
        second_(second_problem_),
        options_(options),
        out_(out),
        jobs_(problem.user.empty() ? jobs_or_processors(options.jobs) : 1),
        optimizer_(nlp::make_optimizer(options.optimizer)) {
    if (!optimizer_) throw std::invalid_argument("no optimizer named " + options.optimizer);
    first_.give_up_simulations_at(options.stop);
    second_.give_up_simulations_at(options.stop);
    solve_.max_evaluations = 1000;
    solve_.stop = options.stop;
    solve_.optimality_tolerance = kOptimal;
  }

  void run() {
    // The extremes, and the other good postures found with them as starts.
    for (const auto& [problem, formulation] :
         {std::pair(&first_problem_, &first_), std::pair(&second_problem_, &second_)}) {
      if (!points_.empty() && stopped()) break;
      SearchOptions search_options;
      search_options.optimizer = options_.optimizer;
      search_options.starts = options_.starts;
      search_options.seed = options_.seed;
      search_options.stop = options_.stop;
      search_options.jobs = jobs_;
      const SearchResult found = search(*problem, *formulation, search_options);
      for (const auto& [name, calls] : found.solver_calls) out_.solver_calls[name] += calls;
      out_.stopped = out_.stopped || found.stopped;
      for (std::size_t i = 0; i < found.points.size(); ++i) {
        // What a quantity is worth may take a simulation each time.
        if (!points_.empty() && stopped()) break;
        if (found.candidates[i].max_violation <= kFeasibilityTolerance) add(found.points[i]);
      }
    }
    // A front may jump from one branch of postures to another: starts from everywhere.
    add_all(options_.draws_per_start * options_.starts, [&](int draw) {
      const Eigen::VectorXd x0 =
          second_.start_point(low_discrepancy_point(draw, second_.num_variables(), options_.seed));
      ProjectionResult projected = project_onto_constraints(second_, x0, false, 30);
      projected.x = second_.normalised(projected.x);
      return projected;
    });
    if (points_.empty()) return;
    improve_ends();
    // Upwards from the least first quantity, then downwards: each level starts from what its
    // neighbours found.
    const double lowest = least(&Point::first);
    const double highest = end(&Point::second, &Point::first).first;
    const int total = 2 * options_.levels;
    for (int step = 0; step < total && !stopped(); ++step) {
      const int k = step < options_.levels ? step : total - 1 - step;
      // Denser where the first quantity is small: there the second one falls fastest.
      const double part = std::pow(static_cast<double>(k) / (options_.levels - 1), 3);
      const double level = lowest + (highest - lowest) * part;
      improve(std::max(level, end_level(&Point::first, &Point::second)));
      if (options_.on_progress) options_.on_progress(step + 1, total);
    }
  }

  /// Those that no other one beats, with certificates.
  std::vector<TradeOffPoint> front() {
    std::vector<TradeOffPoint> out;
    if (points_.empty()) return {};
    const Point& start = end(&Point::first, &Point::second);
    const Point& last = end(&Point::second, &Point::first);
    const double same = 1e-6 * (last.first - start.first);
    std::vector<Point> best{start};
    // The best at each level. Between levels nothing was solved for: there a point may look good
    // only because no other one is near.
    std::sort(levels_.begin(), levels_.end());
    for (const double level : levels_) {
      const Point* least = nullptr;
      for (const Point& point : points_) {
        const bool keeps = point.first <= level * (1 + options_.near_least);
        if (keeps && (least == nullptr || point.second < least->second)) least = &point;
      }
      if (least != nullptr && least->second < best.back().second * (1 - 1e-9) &&
          least->first > best.back().first + same && least->first < last.first - same) {
        best.push_back(*least);
      }
    }
    if (last.first > start.first && last.second < best.back().second * (1 - 1e-9)) {
      best.push_back(last);
    }
    for (const Point& point : best) {
      TradeOffPoint entry;
      entry.configuration = first_.configuration(point.x);
      entry.first = point.first;
      entry.second = point.second;
      for (const ConstraintValue& value : first_.report(point.x)) {
        entry.max_violation = std::max(entry.max_violation, value.violation);
      }
      const double least = first_.objective_power().value(1e-12 * first_.objective_unit());
      const double level = std::max(point.first, least);
      entry.kkt_residual =
          nlp::certify(LimitedProgram(first_, second_, level), point.x).kkt_residual;
      out.push_back(entry);
    }
    return out;
  }

 private:
  struct Point {
    Eigen::VectorXd x;
    double first, second;
  };

  bool stopped() {
    out_.stopped = out_.stopped || options_.stop.reached();
    return out_.stopped;
  }

  Point point_at(const Eigen::VectorXd& x) const {
    const Configuration at = first_.configuration(x);
    return {x, nominal_value(first_problem_, first_, at),
            nominal_value(second_problem_, second_, at)};
  }
  void add(const Eigen::VectorXd& x) { points_.push_back(point_at(x)); }

  /// Adds those of `count` points that are on the constraints, in their order.
  /// @return how many were found, fewer when stopped
  int add_all(int count, const std::function<ProjectionResult(int)>& find) {
    if (stopped()) return 0;
    std::vector<std::optional<Point>> found(static_cast<std::size_t>(count));
    const auto work = [&](int i) {
      const ProjectionResult there = find(i);
      if (there.violation <= kFeasibilityTolerance)
        found[static_cast<std::size_t>(i)] = point_at(there.x);
    };
    const auto take = [&](int i) {
      if (auto& point = found[static_cast<std::size_t>(i)]) points_.push_back(std::move(*point));
    };
    const int done = for_each_index(jobs_, count, options_.stop, work, take);
    out_.stopped = out_.stopped || done < count;
    return done;
  }

  /// Adds the local minima of a program from these starts.
  void add_minima(const nlp::Problem& program, const std::vector<Eigen::VectorXd>& starts) {
    out_.solver_calls[options_.optimizer] += add_all(static_cast<int>(starts.size()), [&](int i) {
      const Eigen::VectorXd& start = starts[static_cast<std::size_t>(i)];
      const Eigen::VectorXd x =
          solved_in_shortest_turns(second_, start, [&](const Eigen::VectorXd& from) {
            return optimizer_->minimize(program, from, solve_).x;
          });
      return project_onto_constraints(second_, second_.normalised(x), false, 8);
    });
  }

  using Quantity = double Point::*;

  /// An end of the front: of all points that have the least of a quantity the one with the least of
  /// another, and of those that are as good as it the one that has really the least.
  const Point& end(Quantity held, Quantity lowered) const {
    const double level = end_level(held, lowered);
    double best = kInfinity;
    for (const Point& point : points_) {
      if (point.*held <= level) best = std::min(best, point.*lowered);
    }
    const Point* out = nullptr;
    for (const Point& point : points_) {
      const bool is_best = point.*held <= level && point.*lowered <= best * (1 + options_.same);
      if (is_best && (out == nullptr || point.*held < out->*held)) out = &point;
    }
    return *out;
  }

  double least(Quantity quantity) const {
    double out = kInfinity;
    for (const Point& point : points_) out = std::min(out, point.*quantity);
    return out;
  }

  double end_level(Quantity held, Quantity lowered) const {
    // What a quantity is where the other one is least; of values that differ by rounding the least.
    const auto at_least_of = [this](Quantity other, Quantity quantity, double level) {
      double out = kInfinity;
      for (const Point& point : points_) {
        if (point.*other <= level) out = std::min(out, point.*quantity);
      }
      return out;
    };
    const double lowest = least(held), least_other = least(lowered);
    const double other = at_least_of(held, lowered, lowest);
    const double level =
        std::max(least_other * (1 + options_.near_least), options_.near_zero * other);
    return std::max(lowest * (1 + options_.near_least),
                    options_.near_zero * at_least_of(lowered, held, level));
  }

  /// Least second quantity with the first at most at the level.
  void improve(double level) {
    if (level > 0) {
      levels_.push_back(level);
      solve(&Point::first, level, &Point::second, LimitedProgram(first_, second_, level));
    }
  }

  /// Many configurations may have the least of a quantity, and the search for it ends at any.
  void improve_ends() {
    improve_end(&Point::first, &Point::second, first_, second_);
    improve_end(&Point::second, &Point::first, second_, first_);
  }

  void improve_end(Quantity held, Quantity lowered, const Formulation& of_held,
                   const Formulation& of_lowered) {
    // Half of what counts: a solver is not exact.
    const double level = (least(held) + end_level(held, lowered)) / 2;
    if (!(level > 0)) return;
    const std::size_t before = points_.size();
    solve(held, level, lowered, LimitedProgram(of_held, of_lowered, level));
    // From there to what has really the least.
    std::vector<Eigen::VectorXd> starts;
    for (std::size_t i = before; i < points_.size(); ++i) starts.push_back(points_[i].x);
    add_minima(of_held, starts);
  }

  void solve(Quantity held, double level, Quantity lowered, const LimitedProgram& program) {
    // The best of those that keep the level, and the nearest of those that are better but do not.
    std::vector<Point> kept, beyond;
    double best = kInfinity;
    for (const Point& point : points_) {
      if (point.*held > level) continue;
      kept.push_back(point);
      best = std::min(best, point.*lowered);
    }
    for (const Point& point : points_) {
      if (point.*held > level && point.*lowered < best) beyond.push_back(point);
    }
    std::stable_sort(kept.begin(), kept.end(),
                     [&](const Point& a, const Point& b) { return a.*lowered < b.*lowered; });
    std::stable_sort(beyond.begin(), beyond.end(),
                     [&](const Point& a, const Point& b) { return a.*held < b.*held; });
    std::vector<Eigen::VectorXd> starts;
    for (const std::vector<Point>& points : {kept, beyond}) {
      const std::size_t most = starts.size() + options_.solves_per_kind;
      for (const Point& point : points) {
        const bool known = std::any_of(starts.begin(), starts.end(), [&](const auto& other) {
          return first_.distance(other, point.x) < options_.start_distance;
        });
        if (!known) starts.push_back(point.x);
        if (starts.size() >= most) break;
      }
    }
    add_minima(program, starts);
  }

  CaptureProblem first_problem_, second_problem_;
  Formulation first_, second_;
  const TradeOffOptions& options_;
  TradeOff& out_;
  const int jobs_;
  std::unique_ptr<nlp::Optimizer> optimizer_;
  nlp::OptimizeOptions solve_;
  std::vector<Point> points_;
  std::vector<double> levels_;  ///< of the first quantity, that were solved at
};

}  // namespace

TradeOff trade_off(const CaptureProblem& problem, ObjectiveQuantity first, ObjectiveQuantity second,
                   const TradeOffOptions& options) {
  if (first == second) throw std::invalid_argument("a trade-off needs two quantities");
  if (options.levels < 2) throw std::invalid_argument("a trade-off needs two levels at least");
  TradeOff out{first, second, {}, false, {}};
  const ThreadCrew crew(jobs_or_processors(options.jobs));
  FrontSearch search(problem, first, second, options, out);
  search.run();
  out.points = search.front();
  return out;
}

}  // namespace stillbase
