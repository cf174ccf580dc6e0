// The equations of a capture problem over its free variables, by `reference`: for searches apart
// from the planner's.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "verification/recomputation.hpp"

namespace stillbase::audit {

/// Whether angles of joint k that are whole turns apart are one posture, all of them allowed but
/// for their number: a continuous joint, or a free revolute one whose limits leave room for a turn.
bool reaches_every_angle(const CaptureProblem& problem, int k);

/// The variables of a small problem: free joints, rotation of the base (angle about its axis, or a
/// rotation vector), contact time.
class FreeVariables {
 public:
  explicit FreeVariables(const CaptureProblem& problem);

  int size() const { return static_cast<int>(lower.size()); }
  /// A point of the variables' range from numbers in [0, 1), attitudes evenly.
  Eigen::VectorXd sample(const Eigen::VectorXd& u) const;
  /// Base position as stated.
  Configuration at(const Eigen::VectorXd& x) const;
  /// Of one unit of each entry of x: rad or m, s for the time.
  Eigen::VectorXd units() const;
  /// First of the three entries of a rotation vector in N; -1: none.
  int rotation_vector() const { return vector_; }
  /// The variables of a configuration.
  Eigen::VectorXd of(const Configuration& at) const;
  /// Of boxes, @pre the base attitude is fixed or free about one axis.
  Eigen::VectorXd middle_of(const JointBox& box) const;
  /// Whether a configuration lies in a box, to the tolerance of the constraints; likewise.
  bool holds(const JointBox& box, const Configuration& at) const;
  /// Largest difference of two points, modulo full rotations.
  double distance(const Eigen::VectorXd& a, const Eigen::VectorXd& b) const;
  /// Wraps angles of a full rotation to at most pi from the middle of their bounds, and rotation
  /// vectors to at most pi. @return whether x is
  /// within the bounds then, an axis of the base within its cone
  bool bring_inside(Eigen::VectorXd& x) const;

  Eigen::VectorXd lower, upper;  ///< of x; of a full rotation pi from its middle

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

/// Hand's offset from its point (3, m) and sines of the rotation of its axes (3), in B; zero where
/// the problem demands nothing.
Vector6d hand_rows(const CaptureProblem& problem, const verification::ContactEvent& event,
                   const Configuration& at, const reference::Dynamics& dynamics);

/// Largest of |hand_rows()|.
double hand_residual(const verification::Situation& situation);

/// Number of singular values above a threshold: equations that are independent at a point.
int rank_of(const Eigen::MatrixXd& jacobian);

/// Residuals over the variables, relative to the size of the momenta and to 1 m.
class Equations {
 public:
  enum class Demand {
    Hand,         ///< the hand at its contact
    HandAndCase,  ///< and the momenta of the problem's case zero
    Zero          ///< and the momentum that vanishes with the objective zero
  };
  /// @param problem,variables must outlive this object
  Equations(const CaptureProblem& problem, const FreeVariables& variables, Demand demand);

  Eigen::VectorXd residual(const Eigen::VectorXd& x) const;
  /// By central differences.
  Eigen::MatrixXd jacobian(const Eigen::VectorXd& x) const;
  /// Gauss-Newton with halved steps; empty: it does not converge.
  std::optional<Eigen::VectorXd> solve(Eigen::VectorXd x) const;

  /// Closing speed, bounds of the base position, side from which the hand approaches: each with a
  /// margin of rounding.
  bool keeps_inequalities(const Configuration& at) const;
  /// Whether a configuration belongs to the solution in a box: it is in the box, or Gauss-Newton
  /// from it ends there nearby. A nearly double solution is known less exactly than its residual.
  bool leads_to(const JointBox& box, const Configuration& at) const;
  /// The limits on rates, singular values and clearances, likewise.
  bool keeps_margins(Configuration at) const;

 private:
  verification::ContactEvent event_at(const Configuration& at) const;

  const CaptureProblem& problem_;
  const FreeVariables& variables_;
  std::array<bool, 3> vanishes_{};      ///< total, base, coupling
  std::optional<TargetMotion> motion_;  ///< of a predicted target
};

}  // namespace stillbase::audit
