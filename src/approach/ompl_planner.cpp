// Path planning and simplification by OMPL.
//
// Reproducible: planner, sampler and simplifier get seeds, and iterations are counted instead of
// seconds.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <stdexcept>
#include <string_view>
#include <utility>

#include <ompl/base/MotionValidator.h>
#include <ompl/base/ProblemDefinition.h>
#include <ompl/base/SpaceInformation.h>
#include <ompl/base/objectives/PathLengthOptimizationObjective.h>
#include <ompl/geometric/PathGeometric.h>
#include <ompl/geometric/PathSimplifier.h>
#include <ompl/geometric/planners/informedtrees/AITstar.h>
#include <ompl/geometric/planners/informedtrees/BITstar.h>
#include <ompl/geometric/planners/kpiece/LBKPIECE1.h>
#include <ompl/geometric/planners/prm/LazyPRMstar.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>
#include <ompl/geometric/planners/rrt/RRTstar.h>

#include <stillbase/approach/approach.hpp>

#include "approach/ompl_support.hpp"
#include "approach/path_planner.hpp"

namespace stillbase {

namespace {

namespace ob = ompl::base;
namespace og = ompl::geometric;
using Space = ob::RealVectorStateSpace;

/// Edge length of the trees, rad: small beside a joint's range, large beside the resolution.
constexpr double kTreeRange = 0.5;

JointVectord to_joints(const ob::State* state, unsigned dimension) {
  JointVectord phi(static_cast<Eigen::Index>(dimension));
  const double* values = state->as<Space::StateType>()->values;
  for (unsigned k = 0; k < dimension; ++k) phi[k] = values[k];
  return phi;
}

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

struct NamedPlanner {
  std::string_view name;
  ob::PlannerPtr (*make)(const ob::SpaceInformationPtr&, std::uint_fast32_t seed);
  bool improves;      ///< goes on after its first solution
  bool hides_random;  ///< generators that cannot be seeded one by one
};

/// Improving planners get this many of their iterations after the first solution. Simplification
/// and polish do the rest.
constexpr int kImprovement = 500;

ob::PlannerPtr make_rrt_connect(const ob::SpaceInformationPtr& si, std::uint_fast32_t seed) {
  auto planner = std::make_shared<SeededRrtConnect>(si, seed);
  planner->setRange(kTreeRange);
  return planner;
}

ob::PlannerPtr make_rrt_star(const ob::SpaceInformationPtr& si, std::uint_fast32_t) {
  auto planner = std::make_shared<og::RRTstar>(si);
  planner->setRange(kTreeRange);
  return planner;
}

/// Cells of half a radian in the first three joints: those move the most of the arm.
class ShoulderProjection : public ob::ProjectionEvaluator {
 public:
  explicit ShoulderProjection(const ob::StateSpacePtr& space) : ob::ProjectionEvaluator(space) {
    setCellSizes(std::vector<double>(getDimension(), kTreeRange));
  }
  unsigned int getDimension() const override { return std::min(3u, space_->getDimension()); }
  void project(const ob::State* state, Eigen::Ref<Eigen::VectorXd> out) const override {
    const double* values = state->as<Space::StateType>()->values;
    for (unsigned k = 0; k < getDimension(); ++k) out[k] = values[k];
  }
};

ob::PlannerPtr make_kpiece(const ob::SpaceInformationPtr& si, std::uint_fast32_t) {
  auto planner = std::make_shared<og::LBKPIECE1>(si);
  planner->setRange(kTreeRange);
  planner->setProjectionEvaluator(std::make_shared<ShoulderProjection>(si->getStateSpace()));
  return planner;
}

template <class Planner>
ob::PlannerPtr make_plain(const ob::SpaceInformationPtr& si, std::uint_fast32_t) {
  return std::make_shared<Planner>(si);
}

// PRM* with lazy checks: OMPL's eager one looks for the solution in a second thread, so that what
// it finds depends on the load of the machine. KPIECE in its bidirectional form.
constexpr std::array<NamedPlanner, 6> kPlanners = {
    {{"rrt_connect", make_rrt_connect, false, false},
     {"rrt_star", make_rrt_star, true, true},
     {"prm_star", make_plain<og::LazyPRMstar>, true, true},
     {"bit_star", make_plain<og::BITstar>, true, true},
     {"ait_star", make_plain<og::AITstar>, true, true},
     {"kpiece", make_kpiece, false, true}}};

const NamedPlanner* find_planner(const std::string& name) {
  for (const NamedPlanner& planner : kPlanners) {
    if (planner.name == name) return &planner;
  }
  return nullptr;
}

/// Whether an improving planner reports the cost of a solution.
bool states_cost(const ob::Planner& planner) {
  const auto& properties = planner.getPlannerProgressProperties();
  const auto cost = properties.find("best cost REAL");
  if (cost == properties.end()) return false;
  const std::string text = cost->second();
  return !text.empty() && std::isfinite(std::strtod(text.c_str(), nullptr));
}

PathAnswer plan_with(const NamedPlanner& named, const PathQuery& query) {
  const auto n = static_cast<unsigned>(query.start.size());
  // The gate: OMPL takes NaN for a valid state, and NaN bounds end the process.
  if (!query.start.allFinite() || !query.goal.allFinite() || !query.lower.allFinite() ||
      !query.upper.allFinite() || !(query.lower.array() < query.upper.array()).all()) {
    throw std::invalid_argument("path query with numbers that are not finite or empty bounds");
  }
  Random seeds(query.seed);
  const auto planner_seed = local_seed(seeds), simplifier_seed = local_seed(seeds);
  std::shared_lock<std::shared_mutex> shared;
  std::unique_lock<std::shared_mutex> alone;
  if (named.hides_random) {
    alone = own_ompl(planner_seed);
  } else {
    shared = share_ompl();
  }
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
  definition->setOptimizationObjective(std::make_shared<ob::PathLengthOptimizationObjective>(si));
  bool solved = false;  // planners tell it in one of three ways before they end
  definition->setIntermediateSolutionCallback([&](const ob::Planner*,
                                                  const std::vector<const ob::State*>&,
                                                  const ob::Cost) { solved = true; });
  const ob::PlannerPtr planner = named.make(si, planner_seed);
  planner->setProblemDefinition(definition);
  planner->setup();

  long asked = 0, last = query.max_iterations;
  bool improving = false;
  const ob::PlannerTerminationCondition finished([&] {
    if (named.improves && !improving &&
        (solved || definition->hasExactSolution() || states_cost(*planner))) {
      improving = true;
      last = std::min(last, asked + kImprovement);
    }
    return ++asked > last || query.stop.reached();
  });
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

}  // namespace

PathPlanner find_path_planner(const std::string& name) {
  const NamedPlanner* named = find_planner(name);
  if (named == nullptr) return nullptr;
  return [named](const PathQuery& query) { return plan_with(*named, query); };
}

std::vector<std::string> approach_planner_names() {
  std::vector<std::string> names;
  for (const NamedPlanner& planner : kPlanners) names.emplace_back(planner.name);
  return names;
}

}  // namespace stillbase
