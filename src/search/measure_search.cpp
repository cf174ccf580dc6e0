#include "search/measure_search.hpp"

#include <algorithm>
#include <cmath>

#include <stillbase/core/constants.hpp>
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
      return formulation.distance(other.x, point.x) < apart;
    });
    if (!known) out.push_back(std::move(point));
  }
  return out;
}

bool is_near(const Formulation& formulation, const std::vector<Eigen::VectorXd>& points,
             const Eigen::VectorXd& x, double distance) {
  return std::any_of(points.begin(), points.end(), [&](const Eigen::VectorXd& other) {
    return formulation.distance(other, x) < distance;
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

class MinimaFinder {
 public:
  MinimaFinder(const Formulation& formulation, Measure& measure, const nlp::Optimizer& optimizer,
               const nlp::OptimizeOptions& solve, MeasureMinima& out)
      : formulation_(formulation),
        measure_(measure),
        optimizer_(optimizer),
        solve_(solve),
        out_(out) {}

  /// A point nearer to a minimum; nothing when it leaves the constraints.
  std::optional<Point> rough(const Eigen::VectorXd& start, const RoughLimits& limits) {
    return taken(measure_.minimize_roughly(optimizer_, solve_, start, limits));
  }
  std::optional<Point> fine(const Eigen::VectorXd& start) {
    return taken(measure_.finish(optimizer_, solve_, start));
  }
  bool stopped() {
    out_.stopped = out_.stopped || solve_.stop.reached();
    return out_.stopped;
  }

 private:
  std::optional<Point> taken(const MeasureSolution& solution) {
    out_.solver_calls += solution.solver_calls;
    const ProjectionResult exact = project_onto_constraints(formulation_, solution.x, false, 8);
    if (!(exact.violation <= solve_.feasibility_tolerance)) return std::nullopt;
    const Eigen::VectorXd x = formulation_.normalised(exact.x);
    const double value = measure_.value(x);
    if (std::isnan(value)) return std::nullopt;  // simulations were given up
    return Point{x, value};
  }

  const Formulation& formulation_;
  Measure& measure_;
  const nlp::Optimizer& optimizer_;
  const nlp::OptimizeOptions& solve_;
  MeasureMinima& out_;
};

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
                             const std::vector<Eigen::VectorXd>& starts, const MoreStarts& more,
                             std::uint64_t seed, const MeasureSearchOptions& options) {
  MeasureMinima out;
  MinimaFinder finder(formulation, measure, optimizer, solve, out);

  std::vector<Point> approached;
  std::vector<double> ends;  // values at which starts ended by themselves
  RoughLimits limits;
  if (more) limits.evaluations = options.rough_evaluations;
  const auto best = [&] { return std::min_element(approached.begin(), approached.end(), lower); };
  const auto approach = [&](const std::vector<Eigen::VectorXd>& from, bool by_themselves) {
    for (const Eigen::VectorXd& start : from) {
      if (finder.stopped()) return;
      if (more && !approached.empty()) limits.hopeless = options.same_value * best()->value;
      auto point = finder.rough(start, limits);
      if (!point) continue;
      if (by_themselves) ends.push_back(point->value);
      approached.push_back(std::move(*point));
    }
  };
  approach(starts, true);
  Random random(seed, 1);
  std::vector<Eigen::VectorXd> hopped_from;
  for (int round = 0; more && round < options.most_rounds && !finder.stopped(); ++round) {
    if (!approached.empty()) {
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
  approached = distinct(formulation, std::move(approached), options.same_basin);

  std::vector<Point> minima;
  const auto keep = [&](Point point) {
    out.points.push_back(point.x);
    minima.push_back(std::move(point));
    minima = distinct(formulation, std::move(minima), options.same_minimum);
  };
  const auto most = static_cast<std::size_t>(options.finished);
  for (std::size_t i = 0; i < approached.size() && i < most && !finder.stopped(); ++i) {
    if (auto point = finder.fine(approached[i].x)) keep(std::move(*point));
  }
  // Stopped before a minimum was reached: the best of what is known.
  const bool is_ahead =
      !approached.empty() && (minima.empty() || approached.front().value < minima.front().value);
  if (finder.stopped() && is_ahead) keep(approached.front());
  if (minima.empty()) return out;

  // From the best on: the other branches of each good posture.
  std::vector<Eigen::VectorXd> flipped;
  int flips = 0;
  for (std::size_t i = 0; i < minima.size() && flips < options.flips && !finder.stopped();) {
    const Point from = minima[i];
    if (from.value > options.promising * minima.front().value) break;
    const bool done = is_near(formulation, flipped, from.x, options.same_basin);
    if (done) {
      ++i;
      continue;
    }
    flipped.push_back(from.x);
    for (const Eigen::VectorXd& other : other_branches(formulation, from.x)) {
      const ProjectionResult start = project_onto_constraints(formulation, other, false, 15);
      if (!(start.violation <= 1e-3)) continue;
      if (!(measure.value(start.x) <= options.worth_a_solve * minima.front().value)) continue;
      std::vector<Eigen::VectorXd> known;
      for (const Point& point : minima) known.push_back(point.x);
      if (is_near(formulation, known, start.x, 5 * options.same_basin)) continue;
      ++flips;
      if (auto point = finder.fine(start.x)) keep(std::move(*point));
    }
    i = 0;  // the order may have changed
  }
  out.reached = count_best(ends, minima.front().value, options.same_value);
  return out;
}

}  // namespace stillbase
