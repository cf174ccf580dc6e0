#include "search/measure_search.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <mutex>
#include <utility>

#include <stillbase/core/constants.hpp>
#include <stillbase/core/parallel.hpp>
#include <stillbase/core/random.hpp>

#include "formulation/projection.hpp"

namespace stillbase {

namespace {

struct Point {
  Eigen::VectorXd x;
  double value;
};

bool lower(const Point& a, const Point& b) { return a.value < b.value; }

/// Sorted by value, without those that repeat a better one.
std::vector<Point> distinct(const Formulation& formulation, std::vector<Point> points,
                            double apart) {
  std::stable_sort(points.begin(), points.end(), lower);
  std::vector<Point> out;
  for (Point& point : points) {
    const bool known = std::any_of(out.begin(), out.end(), [&](const Point& other) {
      return formulation.are_within(other.x, point.x, apart);
    });
    if (!known) out.push_back(std::move(point));
  }
  return out;
}

bool is_near(const Formulation& formulation, const std::vector<Eigen::VectorXd>& points,
             const Eigen::VectorXd& x, double distance) {
  return std::any_of(points.begin(), points.end(), [&](const Eigen::VectorXd& other) {
    return formulation.are_within(other, x, distance);
  });
}

/// The postures in which three successive joints change branch: (a, b, c) and (a + pi, -b, c + pi)
/// bring a wrist, an elbow or a shoulder with intersecting axes to the same pose. Of other arms
/// they are just other places to start from.
std::vector<Eigen::VectorXd> other_branches(const Formulation& formulation,
                                            const Eigen::VectorXd& x) {
  const Configuration here = formulation.configuration(x);
  const auto half_turn = [](double angle) { return angle > 0 ? angle - kPi : angle + kPi; };
  std::vector<Eigen::VectorXd> out;
  for (Eigen::Index k = 0; k + 2 < here.phi.size(); ++k) {
    Configuration other = here;
    other.phi[k] = half_turn(here.phi[k]);
    other.phi[k + 1] = -here.phi[k + 1];
    other.phi[k + 2] = half_turn(here.phi[k + 2]);
    out.push_back(
        formulation.variables(other).cwiseMax(formulation.lower()).cwiseMin(formulation.upper()));
  }
  return out;
}

/// Local solves of the measure. Several threads may use one.
class MinimaFinder {
 public:
  MinimaFinder(const Formulation& formulation, Measure& measure, const nlp::Optimizer& optimizer,
               const nlp::OptimizeOptions& solve)
      : formulation_(formulation), measure_(measure), optimizer_(optimizer), solve_(solve) {}

  RoughSolution rough(const Eigen::VectorXd& start, const RoughLimits& limits) const {
    return measure_.minimize_roughly(optimizer_, solve_, start, limits);
  }
  MeasureSolution fine(const Eigen::VectorXd& start) const {
    return measure_.finish(optimizer_, solve_, start);
  }
  /// The end of a solve on the constraints; nothing when it leaves them.
  std::optional<Point> end_of(const MeasureSolution& solution) const {
    const ProjectionResult exact = project_onto_constraints(formulation_, solution.x, false, 8);
    if (!(exact.violation <= solve_.feasibility_tolerance)) return std::nullopt;
    const Eigen::VectorXd x = formulation_.normalised(exact.x);
    const double value = measure_.value(x);
    if (std::isnan(value)) return std::nullopt;  // simulations were given up
    return Point{x, value};
  }

 private:
  const Formulation& formulation_;
  Measure& measure_;
  const nlp::Optimizer& optimizer_;
  const nlp::OptimizeOptions& solve_;
};

/// A solve and its end, as threads hand them over.
template <class Solution>
struct Solved {
  Solution solution;
  std::optional<Point> end;
};

/// The points that are carried to the end, see MeasureSearchOptions::finished.
/// @param points sorted by value
/// @param worth part of the best value that touches nothing beyond which none is
std::vector<const Point*> worth_finishing(const Formulation& formulation,
                                          const std::vector<Point>& points,
                                          const std::function<bool(const Configuration&)>& is_free,
                                          double worth, const MeasureSearchOptions& options) {
  std::vector<const Point*> out;
  int best = 0, free = 0;
  double most = kInfinity;
  for (const Point& point : points) {
    const bool is_best = best < options.finished;
    if ((!is_best && free >= options.finished_free) || point.value > most) break;
    const bool touches = is_free && !is_free(formulation.configuration(point.x));
    if (is_best || !touches) out.push_back(&point);
    best += is_best ? 1 : 0;
    if (touches) continue;
    if (free++ == 0) most = worth * std::max(point.value, options.zero * options.zero / 2);
  }
  return out;
}

/// How many of the values are those of the best minimum.
int count_best(const std::vector<double>& values, double best, double same) {
  return static_cast<int>(std::count_if(values.begin(), values.end(),
                                        [&](double value) { return value <= same * best; }));
}

/// Projected places about a minimum.
std::vector<Eigen::VectorXd> hops_from(const Formulation& formulation, const Eigen::VectorXd& x,
                                       Random& random, const MeasureSearchOptions& options) {
  std::vector<Eigen::VectorXd> out;
  for (int i = 0; i < options.hops; ++i) {
    for (int draw = 0; draw < options.draws_per_hop; ++draw) {
      const ProjectionResult there =
          project_onto_constraints(formulation, hopped(x, random, options), false, 15);
      if (!(there.violation <= options.on_constraints)) continue;
      out.push_back(there.x);
      break;
    }
  }
  return out;
}

}  // namespace

Eigen::VectorXd hopped(const Eigen::VectorXd& x, Random& random,
                       const MeasureSearchOptions& options) {
  Eigen::VectorXd direction(x.size());
  for (double& entry : direction) entry = random.normal();
  const double shortest = std::log(options.shortest_hop), longest = std::log(options.longest_hop);
  return x + std::exp(random.uniform(shortest, longest)) * direction.normalized();
}

MeasureMinima measure_minima(const Formulation& formulation, Measure& measure,
                             const nlp::Optimizer& optimizer, const nlp::OptimizeOptions& solve,
                             const MeasureStarts& starts, const MoreStarts& more,
                             const std::function<bool(const Configuration&)>& is_free,
                             std::uint64_t seed, int jobs, const MeasureSearchOptions& options) {
  MeasureMinima out;
  const MinimaFinder finder(formulation, measure, optimizer, solve);
  const auto stopped = [&] {
    out.stopped = out.stopped || solve.stop.reached();
    return out.stopped;
  };

  std::vector<Point> approached;
  std::vector<double> ends;  // values at which starts ended by themselves
  RoughLimits limits;
  if (more) limits.evaluations = options.rough_evaluations;
  const auto best = [&] { return std::min_element(approached.begin(), approached.end(), lower); };
  // What is hopeless is known from all earlier starts. A thread knows of some of them: it may go on
  // for longer, and what it found beyond is dropped when its turn comes.
  std::atomic<double> hopeless = kInfinity;
  const auto approach = [&](const std::vector<Eigen::VectorXd>& from, bool by_themselves) {
    if (stopped()) return;
    std::vector<Solved<RoughSolution>> solved(from.size());
    const auto work = [&](int i) {
      const auto k = static_cast<std::size_t>(i);
      RoughLimits here = limits;
      here.hopeless = hopeless;
      solved[k].solution = finder.rough(from[k], here);
      solved[k].end = finder.end_of(solved[k].solution);
    };
    const auto take = [&](int i) {
      auto& [solution, end] = solved[static_cast<std::size_t>(i)];
      const MeasureSolution given_up = solution.given_up_at(hopeless);
      out.solver_calls += given_up.solver_calls;
      if (given_up.x != solution.x) end = finder.end_of(given_up);
      if (!end) return;
      if (by_themselves) ends.push_back(end->value);
      approached.push_back(std::move(*end));
      hopeless = options.same_value * best()->value;
    };
    const auto count = static_cast<int>(from.size());
    out.stopped = for_each_index(jobs, count, solve.stop, work, take) < count || out.stopped;
  };
  approach(starts.postures, true);
  // Solutions of the nominal problem lie in valleys of their own. Without directions on the rim a
  // solve leaves them, for others: with them half of the seeds of iiwa_cone miss its best minimum.
  const int rim_directions = std::exchange(limits.rim_directions, 0);
  approach(starts.solutions, true);
  limits.rim_directions = rim_directions;
  Random random(seed, 1);
  std::vector<Eigen::VectorXd> hopped_from;
  const auto is_zero = [&](double value) { return value <= options.zero * options.zero / 2; };
  for (int round = 0; more && round < options.most_rounds && !stopped(); ++round) {
    if (!approached.empty()) {
      if (is_zero(best()->value)) break;
      const int reached = count_best(ends, best()->value, options.same_value);
      if (round >= options.least_rounds && reached >= options.enough) break;
    }
    // Nearly all hops from the best minimum come back to it: every place is left once.
    const Point* from = nullptr;
    for (const Point& point : approached) {
      if (from != nullptr && !lower(point, *from)) continue;
      if (!is_near(formulation, hopped_from, point.x, options.same_basin)) from = &point;
    }
    if (from != nullptr) {
      hopped_from.push_back(from->x);
      approach(hops_from(formulation, hopped_from.back(), random, options), false);
    }
    approach(more(round), true);
  }
  // Of samples nothing was solved: starts tell little of where a solve ends.
  const bool are_ends = out.solver_calls > 0;
  approached =
      distinct(formulation, std::move(approached), are_ends ? options.apart : options.same_basin);

  std::vector<Point> minima;
  const auto keep = [&](const MeasureSolution& solution, std::optional<Point> point) {
    out.solver_calls += solution.solver_calls;
    if (!point) return;
    out.points.push_back(point->x);
    minima.push_back(std::move(*point));
    minima = distinct(formulation, std::move(minima), options.same_minimum);
  };
  if (!stopped()) {
    const std::vector<const Point*> from = worth_finishing(
        formulation, approached, is_free, are_ends ? options.worth_finishing : kInfinity, options);
    std::vector<Solved<MeasureSolution>> solved(from.size());
    const auto work = [&](int i) {
      auto& [solution, end] = solved[static_cast<std::size_t>(i)];
      solution = finder.fine(from[static_cast<std::size_t>(i)]->x);
      end = finder.end_of(solution);
    };
    const auto take = [&](int i) {
      auto& [solution, end] = solved[static_cast<std::size_t>(i)];
      keep(solution, std::move(end));
    };
    for_each_index(jobs, static_cast<int>(from.size()), solve.stop, work, take);
  }
  // Stopped before a minimum was reached: the best of what is known.
  const bool is_ahead =
      !approached.empty() && (minima.empty() || approached.front().value < minima.front().value);
  if (stopped() && is_ahead) keep({}, approached.front());
  if (minima.empty()) return out;

  // From the best on: the other branches of each good posture.
  std::vector<Eigen::VectorXd> flipped;
  std::mutex mutex;  // of the minima while threads look at them
  int flips = 0;
  const auto is_worth_a_solve = [&](const Eigen::VectorXd& start, double value) {
    if (!(value <= options.worth_a_solve * minima.front().value)) return false;
    return std::none_of(minima.begin(), minima.end(), [&](const Point& known) {
      return formulation.are_within(known.x, start, 5 * options.same_basin);
    });
  };
  for (std::size_t i = 0; i < minima.size() && flips < options.flips && !stopped();) {
    const Point from = minima[i];
    if (from.value > options.promising * minima.front().value) break;
    const bool done = is_near(formulation, flipped, from.x, options.same_basin);
    if (done) {
      ++i;
      continue;
    }
    flipped.push_back(from.x);
    struct Branch {
      ProjectionResult start;
      double value = kInfinity;
      std::optional<Solved<MeasureSolution>> solved;
    };
    const std::vector<Eigen::VectorXd> others = other_branches(formulation, from.x);
    std::vector<Branch> branches(others.size());
    const auto solve_from = [&](Branch& branch) {
      const MeasureSolution solution = finder.fine(branch.start.x);
      branch.solved = {solution, finder.end_of(solution)};
    };
    // The minima of lower branches may show that this one is not worth its solve, or, seldom, that
    // it is.
    const auto work = [&](int k) {
      Branch& branch = branches[static_cast<std::size_t>(k)];
      branch.start =
          project_onto_constraints(formulation, others[static_cast<std::size_t>(k)], false, 15);
      if (!(branch.start.violation <= 1e-3)) return;
      branch.value = measure.value(branch.start.x);
      {
        const std::lock_guard lock(mutex);
        if (!is_worth_a_solve(branch.start.x, branch.value)) return;
      }
      solve_from(branch);
    };
    const auto take = [&](int k) {
      Branch& branch = branches[static_cast<std::size_t>(k)];
      if (!(branch.start.violation <= 1e-3)) return;
      if (!is_worth_a_solve(branch.start.x, branch.value)) return;
      ++flips;
      if (!branch.solved) solve_from(branch);
      const std::lock_guard lock(mutex);
      keep(branch.solved->solution, std::move(branch.solved->end));
    };
    for_each_index(jobs, static_cast<int>(others.size()), solve.stop, work, take);
    i = 0;  // the order may have changed
  }
  out.reached = count_best(ends, minima.front().value, options.same_value);
  out.is_zero = is_zero(minima.front().value);
  return out;
}

}  // namespace stillbase
