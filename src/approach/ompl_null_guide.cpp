// Control-space planning by OMPL: x' = P(x) u.
#include <cmath>
#include <memory>
#include <utility>

#include <ompl/base/ProblemDefinition.h>
#include <ompl/base/spaces/RealVectorStateSpace.h>
#include <ompl/control/DirectedControlSampler.h>
#include <ompl/control/PathControl.h>
#include <ompl/control/SpaceInformation.h>
#include <ompl/control/StatePropagator.h>
#include <ompl/control/planners/rrt/RRT.h>
#include <ompl/control/spaces/RealVectorControlSpace.h>

#include "approach/null_guide.hpp"
#include "approach/ompl_support.hpp"

namespace stillbase {

namespace {

namespace ob = ompl::base;
namespace oc = ompl::control;
using Space = ob::RealVectorStateSpace;
using Controls = oc::RealVectorControlSpace;

Eigen::VectorXd values_of(const double* values, unsigned dimension) {
  return Eigen::Map<const Eigen::VectorXd>(values, dimension);
}

class Propagator : public oc::StatePropagator {
 public:
  Propagator(const oc::SpaceInformationPtr& si, const GuideQuery& query)
      : oc::StatePropagator(si), query_(query), dimension_(si->getStateDimension()) {}

  void propagate(const ob::State* from, const oc::Control* control, double duration,
                 ob::State* to) const override {
    const Eigen::VectorXd x = values_of(from->as<Space::StateType>()->values, dimension_);
    const Eigen::VectorXd u = values_of(control->as<Controls::ControlType>()->values, dimension_);
    const Eigen::VectorXd middle = x + duration / 2 * query_.projected(x, u);
    const Eigen::VectorXd end = x + duration * query_.projected(middle, u);
    double* values = to->as<Space::StateType>()->values;
    for (unsigned k = 0; k < dimension_; ++k) values[k] = end[k];
  }
  bool canPropagateBackward() const override { return true; }

 private:
  const GuideQuery& query_;
  unsigned dimension_;
};

/// Heads for a sample as directly as the null space allows.
class Steering : public oc::DirectedControlSampler {
 public:
  Steering(const oc::SpaceInformation* si, const NullSpaceOptions& options)
      : oc::DirectedControlSampler(si), dimension_(si->getStateDimension()), options_(options) {}

  unsigned sampleTo(oc::Control* control, const ob::State* from, ob::State* to) override {
    const Eigen::VectorXd a = values_of(from->as<Space::StateType>()->values, dimension_);
    const Eigen::VectorXd b = values_of(to->as<Space::StateType>()->values, dimension_);
    const double distance = (b - a).norm();
    if (!(distance > 0)) return 0;
    double* values = control->as<Controls::ControlType>()->values;
    for (unsigned k = 0; k < dimension_; ++k) values[k] = (b[k] - a[k]) / distance;
    const auto steps = static_cast<int>(std::min(std::ceil(distance / options_.guide_step),
                                                 static_cast<double>(options_.guide_edge_steps)));
    return si_->propagateWhileValid(from, control, steps, to);
  }
  unsigned sampleTo(oc::Control* control, const oc::Control*, const ob::State* from,
                    ob::State* to) override {
    return sampleTo(control, from, to);
  }

 private:
  unsigned dimension_;
  const NullSpaceOptions& options_;
};

class SeededRrt : public oc::RRT {
 public:
  SeededRrt(const oc::SpaceInformationPtr& si, std::uint_fast32_t seed, double goal_bias)
      : oc::RRT(si) {
    rng_.setLocalSeed(seed);
    setGoalBias(goal_bias);
  }
};

}  // namespace

std::vector<Eigen::VectorXd> find_guide(const GuideQuery& query) {
  const auto m = static_cast<unsigned>(query.start.size());
  if (!query.start.allFinite() || !query.goal.allFinite() || !query.lower.allFinite() ||
      !query.upper.allFinite() || !(query.lower.array() < query.upper.array()).all()) {
    throw std::invalid_argument("path query with numbers that are not finite or empty bounds");
  }
  Random seeds(query.seed);
  const auto lock = share_ompl();
  auto space = std::make_shared<Space>(m);
  ob::RealVectorBounds bounds(m), speeds(m);
  for (unsigned k = 0; k < m; ++k) {
    bounds.setLow(k, query.lower[k]);
    bounds.setHigh(k, query.upper[k]);
  }
  space->setBounds(bounds);
  space->setStateSamplerAllocator([&seeds](const ob::StateSpace* s) {
    return std::make_shared<SeededSampler>(s, local_seed(seeds));
  });
  auto controls = std::make_shared<Controls>(space, m);
  speeds.setLow(-1);
  speeds.setHigh(1);
  controls->setBounds(speeds);

  auto si = std::make_shared<oc::SpaceInformation>(space, controls);
  si->setStateValidityChecker([&](const ob::State* state) {
    return si->satisfiesBounds(state) &&
           query.is_valid(values_of(state->as<Space::StateType>()->values, m));
  });
  si->setStatePropagator(std::make_shared<Propagator>(si, query));
  si->setDirectedControlSamplerAllocator(
      [&](const oc::SpaceInformation* s) { return std::make_shared<Steering>(s, query.options); });
  si->setPropagationStepSize(query.options.guide_step);
  si->setMinMaxControlDuration(1, static_cast<unsigned>(query.options.guide_edge_steps));
  si->setup();

  ob::ScopedState<Space> start(space), goal(space);
  for (unsigned k = 0; k < m; ++k) {
    start[k] = query.start[k];
    goal[k] = query.goal[k];
  }
  auto definition = std::make_shared<ob::ProblemDefinition>(si);
  definition->setStartAndGoalStates(start, goal, query.options.guide_ends);
  SeededRrt planner(si, local_seed(seeds), query.options.guide_goal_bias);
  planner.setProblemDefinition(definition);
  planner.setup();
  int asked = 0;
  const ob::PlannerTerminationCondition finished(
      [&] { return ++asked > query.max_iterations || query.stop.reached(); });
  std::vector<Eigen::VectorXd> postures;
  if (planner.solve(finished) != ob::PlannerStatus::EXACT_SOLUTION) return postures;
  const auto& path = *definition->getSolutionPath()->as<oc::PathControl>();
  for (std::size_t i = 0; i < path.getStateCount(); ++i) {
    postures.push_back(
        values_of(path.getState(static_cast<unsigned>(i))->as<Space::StateType>()->values, m));
  }
  return postures;
}

}  // namespace stillbase
