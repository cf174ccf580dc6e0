#include "approach/replanning.hpp"

#include <algorithm>

namespace stillbase {

namespace {

/// Poses of the target while an earlier attempt moved.
std::vector<Pose> swept_poses(const AttemptResult& attempt, int count) {
  std::vector<Pose> poses;
  for (int i = 0; i < count; ++i) {
    const double t =
        attempt.motion_end + (attempt.motion_start - attempt.motion_end) * i / (count - 1);
    poses.push_back(attempt.target->state(t).pose);
  }
  return poses;
}

/// The target as a still obstacle where it will be at the arrival.
std::vector<Pose> arrival_pose(const ApproachTask& task, double wait) {
  if (task.target == nullptr) return {};
  return {task.target->state(task.goal.contact_time - wait).pose};
}

}  // namespace

AttemptOptions first_options(const ApproachTask& task) {
  AttemptOptions options;
  options.resolution = task.problem.approach.resolution;
  options.max_iterations = task.problem.approach.max_iterations;
  options.wait = task.problem.approach.wait;
  options.targets = arrival_pose(task, options.wait);
  return options;
}

bool explains_more(const AttemptResult& result, const AttemptResult& known) {
  if (known.detail.empty()) return true;
  if (result.status == ApproachStatus::TooSlow) {
    return known.status == ApproachStatus::TooSlow && result.shortfall < known.shortfall;
  }
  return result.way_points > 0;
}

void adjust_options(const ApproachTask& task, const AttemptResult& result, int attempt,
                    AttemptOptions& options) {
  options.max_iterations = task.problem.approach.max_iterations;
  if (attempt + 1 ==
      task.options.attempts) {  // last resort: nothing still to avoid, judged in time alone
    options.wait = task.problem.approach.wait;
    options.targets.clear();
  } else if (result.hit_by_target) {
    options.targets = swept_poses(result, task.options.swept_poses);
    // More cautious than need be, and often without a solution: not worth the full effort.
    options.max_iterations = std::max(1, options.max_iterations / task.options.swept_effort);
    if (attempt % 3 == 0) options.wait += (result.motion_end - result.motion_start) / 2;
  } else if (result.way_points == 0) {
    options.targets = arrival_pose(task, options.wait);
  } else if (result.status == ApproachStatus::TooSlow) {
    options.wait = task.problem.approach.wait;
  } else {
    options.resolution /= 2;
  }
}

}  // namespace stillbase
