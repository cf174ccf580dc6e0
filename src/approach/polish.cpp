#include "approach/polish.hpp"

#include <algorithm>

#include <stillbase/core/rotation.hpp>
#include <stillbase/nlp/optimizer.hpp>

#include "approach/polish_problem.hpp"
#include "approach/time_law.hpp"

namespace stillbase {

namespace {

double measure(const ApproachTask& task, const TimedMotion& motion) {
  if (task.problem.approach.polish == PathPolish::Time) {
    return motion.path.times.back() - motion.path.times.front();
  }
  double excursion = 0;
  for (const Pose& pose : motion.base_poses) {
    excursion = std::max(
        excursion,
        rotation_log(motion.base_poses.back().orientation.conjugate() * pose.orientation).norm());
  }
  return excursion;
}

/// A shape with its own time law as fast as the limits allow, and with a new one.
std::vector<JointPath> timed(const ApproachTask& task, JointPath own) {
  const JointVectord& hardest = task.problem.approach.acceleration_limit;
  std::vector<JointPath> paths;
  const JointPath curve = over_length(own);
  if (curve.segments() > 0)
    paths.push_back(time_curve(curve, task.max_rate, hardest, task.options.time_law));
  stretch(own, stretch_for_limits(own, task.max_rate, hardest) * (1 + 1e-9));
  paths.push_back(std::move(own));
  return paths;
}

}  // namespace

void polish(const ApproachTask& task, double wait, const StopCondition& stop,
            AttemptResult& found) {
  if (task.problem.approach.polish == PathPolish::None || task.free.empty()) return;
  found.before_polish = found.after_polish = measure(task, found.motion);
  if (!(found.motion.path.times.back() > found.motion.path.times.front())) return;
  const AttemptResult planned = found;
  const PolishProblem problem(task, planned, wait);
  nlp::OptimizeOptions options;
  options.max_evaluations = task.options.polish.evaluations;
  options.stop = stop;
  options.feasibility_tolerance = 1e-4;  // parts of limits; what comes out is judged anew
  options.explain_infeasibility = false;
  const Eigen::VectorXd begin = problem.start();
  const Eigen::VectorXd end =
      nlp::make_optimizer("ipopt-lbfgs")->minimize(problem, begin, options).x;
  for (const double part : {1.0, 0.8, 0.6, 0.4, 0.2}) {
    for (JointPath& path : timed(task, problem.motion(begin + part * (end - begin)))) {
      AttemptResult trial = planned;
      finish_motion(task, std::move(path), wait, trial);
      if (trial.status != ApproachStatus::Found) continue;
      trial.after_polish = measure(task, trial.motion);
      if (trial.after_polish < found.after_polish * (1 - task.options.polish.worthwhile))
        found = std::move(trial);
    }
  }
}

}  // namespace stillbase
