#include "approach/pace.hpp"

#include "approach/effort.hpp"
#include "approach/task.hpp"

namespace stillbase {

namespace {

/// Duration with multiples of the limits, without regard to torques.
double duration_with(const ApproachTask& task, double rate, double acceleration) {
  ApproachTask other = task;
  other.limits.rate *= rate;
  other.limits.acceleration *= acceleration;
  return straight_path(other).times.back();
}

}  // namespace

Pace pace_of_straight_motion(const CaptureProblem& problem, const Configuration& goal,
                             double wanted, const ApproachOptions& options) {
  CaptureProblem free_station = problem;  // one that is stated decides where the base ends, alone
  free_station.approach.station_free = true;
  const ApproachTask task = make_task(free_station, goal, nullptr, {}, options);
  JointPath path = straight_path(task);
  Pace pace;
  const double within_limits = path.times.back();
  slow_for_effort(free_station, path, options.effort);
  pace.duration = path.times.back();

  const bool are_torques = pace.duration > within_limits * (1 + 1e-9);
  const bool are_rates = duration_with(task, 2, 1) <= duration_with(task, 1, 2);
  pace.limit = are_torques ? PaceLimit::Torque
               : are_rates ? PaceLimit::Rate
                           : PaceLimit::Acceleration;
  const JointVectord travel = (goal.phi - task.start).cwiseAbs();
  Eigen::Index slowest = 0;
  travel.cwiseQuotient(are_rates ? task.limits.rate : task.limits.acceleration).maxCoeff(&slowest);
  pace.joint = problem.robot.joints[static_cast<std::size_t>(slowest)].name;
  if (are_torques || !(wanted > 0)) return pace;

  constexpr double kStep = 1.05, kMost = 1e4;
  const auto duration_at = [&](double factor) {
    return are_rates ? duration_with(task, factor, 1) : duration_with(task, 1, factor);
  };
  double factor = 1;
  while (factor <= kMost && duration_at(factor) > wanted) factor *= kStep;
  if (factor <= kMost) pace.factor = factor;
  return pace;
}

}  // namespace stillbase
