// Path planning and simplification by OMPL.
//
// Reproducible without touching OMPL's global seed, which is shared by all threads: planner,
// sampler and simplifier get local seeds, and iterations are counted instead of seconds.
#include <array>
#include <cmath>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <string_view>
#include <utility>

#include <ompl/base/MotionValidator.h>
#include <ompl/base/ProblemDefinition.h>
#include <ompl/base/SpaceInformation.h>
#include <ompl/base/spaces/RealVectorStateSpace.h>
#include <ompl/geometric/PathGeometric.h>
#include <ompl/geometric/PathSimplifier.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>
#include <ompl/util/Console.h>

#include <stillbase/approach/approach.hpp>
#include <stillbase/core/random.hpp>

#include "approach/path_planner.hpp"

namespace stillbase {

namespace {

namespace ob = ompl::base;
namespace og = ompl::geometric;
using Space = ob::RealVectorStateSpace;

/// Edge length of the trees, rad: small beside a joint's range, large beside the resolution.
constexpr double kTreeRange = 0.5;

/// OMPL writes to the console by itself; outcomes are reported by status instead.
class SilentLog : public ompl::msg::OutputHandler {
 public:
  void log(const std::string&, ompl::msg::LogLevel, const char*, int) override {}
};

void silence_ompl() {
  static std::once_flag once;
  static SilentLog log;
  std::call_once(once, [] { ompl::msg::useOutputHandler(&log); });
}

/// OMPL's seeds are 32 bits; 0 means "draw one from the clock".
std::uint_fast32_t local_seed(Random& random) {
  return static_cast<std::uint_fast32_t>(random.next() & 0x7fffffffu) | 1u;
}

JointVectord to_joints(const ob::State* state, unsigned dimension) {
  JointVectord phi(static_cast<Eigen::Index>(dimension));
  const double* values = state->as<Space::StateType>()->values;
  for (unsigned k = 0; k < dimension; ++k) phi[k] = values[k];
  return phi;
}

class SeededSampler : public ob::RealVectorStateSampler {
 public:
  SeededSampler(const ob::StateSpace* space, std::uint_fast32_t seed)
      : ob::RealVectorStateSampler(space) {
    rng_.setLocalSeed(seed);
  }
};

class SeededRrtConnect : public og::RRTConnect {
 public:
  SeededRrtConnect(const ob::SpaceInformationPtr& si, std::uint_fast32_t seed)
      : og::RRTConnect(si) {
    rng_.setLocalSeed(seed);
  }
};

class SeededSimplifier : public og::PathSimplifier {
 public:
  SeededSimplifier(const ob::SpaceInformationPtr& si, std::uint_fast32_t seed)
      : og::PathSimplifier(si) {
    rng_.setLocalSeed(seed);
  }
};

class MotionCheck : public ob::MotionValidator {
 public:
  MotionCheck(const ob::SpaceInformationPtr& si, const PathQuery& query)
      : ob::MotionValidator(si), query_(query), dimension_(si->getStateDimension()) {}

  bool checkMotion(const ob::State* a, const ob::State* b) const override {
    return query_.is_valid(to_joints(b, dimension_)) &&
           query_.is_motion_valid(to_joints(a, dimension_), to_joints(b, dimension_));
  }
  // How far one could go is not known; none of the planners used here asks.
  bool checkMotion(const ob::State* a, const ob::State* b,
                   std::pair<ob::State*, double>& last_valid) const override {
    const bool valid = checkMotion(a, b);
    last_valid.second = valid ? 1.0 : 0.0;
    if (last_valid.first != nullptr) si_->copyState(last_valid.first, valid ? b : a);
    return valid;
  }

 private:
  const PathQuery& query_;
  unsigned dimension_;
};

/// Alternates OMPL's simplification steps until they no longer shorten the path.
void simplify(const ob::SpaceInformationPtr& si, og::PathGeometric& path, std::uint_fast32_t seed,
              const StopCondition& stop) {
  constexpr int kMaxRounds = 6;
  SeededSimplifier simplifier(si, seed);
  for (int round = 0; round < kMaxRounds && !stop.reached(); ++round) {
    const double before = path.length();
    simplifier.reduceVertices(path);
    simplifier.collapseCloseVertices(path);
    simplifier.shortcutPath(path);
    if (path.length() > 0.99 * before && round > 0) break;
  }
  simplifier.reduceVertices(path);
}

using MakePlanner = ob::PlannerPtr (*)(const ob::SpaceInformationPtr&, std::uint_fast32_t);

ob::PlannerPtr make_rrt_connect(const ob::SpaceInformationPtr& si, std::uint_fast32_t seed) {
  auto planner = std::make_shared<SeededRrtConnect>(si, seed);
  planner->setRange(kTreeRange);
  return planner;
}

PathAnswer plan_with(MakePlanner make_planner, const PathQuery& query) {
  const auto n = static_cast<unsigned>(query.start.size());
  // The gate: OMPL takes NaN for a valid state, and NaN bounds end the process.
  if (!query.start.allFinite() || !query.goal.allFinite() || !query.lower.allFinite() ||
      !query.upper.allFinite() || !(query.lower.array() < query.upper.array()).all()) {
    throw std::invalid_argument("path query with numbers that are not finite or empty bounds");
  }
  silence_ompl();

  Random seeds(query.seed);
  const auto planner_seed = local_seed(seeds), simplifier_seed = local_seed(seeds);
  auto space = std::make_shared<Space>(n);
  ob::RealVectorBounds bounds(n);
  for (unsigned k = 0; k < n; ++k) {
    bounds.setLow(k, query.lower[k]);
    bounds.setHigh(k, query.upper[k]);
  }
  space->setBounds(bounds);
  space->setStateSamplerAllocator([&seeds](const ob::StateSpace* s) {
    return std::make_shared<SeededSampler>(s, local_seed(seeds));
  });
  space->setLongestValidSegmentFraction(
      std::min(query.resolution / space->getMaximumExtent(), 1.0));

  auto si = std::make_shared<ob::SpaceInformation>(space);
  si->setStateValidityChecker(
      [&](const ob::State* state) { return query.is_valid(to_joints(state, n)); });
  si->setMotionValidator(std::make_shared<MotionCheck>(si, query));
  si->setup();

  ob::ScopedState<Space> start(space), goal(space);
  for (unsigned k = 0; k < n; ++k) {
    start[k] = query.start[k];
    goal[k] = query.goal[k];
  }
  auto definition = std::make_shared<ob::ProblemDefinition>(si);
  definition->setStartAndGoalStates(start, goal);
  const ob::PlannerPtr planner = make_planner(si, planner_seed);
  planner->setProblemDefinition(definition);
  planner->setup();

  long asked = 0;
  const ob::PlannerTerminationCondition finished(
      [&] { return ++asked > query.max_iterations || query.stop.reached(); });
  const ob::PlannerStatus status = planner->solve(finished);

  PathAnswer answer;
  if (status != ob::PlannerStatus::EXACT_SOLUTION) {
    answer.outcome = query.stop.reached() ? PathOutcome::Stopped : PathOutcome::NotFound;
    return answer;
  }
  auto& path = *definition->getSolutionPath()->as<og::PathGeometric>();
  simplify(si, path, simplifier_seed, query.stop);
  if (query.stop.reached()) {
    answer.outcome = PathOutcome::Stopped;
    return answer;
  }
  answer.outcome = PathOutcome::Found;
  for (const ob::State* state : path.getStates()) answer.points.push_back(to_joints(state, n));
  return answer;
}

struct NamedPlanner {
  std::string_view name;
  PathPlanner plan;
};
constexpr std::array<NamedPlanner, 1> kPlanners = {
    {{"rrt_connect", [](const PathQuery& query) { return plan_with(make_rrt_connect, query); }}}};

}  // namespace

PathPlanner find_path_planner(const std::string& name) {
  for (const NamedPlanner& planner : kPlanners) {
    if (planner.name == name) return planner.plan;
  }
  return nullptr;
}

std::vector<std::string> approach_planner_names() {
  std::vector<std::string> names;
  for (const NamedPlanner& planner : kPlanners) names.emplace_back(planner.name);
  return names;
}

}  // namespace stillbase
