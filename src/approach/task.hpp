// The task of an approach in the form that planning works on.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <stillbase/approach/approach.hpp>
#include <stillbase/collision/scene.hpp>

#include "approach/joint_path.hpp"
#include "approach/path_planner.hpp"

namespace stillbase {

/// The task after its input was checked.
struct ApproachTask {
  const CaptureProblem& problem;
  Configuration goal;
  const TargetMotion* target;
  CollisionScene scene;
  PathPlanner planner;
  JointVectord start;              ///< n; continuous joints whole turns away from problem.start
  MotionLimits limits;             ///< scaled
  std::vector<Eigen::Index> free;  ///< joints that may move
  double earliest_start;           ///< s; -infinity when nothing is predicted
  const ContactSolver& contact;
  ApproachOptions options;

  bool has_stated_start() const {
    return problem.approach.base == BaseMode::Floating && !problem.approach.station_free;
  }
};

/// @throws std::invalid_argument see plan_approach
ApproachTask make_task(const CaptureProblem& problem, const Configuration& goal,
                       const TargetMotion* target, const ContactSolver& contact,
                       const ApproachOptions& options = {});

/// The first joint that a posture (n) puts further outside its limits than `slack`; null: none.
const Joint* joint_outside_limits(const RobotModel& robot, const JointVectord& phi, double slack);

/// Bounds of the free joints (m) for the planner: joint limits, and a full turn around start and
/// goal where there are none.
void set_bounds(const ApproachTask& task, JointVectord& lower, JointVectord& upper);

/// The straight line to the goal with its time law, from time 0.
JointPath straight_path(const ApproachTask& task);

/// The delay of a motion of this duration and the wait, if there is one.
struct Lateness {
  double seconds = 0;
  std::string text;
};
std::optional<Lateness> too_slow(const ApproachTask& task, double contact_time, double duration,
                                 double wait);

/// Name under which the planner's runs are counted.
std::string planner_name(const CaptureProblem& problem);

}  // namespace stillbase
