// Control-space planning by OMPL: x' = P(x) u.
#include <cmath>
#include <memory>
#include <utility>

#include <ompl/base/ProblemDefinition.h>
#include <ompl/control/DirectedControlSampler.h>
#include <ompl/control/PathControl.h>
#include <ompl/control/SpaceInformation.h>
#include <ompl/control/StatePropagator.h>
#include <ompl/control/planners/rrt/RRT.h>
#include <ompl/control/spaces/RealVectorControlSpace.h>

#include "approach/ompl_support.hpp"

namespace stillbase {

namespace {

namespace ob = ompl::base;
namespace oc = ompl::control;
using Controls = oc::RealVectorControlSpace;
using Projected = std::function<JointVectord(const JointVectord&, const JointVectord&)>;

class Propagator : public oc::StatePropagator {
 public:
  Propagator(const oc::SpaceInformationPtr& si, const Projected& projected)
      : oc::StatePropagator(si), projected_(projected), joints_(si->getStateDimension()) {}

  void propagate(const ob::State* from, const oc::Control* control, double duration,
                 ob::State* to) const override {
    const JointVectord x = posture_of(from, joints_);
    const JointVectord u =
        Eigen::Map<const Eigen::VectorXd>(control->as<Controls::ControlType>()->values, joints_);
    const JointVectord middle = x + duration / 2 * projected_(x, u);
    const JointVectord end = x + duration * projected_(middle, u);
    std::copy(end.begin(), end.end(), values_of(to));
  }
  bool canPropagateBackward() const override { return true; }

 private:
  const Projected& projected_;
  unsigned joints_;
};

/// Heads for a sample as directly as the null space allows.
class Steering : public oc::DirectedControlSampler {
 public:
  Steering(const oc::SpaceInformation* si, const NullSpaceOptions& options)
      : oc::DirectedControlSampler(si), joints_(si->getStateDimension()), options_(options) {}

  unsigned sampleTo(oc::Control* control, const ob::State* from, ob::State* to) override {
    const JointVectord a = posture_of(from, joints_), b = posture_of(to, joints_);
    const double distance = (b - a).norm();
    if (!(distance > 0)) return 0;
    double* values = control->as<Controls::ControlType>()->values;
    for (unsigned k = 0; k < joints_; ++k) values[k] = (b[k] - a[k]) / distance;
    const auto steps = static_cast<int>(std::min(std::ceil(distance / options_.guide_step),
                                                 static_cast<double>(options_.guide_edge_steps)));
    return si_->propagateWhileValid(from, control, steps, to);
  }
  unsigned sampleTo(oc::Control* control, const oc::Control*, const ob::State* from,
                    ob::State* to) override {
    return sampleTo(control, from, to);
  }

 private:
  unsigned joints_;
  const NullSpaceOptions& options_;
};

}  // namespace

std::vector<JointVectord> find_guide(const PathQuery& query, const NullSpaceOptions& options,
                                     const Projected& projected) {
  query.check();
  const auto m = static_cast<unsigned>(query.lower.size());
  Random seeds(query.seed);
  const auto lock = share_ompl();
  auto space = std::make_shared<ob::RealVectorStateSpace>(m);
  space->setBounds(bounds_of(query, m));
  space->setStateSamplerAllocator([&seeds](const ob::StateSpace* s) {
    return std::make_shared<SeededSampler>(s, local_seed(seeds));
  });
  auto controls = std::make_shared<Controls>(space, m);
  ob::RealVectorBounds speeds(m);
  speeds.setLow(-1);
  speeds.setHigh(1);
  controls->setBounds(speeds);

  auto si = std::make_shared<oc::SpaceInformation>(space, controls);
  si->setStateValidityChecker([&](const ob::State* state) {
    return si->satisfiesBounds(state) && query.is_valid(0, posture_of(state, m));
  });
  si->setStatePropagator(std::make_shared<Propagator>(si, projected));
  si->setDirectedControlSamplerAllocator(
      [&](const oc::SpaceInformation* s) { return std::make_shared<Steering>(s, options); });
  si->setPropagationStepSize(options.guide_step);
  si->setMinMaxControlDuration(1, static_cast<unsigned>(options.guide_edge_steps));
  si->setup();

  ob::ScopedState<> start(si), goal(si);
  for (unsigned k = 0; k < m; ++k) {
    start[k] = query.ends.front().start[k];
    goal[k] = query.ends.front().goal[k];
  }
  auto definition = std::make_shared<ob::ProblemDefinition>(si);
  definition->setStartAndGoalStates(start, goal, options.guide_ends);
  Seeded<oc::RRT> planner(si, local_seed(seeds));
  planner.setGoalBias(options.guide_goal_bias);
  planner.setProblemDefinition(definition);
  planner.setup();
  int asked = 0;
  const ob::PlannerTerminationCondition finished(
      [&] { return ++asked > query.max_iterations || query.stop.reached(); });
  std::vector<JointVectord> postures;
  if (planner.solve(finished) != ob::PlannerStatus::EXACT_SOLUTION) return postures;
  const auto& path = *definition->getSolutionPath()->as<oc::PathControl>();
  for (unsigned i = 0; i < path.getStateCount(); ++i) {
    postures.push_back(posture_of(path.getState(i), m));
  }
  return postures;
}

}  // namespace stillbase
