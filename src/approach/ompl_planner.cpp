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
#include <ompl/base/goals/GoalStates.h>
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

#include "approach/ompl_layers.hpp"
#include "approach/ompl_support.hpp"
#include "approach/path_planner.hpp"

namespace stillbase {

namespace {

namespace ob = ompl::base;
namespace og = ompl::geometric;
using Space = ob::RealVectorStateSpace;

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

/// The query's worlds as OMPL sees them: one goal as it is, several in layers.
class Worlds {
 public:
  explicit Worlds(const PathQuery& query)
      : query_(query), joints_(static_cast<unsigned>(query.lower.size())) {
    const unsigned layers = static_cast<unsigned>(query.ends.size());
    if (layers > 1) {
      layered_ = std::make_shared<LayeredSpace>(joints_);
      space_ = layered_;
    } else {
      space_ = std::make_shared<Space>(joints_);
    }
    ob::RealVectorBounds bounds(space_->getDimension());
    for (unsigned k = 0; k < joints_; ++k) {
      bounds.setLow(k, query.lower[k]);
      bounds.setHigh(k, query.upper[k]);
    }
    if (layered_) {
      bounds.setLow(joints_, -kLayerHeight / 4);
      bounds.setHigh(joints_, (layers - 0.75) * kLayerHeight);
    }
    space_->setBounds(bounds);
  }

  const std::shared_ptr<Space>& space() const { return space_; }

  void seed_samplers(Random& seeds) {
    std::vector<double> weights;
    for (const PathEnds& ends : query_.ends) weights.push_back(ends.weight);
    space_->setStateSamplerAllocator(
        [&seeds, weights](const ob::StateSpace* s) -> ob::StateSamplerPtr {
          if (weights.size() > 1) {
            return std::make_shared<LayeredSampler>(s, local_seed(seeds), weights);
          }
          return std::make_shared<SeededSampler>(s, local_seed(seeds));
        });
  }

  void add_ends(const ob::SpaceInformationPtr& si, ob::ProblemDefinition& definition) const {
    auto goals = std::make_shared<ob::GoalStates>(si);
    ob::ScopedState<Space> start(space_), goal(space_);
    for (std::size_t i = 0; i < query_.ends.size(); ++i) {
      for (unsigned k = 0; k < joints_; ++k) {
        start[k] = query_.ends[i].start[k];
        goal[k] = query_.ends[i].goal[k];
      }
      if (layered_) start[joints_] = goal[joints_] = kLayerHeight * static_cast<double>(i);
      definition.addStartState(start);
      goals->addState(goal);
    }
    definition.setGoal(goals);
  }

  JointVectord posture(const ob::State* state) const {
    JointVectord phi(static_cast<Eigen::Index>(joints_));
    const double* values = state->as<Space::StateType>()->values;
    for (unsigned k = 0; k < joints_; ++k) phi[k] = values[k];
    return phi;
  }
  /// Index in the query's ends; negative: in no world.
  long world(const ob::State* state) const { return layered_ ? layered_->layer_of(state) : 0; }

  bool is_valid(const ob::State* state) const {
    const long at = world(state);
    return at >= 0 && query_.is_valid(static_cast<std::size_t>(at), posture(state));
  }
  bool is_motion_valid(const ob::State* a, const ob::State* b) const {
    const long at = world(a);
    return at >= 0 && at == world(b) && is_valid(b) &&
           query_.is_motion_valid(static_cast<std::size_t>(at), posture(a), posture(b));
  }

 private:
  const PathQuery& query_;
  unsigned joints_;
  std::shared_ptr<LayeredSpace> layered_;
  std::shared_ptr<Space> space_;
};

class MotionCheck : public ob::MotionValidator {
 public:
  MotionCheck(const ob::SpaceInformationPtr& si, const Worlds& worlds)
      : ob::MotionValidator(si), worlds_(worlds) {}

  bool checkMotion(const ob::State* a, const ob::State* b) const override {
    return worlds_.is_motion_valid(a, b);
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
  const Worlds& worlds_;
};

/// Alternates OMPL's simplification steps until they no longer shorten the path.
void simplify(const ob::SpaceInformationPtr& si, og::PathGeometric& path, std::uint_fast32_t seed,
              const StopCondition& stop, int rounds) {
  SeededSimplifier simplifier(si, seed);
  for (int round = 0; round < rounds && !stop.reached(); ++round) {
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
  ob::PlannerPtr (*make)(const ob::SpaceInformationPtr&, std::uint_fast32_t seed,
                         double tree_range);
  bool improves;      ///< goes on after its first solution
  bool hides_random;  ///< generators that cannot be seeded one by one
  bool takes_sets;    ///< takes several starts and goals
};

ob::PlannerPtr make_rrt_connect(const ob::SpaceInformationPtr& si, std::uint_fast32_t seed,
                                double tree_range) {
  auto planner = std::make_shared<SeededRrtConnect>(si, seed);
  planner->setRange(tree_range);
  return planner;
}

ob::PlannerPtr make_rrt_star(const ob::SpaceInformationPtr& si, std::uint_fast32_t,
                             double tree_range) {
  auto planner = std::make_shared<og::RRTstar>(si);
  planner->setRange(tree_range);
  return planner;
}

/// Cells in the first three joints, which move the most of the arm, in each layer.
class ShoulderProjection : public ob::ProjectionEvaluator {
 public:
  ShoulderProjection(const ob::StateSpacePtr& space, double cell_size)
      : ob::ProjectionEvaluator(space),
        layered_(dynamic_cast<const LayeredSpace*>(space.get()) != nullptr),
        shoulder_(std::min(3u, space->getDimension() - (layered_ ? 1u : 0u))) {
    std::vector<double> sizes(shoulder_, cell_size);
    if (layered_) sizes.push_back(kLayerHeight / 2);
    setCellSizes(sizes);
  }
  unsigned int getDimension() const override { return shoulder_ + (layered_ ? 1u : 0u); }
  void project(const ob::State* state, Eigen::Ref<Eigen::VectorXd> out) const override {
    const double* values = state->as<Space::StateType>()->values;
    for (unsigned k = 0; k < shoulder_; ++k) out[k] = values[k];
    if (layered_) out[shoulder_] = values[space_->getDimension() - 1];
  }

 private:
  bool layered_;
  unsigned shoulder_;
};

ob::PlannerPtr make_kpiece(const ob::SpaceInformationPtr& si, std::uint_fast32_t,
                           double tree_range) {
  auto planner = std::make_shared<og::LBKPIECE1>(si);
  planner->setRange(tree_range);
  planner->setProjectionEvaluator(
      std::make_shared<ShoulderProjection>(si->getStateSpace(), tree_range));
  return planner;
}

template <class Planner>
ob::PlannerPtr make_plain(const ob::SpaceInformationPtr& si, std::uint_fast32_t, double) {
  return std::make_shared<Planner>(si);
}

// PRM* with lazy checks: OMPL's eager one looks for the solution in a second thread, so that what
// it finds depends on the load of the machine. KPIECE in its bidirectional form.
constexpr std::array<NamedPlanner, 6> kPlanners = {
    {{"rrt_connect", make_rrt_connect, false, false, true},
     {"rrt_star", make_rrt_star, true, true, true},
     {"prm_star", make_plain<og::LazyPRMstar>, true, true, false},
     {"bit_star", make_plain<og::BITstar>, true, true, true},
     {"ait_star", make_plain<og::AITstar>, true, true, true},
     {"kpiece", make_kpiece, false, true, true}}};

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
  // The gate: OMPL takes NaN for a valid state, and NaN bounds end the process.
  bool sound = !query.ends.empty() && query.lower.allFinite() && query.upper.allFinite() &&
               (query.lower.array() < query.upper.array()).all();
  for (const PathEnds& ends : query.ends) {
    sound = sound && ends.start.allFinite() && ends.goal.allFinite() && ends.weight > 0;
  }
  if (!sound) {
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
  Worlds worlds(query);
  worlds.seed_samplers(seeds);
  const std::shared_ptr<Space>& space = worlds.space();
  space->setLongestValidSegmentFraction(
      std::min(query.resolution / space->getMaximumExtent(), 1.0));

  auto si = std::make_shared<ob::SpaceInformation>(space);
  si->setStateValidityChecker([&](const ob::State* state) { return worlds.is_valid(state); });
  si->setMotionValidator(std::make_shared<MotionCheck>(si, worlds));
  si->setup();

  auto definition = std::make_shared<ob::ProblemDefinition>(si);
  worlds.add_ends(si, *definition);
  definition->setOptimizationObjective(std::make_shared<ob::PathLengthOptimizationObjective>(si));
  bool solved = false;  // planners report it by one of three means before they end
  definition->setIntermediateSolutionCallback([&](const ob::Planner*,
                                                  const std::vector<const ob::State*>&,
                                                  const ob::Cost) { solved = true; });
  const ob::PlannerPtr planner = named.make(si, planner_seed, query.options.tree_range);
  planner->setProblemDefinition(definition);
  planner->setup();

  long asked = 0, last = query.max_iterations;
  bool improving = false;
  const ob::PlannerTerminationCondition finished([&] {
    if (named.improves && !improving &&
        (solved || definition->hasExactSolution() || states_cost(*planner))) {
      improving = true;
      last = std::min(last, asked + query.options.improvement_iterations);
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
  simplify(si, path, simplifier_seed, query.stop, query.options.simplification_rounds);
  if (query.stop.reached()) {
    answer.outcome = PathOutcome::Stopped;
    return answer;
  }
  answer.outcome = PathOutcome::Found;
  for (const ob::State* state : path.getStates()) {
    answer.points.push_back(worlds.posture(state));
  }
  answer.reached = static_cast<std::size_t>(worlds.world(path.getStates().front()));
  return answer;
}

/// One goal after the other, the iterations shared out, for planners that take one only.
PathAnswer plan_in_turn(const NamedPlanner& named, const PathQuery& query) {
  PathAnswer answer;
  for (std::size_t i = 0; i < query.ends.size(); ++i) {
    PathQuery one = query;
    one.ends = {query.ends[i]};
    one.max_iterations = std::max(1, query.max_iterations / static_cast<int>(query.ends.size()));
    one.is_valid = [&, i](std::size_t, const JointVectord& phi) { return query.is_valid(i, phi); };
    one.is_motion_valid = [&, i](std::size_t, const JointVectord& a, const JointVectord& b) {
      return query.is_motion_valid(i, a, b);
    };
    answer = plan_with(named, one);
    answer.reached = i;
    if (answer.outcome != PathOutcome::NotFound) break;
  }
  return answer;
}

}  // namespace

PathPlanner find_path_planner(const std::string& name) {
  const NamedPlanner* named = find_planner(name);
  if (named == nullptr) return nullptr;
  return [named](const PathQuery& query) {
    const bool in_turn = query.ends.size() > 1 && !named->takes_sets;
    return in_turn ? plan_in_turn(*named, query) : plan_with(*named, query);
  };
}

std::vector<std::string> approach_planner_names() {
  std::vector<std::string> names;
  for (const NamedPlanner& planner : kPlanners) names.emplace_back(planner.name);
  return names;
}

}  // namespace stillbase
