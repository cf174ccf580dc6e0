#include "approach/reaction_null.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <stillbase/core/constants.hpp>
#include <stillbase/core/random.hpp>

#include "approach/geometric_path.hpp"
#include "approach/null_guide.hpp"
#include "approach/null_tracker.hpp"
#include "approach/task.hpp"

namespace stillbase {

namespace {

constexpr double kSlopeDifference = 1e-4;  ///< rad
constexpr double kSameMeasure = 1e-9;      ///< in the unit of the objective

/// The straight line, and wider detours the longer one tries.
Knots reference(const NullTracker& tracker, const JointVectord& start, const JointVectord& goal,
                int number, int count, Random& random) {
  const Eigen::VectorXd a = tracker.free_part(start), b = tracker.free_part(goal);
  Knots knots(a.size(), count + 1);
  for (int k = 0; k <= count; ++k) knots.col(k) = a + (b - a) * k / count;
  const double width = 0.15 * number;
  for (int wave = 1; wave <= 3 && number > 0; ++wave) {
    for (Eigen::Index row = 0; row < a.size(); ++row) {
      const double size = width / wave * random.normal();
      for (int k = 1; k < count; ++k) {
        knots(row, k) += size * std::sin(kPi * wave * k / count);
      }
    }
  }
  return knots;
}

bool keeps_limits(const RobotModel& robot, const JointPath& curve) {
  return std::all_of(curve.phi.begin(), curve.phi.end(), [&](const JointVectord& phi) {
    return joint_outside_limits(robot, phi, 0) == nullptr;
  });
}

bool is_clear(const StillScene& scene, const JointPath& curve) {
  constexpr std::size_t kStride = 8;
  for (std::size_t i = 0; i + 1 < curve.phi.size(); i += kStride) {
    const std::size_t next = std::min(i + kStride, curve.phi.size() - 1);
    if (!scene.is_motion_clear(curve.phi[i], curve.phi[next])) return false;
  }
  return true;
}

/// Knots along a rough path to near the goal, and on to it.
Knots along(const std::vector<Eigen::VectorXd>& guide, const Eigen::VectorXd& goal,
            const NullSpaceOptions& options) {
  std::vector<Eigen::VectorXd> points = guide;
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

/// Curves tried one after the other; the one with the best end is kept, of equals the shortest.
class Search {
 public:
  Search(const NullPathQuery& query, const CaptureProblem& problem, const NullTracker& tracker)
      : query_(query), problem_(problem), tracker_(tracker) {}

  void try_reference(std::size_t number, Knots knots) {
    const NullGoal& goal = query_.goals[number];
    ++tried_;
    JointPath curve;
    // Too far off for the contact to be found: head for the goal itself.
    auto end = tracker_.reach(
        [&](const JointVectord& phi) {
          auto near = goal.near(phi, ContactSolve::Nearest);
          return near ? near : goal.near(goal.posture, ContactSolve::Nearest);
        },
        NullTracker::GoalKind::Smooth, knots, curve);
    if (!end) return;
    ++arrived_;
    if (!keeps_limits(problem_.robot, curve)) return;
    ++within_limits_;
    if (!is_clear(*goal.scene, curve) || !goal.can_wait(*end)) return;
    ++clear_;
    improve(goal, knots, curve, *end);
    JointPath path = over_length(curve);
    const double measure = goal.measure(*end);
    if (measure < measure_ - kSameMeasure ||
        (measure < measure_ + kSameMeasure && path.times.back() < best_.times.back())) {
      best_ = std::move(path);
      end_ = *end;
      goal_ = number;
      measure_ = measure;
    }
  }

  int clear() const { return clear_; }
  bool is_done() const { return clear_ >= query_.options.enough || measure_ <= kSameMeasure; }
  NullPathAnswer answer() const {
    return {
        best_, end_, goal_,
        fmt::format("of {} curves within the reaction null space {} end at the goal, {} of them "
                    "within the joint limits, {} of these clear of bodies",
                    tried_, arrived_, within_limits_, clear_),
        false};
  }

 private:
  /// Bends the curve on to a best posture near its end; when it does not go there, downhill as far
  /// as it can be bent.
  void improve(const NullGoal& goal, Knots& knots, JointPath& curve, Configuration& end) const {
    const auto best = [&](const JointVectord& phi) { return goal.near(phi, ContactSolve::Best); };
    if (bend(goal, best, knots, knots, curve, end) || query_.stop.reached()) return;
    double stride = query_.options.first_stride;
    for (int round = 0; round < query_.options.improvements && stride > query_.options.last_stride;
         ++round) {
      if (query_.stop.reached()) return;
      const Eigen::VectorXd slope = measure_slope(goal, end);
      if (!(slope.norm() > 0)) return;
      const Knots bent = tracker_.bent(knots, curve, -slope, stride);
      const auto nearest = [&](const JointVectord& phi) {
        return goal.near(phi, ContactSolve::Nearest);
      };
      stride = bend(goal, nearest, bent, knots, curve, end) ? 2 * stride : stride / 3;
    }
  }

  /// Takes the curve along other knots to a goal, when it is better, within limits and clear.
  bool bend(const NullGoal& goal, const NullTracker::GoalNear& near, Knots bent, Knots& knots,
            JointPath& curve, Configuration& end) const {
    JointPath there;
    const auto reached = tracker_.reach(near, NullTracker::GoalKind::Smooth, bent, there);
    if (!reached || !(goal.measure(*reached) < goal.measure(end) - kSameMeasure)) return false;
    if (!keeps_limits(problem_.robot, there) || !is_clear(*goal.scene, there)) return false;
    if (!goal.can_wait(*reached)) return false;
    knots = std::move(bent);
    curve = std::move(there);
    end = *reached;
    return true;
  }

  /// d measure / d free joints of the end, along the contact: by differences.
  Eigen::VectorXd measure_slope(const NullGoal& goal, const Configuration& end) const {
    const double here = goal.measure(end);
    Eigen::VectorXd slope = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(query_.free.size()));
    for (std::size_t i = 0; i < query_.free.size(); ++i) {
      JointVectord beside = end.phi;
      beside[query_.free[i]] += kSlopeDifference;
      const auto there = goal.near(beside, ContactSolve::Nearest);
      if (!there) continue;
      slope[static_cast<Eigen::Index>(i)] = (goal.measure(*there) - here) / kSlopeDifference;
    }
    return slope;
  }

  const NullPathQuery& query_;
  const CaptureProblem& problem_;
  const NullTracker& tracker_;
  JointPath best_;
  Configuration end_;
  std::size_t goal_ = 0;
  double measure_ = kInfinity;
  int tried_ = 0, arrived_ = 0, within_limits_ = 0, clear_ = 0;
};

/// A rough path around the obstacles to a goal.
std::vector<Eigen::VectorXd> guide_to(const NullPathQuery& query, const NullTracker& tracker,
                                      const NullGoal& goal, std::uint64_t seed) {
  const auto full = [&](const Eigen::VectorXd& part) {
    return with_free_part(query.start, query.free, part);
  };
  GuideQuery rough;
  rough.start = tracker.free_part(query.start);
  rough.goal = tracker.free_part(goal.posture);
  rough.lower = query.lower;
  rough.upper = query.upper;
  rough.seed = seed;
  rough.max_iterations = query.max_iterations / query.options.guide_effort;
  rough.stop = query.stop;
  rough.options = query.options;
  rough.is_valid = [&](const Eigen::VectorXd& part) { return !goal.scene->first_hit(full(part)); };
  rough.projected = [&](const Eigen::VectorXd& part, const Eigen::VectorXd& wanted) {
    return tracker.projected(full(part), wanted);
  };
  return find_guide(rough);
}

}  // namespace

NullPathAnswer plan_null_path(const NullPathQuery& query, const CaptureProblem& problem) {
  const NullTracker tracker(problem.robot, query.start, query.free, query.options);
  Random random(query.seed);
  Search search(query, problem, tracker);
  // The straight lines to all goals first: what is near in the null space is reached by one of
  // them.
  const std::size_t count = query.goals.size();
  const auto tries = static_cast<std::size_t>(count > 1 ? query.options.references_of_set
                                                        : query.options.references);
  for (std::size_t i = 0; i < tries && !search.is_done() && !query.stop.reached(); ++i) {
    const JointVectord& goal = query.goals[i % count].posture;
    search.try_reference(i % count,
                         reference(tracker, query.start, goal, static_cast<int>(i / count),
                                   query.options.knots, random));
  }
  const auto guides = static_cast<std::size_t>(query.options.guides);
  for (std::size_t i = 0; i < guides && search.clear() == 0 && !query.stop.reached(); ++i) {
    const Eigen::VectorXd goal = tracker.free_part(query.goals[i % count].posture);
    const auto guide = guide_to(query, tracker, query.goals[i % count], random.next());
    if (guide.size() >= 2) search.try_reference(i % count, along(guide, goal, query.options));
  }
  NullPathAnswer answer = search.answer();
  answer.stopped = answer.curve.times.empty() && query.stop.reached();
  if (answer.stopped) answer.detail = "stopped while the path was planned";
  return answer;
}

}  // namespace stillbase
