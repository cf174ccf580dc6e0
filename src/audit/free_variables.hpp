// The variables of a small problem: free joints, rotation of the base (angle about its axis, or a
// rotation vector), contact time.
#pragma once

#include <vector>

#include "verification/recomputation.hpp"

namespace stillbase::audit {

using namespace verification;

class FreeVariables {
 public:
  explicit FreeVariables(const CaptureProblem& problem);

  int size() const { return static_cast<int>(lower.size()); }
  /// A point of the variables' range from numbers in [0, 1), attitudes evenly.
  Eigen::VectorXd sample(const Eigen::VectorXd& u) const;
  /// Base position as stated.
  Configuration at(const Eigen::VectorXd& x) const;
  /// The variables of a configuration.
  Eigen::VectorXd of(const Configuration& at) const;
  /// Of boxes, @pre the base attitude is fixed or free about one axis.
  Eigen::VectorXd middle_of(const JointBox& box) const;
  /// Whether a configuration lies in a box, to the tolerance of the constraints; likewise.
  bool holds(const JointBox& box, const Configuration& at) const;
  /// Largest difference of two points, modulo full rotations.
  double distance(const Eigen::VectorXd& a, const Eigen::VectorXd& b) const;
  /// Wraps angles of a full rotation and rotation vectors to at most pi. @return whether x is
  /// within the bounds then, an axis of the base within its cone
  bool bring_inside(Eigen::VectorXd& x) const;

  Eigen::VectorXd lower, upper;  ///< of x; of a full rotation -pi and pi

 private:
  double base_angle(const Configuration& at) const;
  bool is_attitude_allowed(const Vector3d& rotation) const;

  const CaptureProblem& problem_;
  std::vector<int> joints_;
  std::vector<bool> wraps_;  ///< angles of a full rotation
  bool has_angle_ = false, has_time_ = false;
  int vector_ = -1;       ///< first of three: rotation vector in N from the stated attitude, rad
  double time_unit_ = 1;  ///< s per unit of x
};

}  // namespace stillbase::audit
