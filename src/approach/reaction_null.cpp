#include "approach/reaction_null.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <stillbase/core/random.hpp>

#include "approach/null_tracker.hpp"
#include "approach/time_law.hpp"

namespace stillbase {

namespace {

/// The straight line, and wider detours the longer one tries.
Knots reference(const NullTracker& tracker, const JointVectord& start, const JointVectord& goal,
                int number, const NullSpaceOptions& options, Random& random) {
  const int count = options.knots;
  const Eigen::VectorXd a = tracker.free_part(start), b = tracker.free_part(goal);
  Knots knots(a.size(), count + 1);
  for (int k = 0; k <= count; ++k) knots.col(k) = a + (b - a) * k / count;
  const double width = options.detour_width * number;
  for (int wave = 1; wave <= options.detour_waves && number > 0; ++wave) {
    for (Eigen::Index row = 0; row < a.size(); ++row) {
      const double size = width / wave * random.normal();
      for (int k = 1; k < count; ++k) knots(row, k) += size * std::sin(kPi * wave * k / count);
    }
  }
  return knots;
}

/// Knots along a rough path to near the goal, and on to it.
Knots along(std::vector<JointVectord> points, const JointVectord& goal,
            const NullSpaceOptions& options) {
  points.push_back(goal);
  std::vector<double> lengths(1, 0.0);
  for (std::size_t i = 1; i < points.size(); ++i) {
    lengths.push_back(lengths.back() + (points[i] - points[i - 1]).norm());
  }
  const int count = std::clamp(static_cast<int>(lengths.back() / options.guide_spacing),
                               options.knots, 2 * options.knots);
  Knots knots(goal.size(), count + 1);
  std::size_t i = 0;
  for (int k = 0; k <= count; ++k) {
    const double at = lengths.back() * k / count;
    while (i + 2 < lengths.size() && lengths[i + 1] < at) ++i;
    const double span = lengths[i + 1] - lengths[i];
    const double part = span > 0 ? (at - lengths[i]) / span : 0;
    knots.col(k) = points[i] + std::min(part, 1.0) * (points[i + 1] - points[i]);
  }
  return knots;
}

/// A goal with its own obstacles.
struct NullGoal {
  const AttemptGoal& attempt;
  const StillScene& scene;

  const ApproachTask& task() const { return attempt.task; }
  std::optional<Configuration> near(const JointVectord& phi, ContactSolve how) const {
    const auto& solve = task().contact.near_posture;
    return solve ? solve(phi, how) : task().goal;
  }
  double measure(const Configuration& end) const {
    return task().contact.measure ? task().contact.measure(end) : 0.0;
  }
  /// Whether nothing touches while the robot waits at a configuration.
  bool can_wait(const Configuration& end) const {
    const std::optional<TargetMotion> target = target_for(task(), end);
    return !first_hit(task(), waiting_motion(end, attempt.wait), target ? &*target : nullptr);
  }
  bool keeps_limits(const JointPath& curve) const {
    return std::all_of(curve.phi.begin(), curve.phi.end(), [&](const JointVectord& phi) {
      return joint_outside_limits(task().problem.robot, phi, 0) == nullptr;
    });
  }
  bool is_clear(const JointPath& curve) const {
    const std::size_t stride = task().options.null_space.clearance_stride;
    for (std::size_t i = 0; i + 1 < curve.phi.size(); i += stride) {
      const std::size_t next = std::min(i + stride, curve.phi.size() - 1);
      if (!scene.is_motion_clear(curve.phi[i], curve.phi[next])) return false;
    }
    return true;
  }
};

/// A curve within the null space, its reference and its end.
struct NullCurve {
  Knots knots;
  JointPath path;
  Configuration end;
};

/// Curves tried one after the other; the one with the best end is kept, of equals the shortest.
class Search {
 public:
  Search(const NullTracker& tracker, const NullSpaceOptions& options, const StopCondition& stop)
      : tracker_(tracker), options_(options), stop_(stop) {}

  void try_reference(const NullGoal& goal, std::size_t number, Knots knots) {
    ++tried_;
    // Where the contact cannot be solved nearby the curve heads for the goal itself.
    const auto nearest = [&](const JointVectord& phi) {
      auto near = goal.near(phi, ContactSolve::Nearest);
      return near ? near : goal.near(goal.task().goal.phi, ContactSolve::Nearest);
    };
    NullCurve curve{std::move(knots), {}, {}};
    const auto end = tracker_.reach(nearest, curve.knots, curve.path);
    if (!end) return;
    ++arrived_;
    if (!goal.keeps_limits(curve.path)) return;
    ++within_limits_;
    if (!goal.is_clear(curve.path) || !goal.can_wait(*end)) return;
    ++clear_;
    curve.end = *end;
    improve(goal, curve);
    JointPath path = over_length(curve.path);
    const double measure = goal.measure(curve.end);
    if (measure < measure_ - options_.same_measure ||
        (measure < measure_ + options_.same_measure && path.times.back() < best_.times.back())) {
      best_ = std::move(path);
      end_ = curve.end;
      goal_ = number;
      measure_ = measure;
    }
  }

  bool found() const { return clear_ > 0; }
  bool is_done() const { return clear_ >= options_.enough || measure_ <= options_.same_measure; }

  JointPath take(AttemptResult& result, std::size_t& reached) {
    if (found()) {
      result.end = end_;
      reached = goal_;
    } else if (stop_.reached()) {
      result.status = ApproachStatus::TimeOut;
      result.detail = "stopped while the path was planned";
    } else {
      result.status = ApproachStatus::UnreachableInBaseMode;
      result.detail = fmt::format(
          "of {} curves within the reaction null space {} end at the goal, {} of them "
          "within the joint limits, {} of these clear of bodies",
          tried_, arrived_, within_limits_, clear_);
    }
    return std::move(best_);
  }

 private:
  /// Bends the curve on to a best posture near its end; when it does not go there, downhill as far
  /// as it can be bent.
  void improve(const NullGoal& goal, NullCurve& curve) const {
    if (bend(goal, ContactSolve::Best, curve.knots, curve)) return;
    double stride = options_.first_stride;
    for (int round = 0; round < options_.improvements && stride > options_.last_stride; ++round) {
      if (stop_.reached()) return;
      const Eigen::VectorXd slope = measure_slope(goal, curve.end);
      if (!(slope.norm() > 0)) return;
      const Knots bent = tracker_.bent(curve.knots, -slope, stride);
      stride = bend(goal, ContactSolve::Nearest, bent, curve) ? 2 * stride : stride / 3;
    }
  }

  /// Takes the curve along other knots to a goal, when it is better, within limits and clear.
  bool bend(const NullGoal& goal, ContactSolve how, const Knots& knots, NullCurve& curve) const {
    NullCurve bent{knots, {}, {}};
    const auto reached = tracker_.reach(
        [&](const JointVectord& phi) { return goal.near(phi, how); }, bent.knots, bent.path);
    if (!reached || !(goal.measure(*reached) < goal.measure(curve.end) - options_.same_measure) ||
        !goal.keeps_limits(bent.path) || !goal.is_clear(bent.path) || !goal.can_wait(*reached)) {
      return false;
    }
    bent.end = *reached;
    curve = std::move(bent);
    return true;
  }

  /// d measure / d free joints of the end, along the contact: by differences.
  Eigen::VectorXd measure_slope(const NullGoal& goal, const Configuration& end) const {
    const double here = goal.measure(end);
    const std::vector<Eigen::Index>& free = goal.task().free;
    Eigen::VectorXd slope = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(free.size()));
    for (std::size_t i = 0; i < free.size(); ++i) {
      JointVectord beside = end.phi;
      beside[free[i]] += options_.measure_difference;
      const auto there = goal.near(beside, ContactSolve::Nearest);
      if (there) slope[i] = (goal.measure(*there) - here) / options_.measure_difference;
    }
    return slope;
  }

  const NullTracker& tracker_;
  const NullSpaceOptions& options_;
  const StopCondition& stop_;
  JointPath best_;
  Configuration end_;
  std::size_t goal_ = 0;
  double measure_ = kInfinity;
  int tried_ = 0, arrived_ = 0, within_limits_ = 0, clear_ = 0;
};

/// A rough path around the obstacles to a goal: postures of the free joints. Empty: none found.
std::vector<JointVectord> guide_to(const NullGoal& goal, const ApproachTask& first,
                                   const NullTracker& tracker, PathQuery query) {
  const auto full = [&](const JointVectord& part) {
    return with_free_part(first.start, first.free, part);
  };
  query.ends = {{tracker.free_part(first.start), tracker.free_part(goal.task().goal.phi), 1}};
  set_bounds(first, query.lower, query.upper);
  query.is_valid = [&](std::size_t, const JointVectord& part) {
    return !goal.scene.first_hit(full(part));
  };
  return find_guide(query, first.options.null_space,
                    [&](const JointVectord& part, const JointVectord& wanted) {
                      return tracker.projected(full(part), wanted);
                    });
}

}  // namespace

JointPath plan_null_path(const std::vector<const AttemptGoal*>& goals,
                         const std::vector<StillScene>& scenes, std::uint64_t seed,
                         const StopCondition& stop, AttemptResult& result, std::size_t& reached) {
  const ApproachTask& first = goals.front()->task;
  const NullSpaceOptions& options = first.options.null_space;
  const NullTracker tracker(first.problem.robot, first.start, first.free, options,
                            first.options.jobs, stop);
  Random random(seed);
  Search search(tracker, options, stop);
  const std::size_t count = goals.size();
  // The straight lines to all goals first: what is near in the null space is reached by one of
  // them.
  const int tries = count > 1 ? options.references_of_set : options.references;
  for (int i = 0; i < tries && !search.is_done() && !stop.reached(); ++i) {
    const std::size_t k = i % count;
    search.try_reference({*goals[k], scenes[k]}, k,
                         reference(tracker, first.start, goals[k]->task.goal.phi,
                                   static_cast<int>(i / count), options, random));
  }
  PathQuery query;
  query.max_iterations = goals.front()->max_iterations / options.guide_effort;
  query.stop = stop;
  for (int i = 0; i < options.guides && !search.found() && !stop.reached(); ++i) {
    const std::size_t k = i % count;
    const NullGoal goal{*goals[k], scenes[k]};
    query.seed = random.next();
    const auto guide = guide_to(goal, first, tracker, query);
    if (guide.size() < 2) continue;
    search.try_reference(goal, k, along(guide, tracker.free_part(goal.task().goal.phi), options));
  }
  return search.take(result, reached);
}

}  // namespace stillbase
