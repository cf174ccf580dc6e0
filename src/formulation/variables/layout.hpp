// Which entries of the variable vector mean what.
#pragma once

#include <vector>

#include <stillbase/core/rotation.hpp>
#include <stillbase/plan/plan.hpp>

namespace stillbase {

struct VariableLayout {
  std::vector<int> joints;  ///< free joints, in order; entry i of x is phi[joints[i]]
  int attitude = -1;        ///< first attitude variable, or -1
  int attitude_size = 0;    ///< 0, 1 (angle about the axis) or 3 (rotation vector)
  int time = -1;            ///< contact time, or -1
  int size = 0;             ///< N
  /// N. Infinite of continuous joints and of those with whole turns: a search takes every angle,
  /// and the copy nearest to the middle of the limits afterwards.
  Eigen::VectorXd lower, upper;
  Eigen::VectorXd lower_limit, upper_limit;  ///< N, the same with the limits of all joints

  explicit VariableLayout(const CaptureProblem& problem);

  JointVectord joint_positions(const CaptureProblem& problem, const Eigen::VectorXd& x) const;
  Eigen::Quaterniond attitude_of(const CaptureProblem& problem, const Eigen::VectorXd& x) const;
  double contact_time(const CaptureProblem& problem, const Eigen::VectorXd& x) const;

  /// The variables of a configuration.
  Eigen::VectorXd variables(const CaptureProblem& problem,
                            const Configuration& configuration) const;
  /// A start point for u in [0,1)^N: joints within their limits (2 pi for those of every angle),
  /// attitudes uniform over rotations, times uniform.
  Eigen::VectorXd start_point(const CaptureProblem& problem, const Eigen::VectorXd& u) const;
  /// Distance on the configuration manifold: angles wrapped, rotations by their angle.
  double distance(const CaptureProblem& problem, const Eigen::VectorXd& a,
                  const Eigen::VectorXd& b) const;
  /// Whether the distance is at most that.
  bool are_within(const CaptureProblem& problem, const Eigen::VectorXd& a, const Eigen::VectorXd& b,
                  double most) const;
  /// a - b, angles that are whole turns apart being equal: within [-pi, pi].
  Eigen::VectorXd difference(const Eigen::VectorXd& a, const Eigen::VectorXd& b) const;
  /// Continuous angles wrapped to (-pi, pi], those of joints with whole turns brought next to the
  /// middle of their limits.
  Eigen::VectorXd normalised(const CaptureProblem& problem, Eigen::VectorXd x) const;
  /// The same posture with the joints that have whole turns within their limits, moved only where
  /// they are beyond them.
  Eigen::VectorXd within_limits(const CaptureProblem& problem, Eigen::VectorXd x) const;

 private:
  enum class Angle { Limited, Continuous, WholeTurns };
  std::vector<Angle> angles_;  ///< one per free joint
};

}  // namespace stillbase
