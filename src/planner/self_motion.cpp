#include "planner/self_motion.hpp"

#include <algorithm>
#include <cmath>

#include <stillbase/core/constants.hpp>
#include <stillbase/core/random.hpp>
#include <stillbase/formulation/measures/robust.hpp>

#include "formulation/measures/measure.hpp"
#include "formulation/projection.hpp"

namespace stillbase {

namespace {

/// Walks in about one direction as far as the problem allows.
Eigen::VectorXd walk(const CaptureProblem& problem, const Formulation& formulation,
                     const Eigen::VectorXd& from, const Candidate& best, double factor,
                     const SelfMotionOptions& options, Random& random) {
  Eigen::VectorXd y, x = from;
  Eigen::MatrixXd slope;
  formulation.objective_vector(from, y, slope);
  const bool keep_zero = problem.measure.kind == RiskMeasure::Nominal && y.norm() <= kZeroObjective;
  Measure measure(problem, formulation);
  const auto allowed = [&](const Eigen::VectorXd& at) {
    Candidate candidate;
    candidate.configuration = formulation.configuration(at);
    candidate.value = measure.reported(at);
    if (measure.is_nominal()) {
      candidate.worst_case = worst_case(problem, formulation, candidate.configuration).value;
    }
    return is_good(problem, candidate, best, factor);
  };
  Eigen::VectorXd direction(x.size());
  for (Eigen::Index i = 0; i < direction.size(); ++i) direction[i] = random.normal();
  const int steps = 1 + random.index(options.max_steps);
  for (int step = 0; step < steps; ++step) {
    const Eigen::MatrixXd open = open_directions(formulation, x, keep_zero);
    if (open.cols() == 0) break;
    direction = open * (open.transpose() * direction);
    if (!(direction.norm() > 0)) break;
    direction.normalize();
    bool moved = false;
    double stride = options.stride;
    for (int trial = 0; trial <= options.halvings && !moved; ++trial, stride /= 2) {
      const ProjectionResult there = project_onto_constraints(formulation, x + stride * direction,
                                                              keep_zero, options.projection_steps);
      moved = there.violation <= kFeasibilityTolerance && allowed(there.x);
      if (moved) x = there.x;
    }
    if (!moved) break;
  }
  return x;
}

}  // namespace

double rank_of(const CaptureProblem& problem, const Candidate& candidate) {
  return problem.measure.kind == RiskMeasure::Nominal ? candidate.worst_case : candidate.value;
}

bool is_good(const CaptureProblem& problem, const Candidate& candidate, const Candidate& best,
             double factor) {
  const auto within = [&](double value, double least) {
    return value <= factor * least + kZeroRank;
  };
  return within(candidate.value, best.value) &&
         within(rank_of(problem, candidate), rank_of(problem, best));
}

std::vector<Eigen::VectorXd> self_motion_samples(const CaptureProblem& problem,
                                                 const Formulation& formulation,
                                                 const std::vector<Eigen::VectorXd>& from,
                                                 const Candidate& best, double factor, int count,
                                                 const StopCondition& stop,
                                                 const SelfMotionOptions& options) {
  std::vector<Eigen::VectorXd> samples;
  if (from.empty() || formulation.freedom() == 0) return samples;
  Random random(problem.search.seed);
  const auto joints = static_cast<Eigen::Index>(
      std::count(problem.variables.joints.begin(), problem.variables.joints.end(), true));
  const auto is_near = [&](const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
    return (a - b).head(joints).norm() < options.separation;
  };
  for (int i = 0; i < count && !stop.reached(); ++i) {
    const Eigen::VectorXd& begin = from[static_cast<std::size_t>(i) % from.size()];
    const Eigen::VectorXd x = walk(problem, formulation, begin, best, factor, options, random);
    const auto same = [&](const Eigen::VectorXd& other) { return is_near(x, other); };
    if (std::any_of(from.begin(), from.end(), same)) continue;
    if (std::any_of(samples.begin(), samples.end(), same)) continue;
    samples.push_back(x);
  }
  return samples;
}

}  // namespace stillbase
