#include "search/continua.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <mutex>
#include <optional>

#include <stillbase/core/parallel.hpp>
#include <stillbase/formulation/measures/robust.hpp>

#include "formulation/projection.hpp"
#include "search/solution_curve.hpp"

namespace stillbase {

namespace {

bool vanishes(const Formulation& formulation, const Eigen::VectorXd& x, double zero) {
  nlp::Evaluation at_x;
  formulation.evaluate_value(x, at_x);
  return std::sqrt(2 * at_x.objective) <= zero;
}

/// A curve with what is to be made small along it.
class RatedCurve {
 public:
  RatedCurve(const CaptureProblem& problem, const Formulation& formulation, SolutionCurve curve,
             const ContinuumOptions& options)
      : problem_(problem),
        formulation_(formulation),
        curve_(std::move(curve)),
        values_(curve_.points.size()),
        is_free_(curve_.points.size(), 1),
        options_(options) {}

  std::size_t size() const { return values_.size(); }

  /// To be called for every point, before anything else, on any thread.
  void rate(std::size_t i, const std::function<bool(const Configuration&)>& is_free) {
    const Eigen::VectorXd& x = point(i);
    values_[i] = value_at(x);
    // The target is followed to the contact for every point: thousands of distances.
    if (is_free) is_free_[i] = is_free(formulation_.configuration(formulation_.normalised(x)));
  }
  std::vector<bool> free_points() const { return {is_free_.begin(), is_free_.end()}; }

  bool is_flat() const {
    const auto [least, most] = std::minmax_element(values_.begin(), values_.end());
    const Power power = formulation_.objective_power();
    return power.length(*most) - power.length(*least) <=
           options_.flat * formulation_.objective_unit();
  }

  /// The point next to i on one side; i itself at the curve's end.
  std::size_t neighbour(std::size_t i, int side) const {
    const std::size_t n = size();
    if (curve_.is_closed) return side > 0 ? (i + 1) % n : (i + n - 1) % n;
    if (side > 0) return i + 1 < n ? i + 1 : i;
    return i > 0 ? i - 1 : i;
  }

  /// The bottom at which a walk downhill from sample i ends.
  std::size_t bottom_below(std::size_t i, const std::vector<std::size_t>& bottoms) const {
    const auto is_bottom = [&bottoms](std::size_t k) {
      return std::find(bottoms.begin(), bottoms.end(), k) != bottoms.end();
    };
    while (!is_bottom(i)) {
      const std::size_t before = neighbour(i, -1), after = neighbour(i, 1);
      // As in bottoms(): of equal neighbours the first one.
      i = values_[after] < values_[before] && values_[after] < values_[i] ? after : before;
    }
    return i;
  }

  /// Samples that are lowest among their neighbours, of those that `counts` says.
  std::vector<std::size_t> bottoms(const std::vector<bool>& counts) const {
    std::vector<std::size_t> out;
    for (std::size_t i = 0; i < size(); ++i) {
      if (!counts[i]) continue;
      const std::size_t before = neighbour(i, -1), after = neighbour(i, 1);
      // Of equal neighbours the first one.
      const bool below_before = !counts[before] || before == i || values_[i] < values_[before];
      const bool below_after = !counts[after] || after == i || values_[i] <= values_[after];
      if (below_before && below_after) out.push_back(i);
    }
    return out;
  }

  /// The minimum between the neighbours of a bottom: golden section, since a worst case has kinks.
  Eigen::VectorXd minimum_at(std::size_t bottom) const {
    constexpr double kGolden = 0.6180339887498949;
    double low = arc_of(bottom, -1), high = arc_of(bottom, 1);
    double a = high - kGolden * (high - low), b = low + kGolden * (high - low);
    double at_a = value_on(a), at_b = value_on(b);
    while (high - low > options_.arc) {
      if (at_a <= at_b) {
        high = b, b = a, at_b = at_a;
        a = high - kGolden * (high - low), at_a = value_on(a);
      } else {
        low = a, a = b, at_a = at_b;
        b = low + kGolden * (high - low), at_b = value_on(b);
      }
    }
    const double arc = at_a <= at_b ? a : b;
    const bool is_better = std::min(at_a, at_b) < values_[bottom];
    return is_better ? point_on(arc) : curve_.points[bottom].x;
  }

  const Eigen::VectorXd& point(std::size_t i) const { return curve_.points[i].x; }

  std::size_t nearest_sample(const Eigen::VectorXd& x) const {
    const auto apart = [&](const CurvePoint& point) {
      return formulation_.difference(point.x, x).squaredNorm();
    };
    return static_cast<std::size_t>(std::min_element(curve_.points.begin(), curve_.points.end(),
                                                     [&](const CurvePoint& a, const CurvePoint& b) {
                                                       return apart(a) < apart(b);
                                                     }) -
                                    curve_.points.begin());
  }

  /// The middle sample of each stretch of a curve in which `counts` holds.
  std::vector<std::size_t> middles(const std::vector<bool>& counts) const {
    const std::size_t n = size();
    const auto gap = std::find(counts.begin(), counts.end(), false);
    if (gap == counts.end()) return {n / 2};
    // From a gap on, so that no stretch of a closed curve is cut in two.
    const std::size_t from = curve_.is_closed ? static_cast<std::size_t>(gap - counts.begin()) : 0;
    std::vector<std::size_t> out;
    for (std::size_t k = 0, length = 0; k <= n; ++k) {
      if (k < n && counts[(from + k) % n]) {
        ++length;
      } else if (length > 0) {
        out.push_back((from + k - length + length / 2) % n);
        length = 0;
      }
    }
    return out;
  }

 private:
  double value_at(const Eigen::VectorXd& x) const {
    return worst_case(problem_, formulation_, formulation_.configuration(x)).value;
  }
  Eigen::VectorXd point_on(double arc) const {
    const double length = curve_.length;
    if (curve_.is_closed) arc -= length * std::floor(arc / length);
    return point_at(formulation_, curve_, std::clamp(arc, 0.0, length), options_.curve);
  }
  double value_on(double arc) const { return value_at(point_on(arc)); }
  /// Arc of a neighbour, beyond the ends of a closed curve where it is there.
  double arc_of(std::size_t i, int side) const {
    const double arc = curve_.points[neighbour(i, side)].arc, own = curve_.points[i].arc;
    if (side < 0 && arc > own) return arc - curve_.length;
    if (side > 0 && arc < own) return arc + curve_.length;
    return arc;
  }

  const CaptureProblem& problem_;
  const Formulation& formulation_;
  SolutionCurve curve_;
  std::vector<double> values_;
  std::vector<char> is_free_;  // not bool: threads write next to each other
  const ContinuumOptions& options_;
};

/// From end to end, at most `spacing` apart and close enough to show how the curve bends; of a
/// closed curve the first one is also the last.
std::vector<Configuration> points_along(const Formulation& formulation, const SolutionCurve& curve,
                                        const ContinuumOptions& options) {
  std::vector<Configuration> out;
  std::size_t last = 0;
  for (std::size_t i = 0; i < curve.points.size(); ++i) {
    const bool is_end = i + 1 == curve.points.size();
    const double next = is_end ? curve.length : curve.points[i + 1].arc;
    const Eigen::VectorXd& tangent = curve.points[is_end ? 0 : i + 1].tangent;
    const bool bends = curve.points[last].tangent.dot(tangent) < options.curve.turn_cosine;
    const bool is_needed = i == 0 || next - curve.points[last].arc > options.spacing || bends ||
                           (is_end && !curve.is_closed);
    if (!is_needed) continue;
    last = i;
    out.push_back(formulation.configuration(formulation.normalised(curve.points[i].x)));
  }
  if (curve.is_closed) out.push_back(out.front());
  return out;
}

/// One curve's entries in the list of solutions.
std::vector<ContinuumMember> best_of(const RatedCurve& curve, const Formulation& formulation,
                                     const std::vector<ContinuumMember>& members) {
  const int family = members.front().family;
  std::vector<ContinuumMember> out;
  const std::vector<bool> free = curve.free_points();
  if (curve.is_flat()) {
    for (const std::size_t i : curve.middles(free)) {
      out.push_back({formulation.normalised(curve.point(i)), 0, family});
    }
    if (out.empty()) out.push_back(members.front());
    out.front().reached = 0;
    for (const ContinuumMember& member : members) out.front().reached += member.reached;
    return out;
  }
  const std::vector<bool> all(curve.size(), true);
  const std::vector<std::size_t> bottoms = curve.bottoms(all);
  std::vector<int> reached(curve.size(), 0);
  for (const ContinuumMember& member : members) {
    reached[curve.bottom_below(curve.nearest_sample(member.x), bottoms)] += member.reached;
  }
  for (const std::size_t i : bottoms) {
    out.push_back({formulation.normalised(curve.minimum_at(i)), reached[i], family});
  }
  for (const std::size_t i : curve.bottoms(free)) {
    if (std::find(bottoms.begin(), bottoms.end(), i) != bottoms.end()) continue;
    out.push_back({formulation.normalised(curve.point(i)), 0, family});
  }
  return out;
}

/// The curves through solutions, and the solutions on each. A curve is traced once, from the first
/// solution on it.
class CurveCollection {
 public:
  CurveCollection(const Formulation& formulation, const StopCondition& stop,
                  const ContinuumOptions& options)
      : formulation_(formulation), stop_(stop), options_(options) {}

  /// What is to be found out about a solution, on any thread.
  struct Found {
    ContinuumMember solution;
    bool vanishes = false;
    std::size_t looked_at = 0;           ///< curves on which it was looked for
    std::optional<SolutionCurve> curve;  ///< through it, where it is on none of those
  };
  Found look_at(ContinuumMember solution) const {
    Found out;
    solution.x = in_shortest_turns(formulation_, solution.x, options_.curve.other_turn);
    out.solution = solution;
    out.vanishes = vanishes(formulation_, solution.x, options_.zero);
    if (!out.vanishes) return out;
    {
      const std::lock_guard lock(mutex_);
      out.looked_at = curves_.size();
    }
    place(out.solution, 0, out.looked_at);
    if (out.solution.family >= 0 || stop_.reached()) return out;
    out.curve = trace_curve(formulation_, solution.x, stop_, options_.curve);
    return out;
  }

  /// In the order of the solutions, one at a time.
  void take(Found found) {
    ContinuumMember& solution = found.solution;
    if (found.vanishes) place(solution, found.looked_at, curves_.size());
    if (found.curve && solution.family < 0) {
      solution.family = static_cast<int>(curves_.size());
      const std::lock_guard lock(mutex_);
      curves_.push_back(std::move(*found.curve));
      members_.emplace_back();
    }
    if (solution.family < 0) {
      alone_.push_back(solution);
    } else {
      members_[static_cast<std::size_t>(solution.family)].push_back(solution);
    }
  }

  std::deque<SolutionCurve>& curves() { return curves_; }
  const std::vector<ContinuumMember>& members_of(std::size_t curve) const {
    return members_[curve];
  }
  const std::vector<ContinuumMember>& alone() const { return alone_; }

 private:
  const SolutionCurve& curve(std::size_t i) const {
    const std::lock_guard lock(mutex_);
    return curves_[i];
  }
  void place(ContinuumMember& solution, std::size_t first, std::size_t end) const {
    for (std::size_t i = first; i < end && solution.family < 0; ++i) {
      if (place_on(formulation_, curve(i), solution.x, options_.curve))
        solution.family = static_cast<int>(i);
    }
  }

  const Formulation& formulation_;
  const StopCondition& stop_;
  const ContinuumOptions& options_;
  mutable std::mutex mutex_;  // of curves_, whose elements stay where they are
  std::deque<SolutionCurve> curves_;
  std::vector<std::vector<ContinuumMember>> members_;
  std::vector<ContinuumMember> alone_;
};

}  // namespace

Continua follow_continua(const CaptureProblem& problem, const Formulation& formulation,
                         const std::vector<ContinuumMember>& solutions,
                         const std::function<bool(const Configuration&)>& is_free,
                         const StopCondition& stop, int jobs, const ContinuumOptions& options) {
  CurveCollection collection(formulation, stop, options);
  std::vector<std::optional<CurveCollection::Found>> found(solutions.size());
  const int looked_at = for_each_index(
      jobs, static_cast<int>(solutions.size()), stop,
      [&](int i) {
        const auto k = static_cast<std::size_t>(i);
        found[k] = collection.look_at(solutions[k]);
      },
      [&](int i) { collection.take(std::move(*found[static_cast<std::size_t>(i)])); });
  for (auto i = static_cast<std::size_t>(looked_at); i < solutions.size(); ++i) {
    collection.take(collection.look_at(solutions[i]));  // traces none after a stop
  }

  Continua out;
  out.solutions = collection.alone();
  struct Place {
    std::size_t curve, point;
  };
  std::vector<RatedCurve> curves;
  std::vector<Place> places;
  for (SolutionCurve& curve : collection.curves()) {
    SolutionFamily family{curve.arc_length, curve.is_closed, curve.is_complete, 0,
                          points_along(formulation, curve, options)};
    for (const ContinuumMember& member : collection.members_of(curves.size())) {
      family.starts += member.reached;
    }
    out.families.push_back(family);
    for (std::size_t i = 0; i < curve.points.size(); ++i) places.push_back({curves.size(), i});
    curves.emplace_back(problem, formulation, std::move(curve), options);
  }
  const auto rate = [&](int i) {
    const Place at = places[static_cast<std::size_t>(i)];
    curves[at.curve].rate(at.point, is_free);
  };
  const auto places_rated =
      static_cast<std::size_t>(for_each_index(jobs, static_cast<int>(places.size()), stop, rate));
  std::size_t rated = curves.size();
  if (places_rated < places.size()) rated = places[places_rated].curve;

  std::vector<std::vector<ContinuumMember>> best(rated);
  const auto find_best = [&](int i) {
    const auto k = static_cast<std::size_t>(i);
    best[k] = best_of(curves[k], formulation, collection.members_of(k));
  };
  const auto finished =
      static_cast<std::size_t>(for_each_index(jobs, static_cast<int>(rated), stop, find_best));
  for (std::size_t i = 0; i < curves.size(); ++i) {
    const std::vector<ContinuumMember>& points = i < finished ? best[i] : collection.members_of(i);
    out.solutions.insert(out.solutions.end(), points.begin(), points.end());
  }
  out.stopped = stop.reached();
  return out;
}

}  // namespace stillbase
