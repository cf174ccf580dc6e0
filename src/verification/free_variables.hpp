// The variables of a small problem: free joints, angle of the base about its axis, contact time.
#pragma once

#include <vector>

#include "verification/recomputation.hpp"

namespace stillbase::verification {

class FreeVariables {
 public:
  /// @pre the base attitude is fixed or free about one axis
  explicit FreeVariables(const CaptureProblem& problem);

  int size() const { return static_cast<int>(lower.size()); }
  /// Base position as stated.
  Configuration at(const Eigen::VectorXd& x) const;
  Eigen::VectorXd middle_of(const JointBox& box) const;
  /// Whether a configuration lies in a box or right beside it.
  bool holds(const JointBox& box, const Configuration& at) const;
  /// Largest difference of two points, whole turns apart.
  double distance(const Eigen::VectorXd& a, const Eigen::VectorXd& b) const;
  /// Angles of a full turn brought to [-pi, pi]. @return whether x is within the bounds then
  bool bring_inside(Eigen::VectorXd& x) const;

  Eigen::VectorXd lower, upper;  ///< of x; of a full turn -pi and pi

 private:
  double base_angle(const Configuration& at) const;

  const CaptureProblem& problem_;
  std::vector<int> joints_;
  std::vector<bool> turns_;  ///< angles of a full turn
  bool has_angle_ = false, has_time_ = false;
  double time_unit_ = 1;  ///< s per unit of x
};

}  // namespace stillbase::verification
