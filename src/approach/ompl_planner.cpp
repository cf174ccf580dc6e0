// Path planning and simplification by OMPL.
//
// Reproducible: planner, sampler and simplifier get seeds, and iterations are counted instead of
// seconds.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <numeric>
#include <string_view>
#include <utility>
#include <vector>

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

#include "approach/ompl_support.hpp"

namespace stillbase {

namespace {

namespace ob = ompl::base;
namespace og = ompl::geometric;

/// rad between two layers; far more than any path is long.
constexpr double kLayerHeight = 1000;

/// The worlds of a query as a space of OMPL: one goal as it is, several as one layer of postures
/// for each.
///
/// With several goals a state is [posture; layer * kLayerHeight]. Layers are far from each other
/// and nothing leads from one to another, so that a tree grows in the world of one goal alone.
/// Informed samplers put states slightly above and below a layer: they belong to the nearest one.
class Worlds : public ob::RealVectorStateSpace {
 public:
  explicit Worlds(const PathQuery& query)
      : ob::RealVectorStateSpace(
            static_cast<unsigned>(query.lower.size() + (query.ends.size() > 1 ? 1 : 0))),
        query_(query),
        joints_(static_cast<unsigned>(query.lower.size())),
        is_layered_(query.ends.size() > 1) {
    ob::RealVectorBounds bounds = bounds_of(query, getDimension());
    if (is_layered_) {
      bounds.setLow(joints_, -kLayerHeight / 4);
      bounds.setHigh(joints_, (static_cast<double>(query.ends.size()) - 0.75) * kLayerHeight);
    }
    setBounds(bounds);
  }

  const PathQuery& query() const { return query_; }
  unsigned joints() const { return joints_; }
  bool is_layered() const { return is_layered_; }

  double distance(const ob::State* a, const ob::State* b) const override {
    if (!is_layered_) return ob::RealVectorStateSpace::distance(a, b);
    double square = 0;
    for (unsigned k = 0; k < joints_; ++k) {
      const double difference = values_of(a)[k] - values_of(b)[k];
      square += difference * difference;
    }
    const long from = world(a), to = world(b);
    const bool same = from == to && from >= 0;
    return std::sqrt(square) + (same ? 0 : kLayerHeight);
  }

  void interpolate(const ob::State* from, const ob::State* to, double t,
                   ob::State* state) const override {
    const bool same = world(from) == world(to);
    ob::RealVectorStateSpace::interpolate(from, to, t, state);
    if (!same) values_of(state)[joints_] = -kLayerHeight / 2;  // in no layer
  }

  void add_ends(const ob::SpaceInformationPtr& si, ob::ProblemDefinition& definition) const {
    auto goals = std::make_shared<ob::GoalStates>(si);
    ob::ScopedState<> start(si), goal(si);
    for (std::size_t i = 0; i < query_.ends.size(); ++i) {
      for (unsigned k = 0; k < joints_; ++k) {
        start[k] = query_.ends[i].start[k];
        goal[k] = query_.ends[i].goal[k];
      }
      if (is_layered_) start[joints_] = goal[joints_] = kLayerHeight * static_cast<double>(i);
      definition.addStartState(start);
      goals->addState(goal);
    }
    definition.setGoal(goals);
  }

  /// Index in the query's ends; negative: between two layers.
  long world(const ob::State* state) const {
    if (!is_layered_) return 0;
    const double place = values_of(state)[joints_] / kLayerHeight;
    const double nearest = std::round(place);
    return std::abs(place - nearest) < 0.25 ? std::lround(nearest) : -1;
  }
  bool is_valid(const ob::State* state) const {
    const long at = world(state);
    return at >= 0 && query_.is_valid(at, posture_of(state, joints_));
  }
  bool is_motion_valid(const ob::State* a, const ob::State* b) const {
    const long at = world(a);
    return at >= 0 && at == world(b) && is_valid(b) &&
           query_.is_motion_valid(at, posture_of(a, joints_), posture_of(b, joints_));
  }

 private:
  const PathQuery& query_;
  unsigned joints_;
  bool is_layered_;
};

/// Draws a posture, and with several goals a layer by its weight.
class WorldSampler : public SeededSampler {
 public:
  WorldSampler(const ob::StateSpace* space, std::uint_fast32_t seed)
      : SeededSampler(space, seed), worlds_(*space->as<Worlds>()) {}

  void sampleUniform(ob::State* state) override {
    SeededSampler::sampleUniform(state);
    if (!worlds_.is_layered()) return;
    const std::vector<PathEnds>& ends = worlds_.query().ends;
    double left = rng_.uniformReal(
        0, std::accumulate(ends.begin(), ends.end(), 0.0,
                           [](double sum, const PathEnds& end) { return sum + end.weight; }));
    std::size_t layer = 0;
    while (layer + 1 < ends.size() && left > ends[layer].weight) left -= ends[layer++].weight;
    values_of(state)[worlds_.joints()] = kLayerHeight * static_cast<double>(layer);
  }

 private:
  const Worlds& worlds_;
};

/// Keeps the latest answers: a simplifier asks again and again for the few motions between the
/// points of a short path.
class MotionCheck : public ob::MotionValidator {
 public:
  MotionCheck(const ob::SpaceInformationPtr& si, const Worlds& worlds)
      : ob::MotionValidator(si), worlds_(worlds) {}

  bool checkMotion(const ob::State* a, const ob::State* b) const override {
    const auto size = static_cast<std::size_t>(worlds_.getDimension());
    const double *from = values_of(a), *to = values_of(b);
    const auto is_same = [&](const Answer& known) {
      return known.ends.size() == 2 * size && std::equal(from, from + size, known.ends.begin()) &&
             std::equal(to, to + size, known.ends.begin() + static_cast<std::ptrdiff_t>(size));
    };
    const auto known = std::find_if(answers_.begin(), answers_.end(), is_same);
    if (known != answers_.end()) return known->is_valid;
    Answer& latest = answers_[next_++ % answers_.size()];
    latest.ends.assign(from, from + size);
    latest.ends.insert(latest.ends.end(), to, to + size);
    latest.is_valid = worlds_.is_motion_valid(a, b);
    return latest.is_valid;
  }
  // How far a motion is valid is not known; none of the planners used here asks.
  bool checkMotion(const ob::State* a, const ob::State* b,
                   std::pair<ob::State*, double>& last_valid) const override {
    const bool valid = checkMotion(a, b);
    last_valid.second = valid ? 1.0 : 0.0;
    if (last_valid.first != nullptr) si_->copyState(last_valid.first, valid ? b : a);
    return valid;
  }

 private:
  struct Answer {
    std::vector<double> ends;  ///< both
    bool is_valid = false;
  };
  const Worlds& worlds_;
  mutable std::array<Answer, 128> answers_;
  mutable std::size_t next_ = 0;
};

/// Alternates OMPL's simplification steps until they no longer shorten the path.
void simplify(const ob::SpaceInformationPtr& si, og::PathGeometric& path, std::uint_fast32_t seed,
              const StopCondition& stop, const PathPlannerOptions& options) {
  Seeded<og::PathSimplifier> simplifier(si, seed);
  for (int round = 0; round < options.simplification_rounds && !stop.reached(); ++round) {
    const double before = path.length();
    simplifier.reduceVertices(path);
    simplifier.collapseCloseVertices(path);
    simplifier.shortcutPath(path);
    if (path.length() > options.worthwhile * before && round > 0) break;
  }
  simplifier.reduceVertices(path);
}

using MakePlanner = ob::PlannerPtr (*)(const ob::SpaceInformationPtr&, std::uint_fast32_t seed,
                                       double tree_range);

template <class Planner>
ob::PlannerPtr make_plain(const ob::SpaceInformationPtr& si, std::uint_fast32_t, double) {
  return std::make_shared<Planner>(si);
}

ob::PlannerPtr make_rrt_connect(const ob::SpaceInformationPtr& si, std::uint_fast32_t seed,
                                double tree_range) {
  auto planner = std::make_shared<Seeded<og::RRTConnect>>(si, seed);
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
        worlds_(*space->as<Worlds>()),
        shoulder_(std::min(3u, worlds_.joints())) {
    std::vector<double> sizes(shoulder_, cell_size);
    if (worlds_.is_layered()) sizes.push_back(kLayerHeight / 2);
    setCellSizes(sizes);
  }
  unsigned int getDimension() const override {
    return shoulder_ + (worlds_.is_layered() ? 1u : 0u);
  }
  void project(const ob::State* state, Eigen::Ref<Eigen::VectorXd> out) const override {
    const double* values = values_of(state);
    for (unsigned k = 0; k < shoulder_; ++k) out[k] = values[k];
    if (worlds_.is_layered()) out[shoulder_] = values[worlds_.joints()];
  }

 private:
  const Worlds& worlds_;
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

struct NamedPlanner {
  std::string_view name;
  MakePlanner make;
  bool improves;      ///< goes on after its first solution
  bool hides_random;  ///< generators that cannot be seeded one by one
  bool takes_sets;    ///< takes several starts and goals
};

// PRM* with lazy checks: OMPL's eager one looks for the solution in a second thread, so that what
// it finds depends on the load of the machine. KPIECE in its bidirectional form.
constexpr std::array<NamedPlanner, 6> kPlanners = {
    {{"rrt_connect", make_rrt_connect, false, false, true},
     {"rrt_star", make_rrt_star, true, true, true},
     {"prm_star", make_plain<og::LazyPRMstar>, true, true, false},
     {"bit_star", make_plain<og::BITstar>, true, true, true},
     {"ait_star", make_plain<og::AITstar>, true, true, true},
     {"kpiece", make_kpiece, false, true, true}}};

/// Whether an improving planner reports the cost of a solution.
bool states_cost(const ob::Planner& planner) {
  const auto& properties = planner.getPlannerProgressProperties();
  const auto cost = properties.find("best cost REAL");
  if (cost == properties.end()) return false;
  const std::string text = cost->second();
  return !text.empty() && std::isfinite(std::strtod(text.c_str(), nullptr));
}

PathAnswer plan_with(const NamedPlanner& named, const PathQuery& query) {
  query.check();
  Random seeds(query.seed);
  const auto planner_seed = local_seed(seeds), simplifier_seed = local_seed(seeds);
  std::shared_lock<std::shared_mutex> shared;
  std::unique_lock<std::shared_mutex> alone;
  if (named.hides_random) {
    alone = own_ompl(planner_seed);
  } else {
    shared = share_ompl();
  }
  const auto worlds = std::make_shared<Worlds>(query);
  worlds->setStateSamplerAllocator([&seeds](const ob::StateSpace* space) {
    return std::make_shared<WorldSampler>(space, local_seed(seeds));
  });
  worlds->setLongestValidSegmentFraction(
      std::min(query.resolution / worlds->getMaximumExtent(), 1.0));
  auto si = std::make_shared<ob::SpaceInformation>(worlds);
  si->setStateValidityChecker([&](const ob::State* state) { return worlds->is_valid(state); });
  si->setMotionValidator(std::make_shared<MotionCheck>(si, *worlds));
  si->setup();

  auto definition = std::make_shared<ob::ProblemDefinition>(si);
  worlds->add_ends(si, *definition);
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
  simplify(si, path, simplifier_seed, query.stop, query.options);
  if (query.stop.reached()) {
    answer.outcome = PathOutcome::Stopped;
    return answer;
  }
  answer.outcome = PathOutcome::Found;
  for (const ob::State* state : path.getStates()) {
    answer.points.push_back(posture_of(state, worlds->joints()));
  }
  answer.reached = static_cast<std::size_t>(worlds->world(path.getStates().front()));
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

/// The best goal by itself, as long as that takes little; else any of them.
PathAnswer plan_to_best_or_any(const NamedPlanner& named, const PathQuery& query) {
  PathQuery best = query;
  best.ends.resize(1);
  best.max_iterations = std::min(query.max_iterations, query.options.iterations_to_best);
  PathAnswer answer = plan_with(named, best);
  return answer.outcome == PathOutcome::NotFound ? plan_with(named, query) : answer;
}

}  // namespace

PathPlanner find_path_planner(const std::string& name) {
  const auto* named =
      std::find_if(kPlanners.begin(), kPlanners.end(),
                   [&](const NamedPlanner& planner) { return planner.name == name; });
  if (named == kPlanners.end()) return nullptr;
  return [named](const PathQuery& query) {
    if (query.ends.size() == 1) return plan_with(*named, query);
    return named->takes_sets ? plan_to_best_or_any(*named, query) : plan_in_turn(*named, query);
  };
}

std::vector<std::string> approach_planner_names() {
  std::vector<std::string> names;
  for (const NamedPlanner& planner : kPlanners) names.emplace_back(planner.name);
  return names;
}

}  // namespace stillbase
