// Following a reference curve within the angular reaction null space.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include <stillbase/approach/options.hpp>
#include <stillbase/core/interrupt.hpp>
#include <stillbase/plan/plan.hpp>

#include "approach/joint_path.hpp"

namespace stillbase {

/// Rows: free joints; columns: knots at equal distances of the parameter s in [0, 1]. Between them
/// a cubic through the knots (Catmull and Rom's slopes).
using Knots = Eigen::MatrixXd;

class NullTracker {
 public:
  /// @param start n; the first column of all knots is its free part
  /// @param jobs threads
  /// @param stop reached: no curve gets to a goal any more
  NullTracker(const RobotModel& robot, const JointVectord& start, std::vector<Eigen::Index> free,
              const NullSpaceOptions& options = {}, int jobs = 1, StopCondition stop = {});

  /// The velocity of the free joints (m) in the reaction null space that is nearest to `wanted`.
  JointVectord projected(const JointVectord& phi, const JointVectord& wanted) const;

  /// The curve that follows the knots, with `steps` Runge-Kutta steps between two knots: `times`
  /// are values of s, `phidot` the slopes.
  JointPath follow(const Knots& knots, int steps) const;

  /// The goal near a posture (n), moving smoothly with it; nothing when there is none.
  using GoalNear = std::function<std::optional<Configuration>(const JointVectord&)>;

  /// Shifts the knots until the curve ends at a goal; its last posture is then that of the goal.
  /// Nothing: it does not get there.
  std::optional<Configuration> reach(const GoalNear& goal, Knots& knots, JointPath& curve) const;

  /// Knots shifted so that the end of the curve moves by about `stride` (rad), as the null space
  /// allows, in the direction `push` (m).
  Knots bent(const Knots& knots, const Eigen::VectorXd& push, double stride) const;

  Eigen::VectorXd free_part(const JointVectord& phi) const { return phi(free_); }

 private:
  class Beside;

  /// The same for any rank of the coupling matrix.
  JointVectord projected_by_rank(const JointVectord& phi, const JointVectord& wanted) const;
  /// Slope of the curve at s.
  JointVectord slope(const Knots& knots, double s, const JointVectord& phi) const;
  JointVectord step(const Knots& knots, double s, double h, const JointVectord& phi,
                    const JointVectord& slope_here) const;
  /// d(end) / d(knots after the first, column by column), by differences; zero when stopped.
  Eigen::MatrixXd end_jacobian(const Knots& knots) const;

  Knots shifted_knots(const Knots& knots, const Eigen::VectorXd& shift) const;
  Eigen::MatrixXd directions_asked(const GoalNear& goal, const JointVectord& end) const;

  const RobotModel& robot_;
  JointVectord start_;
  std::vector<Eigen::Index> free_;
  NullSpaceOptions options_;
  int jobs_;
  StopCondition stop_;
  Eigen::VectorXd lower_, upper_;  ///< of knots (m)
};

}  // namespace stillbase
