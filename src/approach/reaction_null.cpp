#include "approach/reaction_null.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <stillbase/core/random.hpp>

#include "approach/geometric_path.hpp"
#include "approach/null_guide.hpp"
#include "approach/null_tracker.hpp"

namespace stillbase {

namespace {

constexpr int kKnots = 8;       ///< beside the start
constexpr int kFineSteps = 40;  ///< between knots, of the curve that is kept
constexpr int kTries = 8;       ///< references, the straight line first
constexpr int kEnough = 2;      ///< curves of which the one with the best end is taken
constexpr int kImprovements = 4;
constexpr double kSameMeasure = 1e-9;  ///< in the unit of the objective
constexpr int kGuides = 2;             ///< ways around obstacles, when no such curve is clear
constexpr int kGuideEffort = 10;       ///< part of the planner's iterations for each
constexpr double kGuideSpacing = 0.4;  ///< rad between the knots along those

/// The straight line, and wider detours the longer one tries.
Knots reference(const NullTracker& tracker, const JointVectord& start, const JointVectord& goal,
                int number, Random& random) {
  const Eigen::VectorXd a = tracker.free_part(start), b = tracker.free_part(goal);
  Knots knots(a.size(), kKnots + 1);
  for (int k = 0; k <= kKnots; ++k) knots.col(k) = a + (b - a) * k / kKnots;
  const double width = 0.15 * number;
  for (int wave = 1; wave <= 3 && number > 0; ++wave) {
    for (Eigen::Index row = 0; row < a.size(); ++row) {
      const double size = width / wave * random.normal();
      for (int k = 1; k < kKnots; ++k) {
        knots(row, k) += size * std::sin(3.141592653589793 * wave * k / kKnots);
      }
    }
  }
  return knots;
}

bool keeps_limits(const RobotModel& robot, const JointPath& curve) {
  for (const JointVectord& phi : curve.phi) {
    for (int k = 0; k < robot.n(); ++k) {
      const Joint& joint = robot.joints[static_cast<std::size_t>(k)];
      if (phi[k] < joint.lower || phi[k] > joint.upper) return false;
    }
  }
  return true;
}

bool is_clear(const StillScene& scene, const JointPath& curve) {
  constexpr std::size_t kStride = 8;
  for (std::size_t i = 0; i + 1 < curve.phi.size(); i += kStride) {
    const std::size_t next = std::min(i + kStride, curve.phi.size() - 1);
    if (!scene.is_motion_clear(curve.phi[i], curve.phi[next])) return false;
  }
  return true;
}

/// Knots along a rough way to near the goal, and on to it.
Knots along(const std::vector<Eigen::VectorXd>& guide, const Eigen::VectorXd& goal) {
  std::vector<Eigen::VectorXd> points = guide;
  points.push_back(goal);
  std::vector<double> lengths(1, 0.0);
  for (std::size_t i = 1; i < points.size(); ++i) {
    lengths.push_back(lengths.back() + (points[i] - points[i - 1]).norm());
  }
  const int count =
      std::clamp(static_cast<int>(lengths.back() / kGuideSpacing), kKnots, 2 * kKnots);
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
  Search(const NullPathQuery& query, const CaptureProblem& problem, const NullTracker& tracker,
         const StillScene& scene)
      : query_(query), problem_(problem), tracker_(tracker), scene_(scene) {}

  void look(Knots knots) {
    ++tried_;
    JointPath curve;
    auto end = tracker_.reach(
        [&](const JointVectord& phi) { return query_.goal_near(phi, ContactSolve::Nearest); },
        kFineSteps, knots, curve);
    if (!end) return;
    ++arrived_;
    if (!keeps_limits(problem_.robot, curve)) return;
    ++within_limits_;
    if (!is_clear(scene_, curve)) return;
    ++clear_;
    improve(knots, curve, *end);
    JointPath path = over_length(curve);
    const double measure = query_.measure(*end);
    if (measure < measure_ - kSameMeasure ||
        (measure < measure_ + kSameMeasure && path.times.back() < best_.times.back())) {
      best_ = std::move(path);
      end_ = *end;
      measure_ = measure;
    }
  }

  int clear() const { return clear_; }
  bool is_done() const { return clear_ >= kEnough || measure_ <= kSameMeasure; }
  NullPathAnswer answer() const {
    return {
        best_, end_,
        fmt::format("of {} curves within the reaction null space {} end at the goal, {} of them "
                    "within the joint limits, {} of these clear of bodies",
                    tried_, arrived_, within_limits_, clear_),
        false};
  }

 private:
  /// Bends the curve on to a best posture near its end, a part of the way where all of it does not
  /// go.
  void improve(Knots& knots, JointPath& curve, Configuration& end) const {
    double part = 1;
    for (int round = 0; round < kImprovements && !query_.stop.reached(); ++round) {
      Knots bent = knots;
      JointPath there;
      std::optional<Configuration> reached;
      if (part == 1) {
        reached = tracker_.reach(
            [&](const JointVectord& phi) { return query_.goal_near(phi, ContactSolve::Best); },
            kFineSteps, bent, there);
      } else if (const auto best = query_.goal_near(end.phi, ContactSolve::Best)) {
        const auto goal =
            query_.goal_near(end.phi + part * (best->phi - end.phi), ContactSolve::Nearest);
        reached =
            tracker_.reach([&](const JointVectord&) { return goal; }, kFineSteps, bent, there);
      }
      const bool better = reached &&
                          query_.measure(*reached) < query_.measure(end) - kSameMeasure &&
                          keeps_limits(problem_.robot, there) && is_clear(scene_, there);
      if (!better) {
        part /= 2;
        continue;
      }
      knots = std::move(bent);
      curve = std::move(there);
      end = *reached;
      if (part == 1) return;
    }
  }

  const NullPathQuery& query_;
  const CaptureProblem& problem_;
  const NullTracker& tracker_;
  const StillScene& scene_;
  JointPath best_;
  Configuration end_;
  double measure_ = kInfinity;
  int tried_ = 0, arrived_ = 0, within_limits_ = 0, clear_ = 0;
};

}  // namespace

NullPathAnswer plan_null_path(const NullPathQuery& query, const CaptureProblem& problem,
                              const StillScene& scene) {
  const NullTracker tracker(problem.robot, query.start, query.free);
  Random random(query.seed);
  Search search(query, problem, tracker, scene);
  for (int number = 0; number < kTries && !search.is_done() && !query.stop.reached(); ++number) {
    search.look(reference(tracker, query.start, query.goal, number, random));
  }
  const auto full = [&](const Eigen::VectorXd& part) {
    JointVectord phi = query.start;
    for (std::size_t i = 0; i < query.free.size(); ++i) {
      phi[query.free[i]] = part[static_cast<Eigen::Index>(i)];
    }
    return phi;
  };
  GuideQuery rough;
  rough.start = tracker.free_part(query.start);
  rough.goal = tracker.free_part(query.goal);
  rough.lower = query.lower;
  rough.upper = query.upper;
  rough.max_iterations = query.max_iterations / kGuideEffort;
  rough.stop = query.stop;
  rough.is_valid = [&](const Eigen::VectorXd& part) { return !scene.first_hit(full(part)); };
  rough.projected = [&](const Eigen::VectorXd& part, const Eigen::VectorXd& wanted) {
    return tracker.projected(full(part), wanted);
  };
  for (int i = 0; i < kGuides && search.clear() == 0 && !query.stop.reached(); ++i) {
    rough.seed = random.next();
    const std::vector<Eigen::VectorXd> guide = find_guide(rough);
    if (guide.size() >= 2) search.look(along(guide, rough.goal));
  }
  NullPathAnswer answer = search.answer();
  answer.stopped = answer.curve.times.empty() && query.stop.reached();
  if (answer.stopped) answer.detail = "stopped while the path was planned";
  return answer;
}

}  // namespace stillbase
