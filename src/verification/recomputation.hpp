// What the plan should say about the impact, from the problem and a configuration, by `reference`.
#pragma once

#include <optional>
#include <string>

#include <stillbase/plan/plan.hpp>
#include <stillbase/reference/reference.hpp>

namespace stillbase::verification {

/// The chosen contact feature of the problem, if it has one.
std::optional<ContactFeature> chosen_feature(const CaptureProblem& problem);

/// The contact as the problem and the motion of the target fix it, at one configuration.
struct ContactEvent {
  std::string missing;                   ///< why the direction is not known; empty: it is
  std::optional<ContactState> feature;   ///< of the chosen feature at the contact time, in N
  Vector3d n = Vector3d::Zero();         ///< direction of the impulse on the hand, unit, in B
  Vector3d moment = Vector3d::Zero();    ///< given moment impulse in B, N m s
  std::optional<Vector3d> velocity;      ///< of the target's contact point in B, m/s
  Vector3d r = Vector3d::Zero();         ///< contact point from the target's centroid, in B, m
  Matrix3d target_inertia = Matrix3d::Zero();  ///< in B, kg m^2
};

/// @param motion null: the problem has no target
ContactEvent contact_event(const CaptureProblem& problem, const TargetMotion* motion,
                           const Configuration& configuration);

/// How fast target and hand close along d (robot at rest), m/s; empty when nothing says so.
///
/// With a contact feature the velocity of its point decides; a point mass from a stated direction
/// comes along whichever direction it comes from with the stated closing speed.
std::optional<double> closing_speed(const CaptureProblem& problem, const ContactEvent& event,
                                    const Vector3d& d);

/// Everything linear in the impulse at one posture.
struct PostureResponse {
  reference::Dynamics dynamics;          ///< at rest
  Eigen::VectorXd added_inertia;         ///< n
  std::vector<bool> locked;              ///< n or empty
  Matrix3d W = Matrix3d::Zero();         ///< hand velocity per force impulse, 1/kg
  Eigen::Matrix<double, 3, 6> B;         ///< Delta omega = B Fbar
  Vector3d r_gh = Vector3d::Zero();      ///< system centroid to hand, in B, m

  reference::Impact impact(const Vector6d& Fbar) const {
    return reference::impact(dynamics, added_inertia, locked, Fbar);
  }
  /// |f| |r_gh| + |t|: what angular momenta are measured against.
  double momentum_scale(const Vector6d& Fbar) const {
    return Fbar.head<3>().norm() * r_gh.norm() + Fbar.tail<3>().norm();
  }
};
PostureResponse posture_response(const CaptureProblem& problem, const Eigen::VectorXd& phi);

/// The impulse [f; t] at the hand along d, by the problem's contact law, in B. Zero when hand and
/// target separate.
/// @throws std::logic_error when the problem does not say how fast they close
Vector6d impulse_along(const CaptureProblem& problem, const ContactEvent& event,
                       const PostureResponse& response, const Vector3d& d);

/// The problem's objective for an impulse, and the size that it is measured against.
double objective_value(ObjectiveQuantity quantity, const PostureResponse& response,
                       const Vector6d& Fbar);
double objective_scale(ObjectiveQuantity quantity, const PostureResponse& response,
                       const Vector6d& Fbar);

/// Orthonormal projector onto the null space of A (3 x n) and its rank.
struct NullSpace {
  Eigen::MatrixXd projector;
  int rank = 0;
};
NullSpace null_space(const Eigen::MatrixXd& A, double relative_tolerance);

}  // namespace stillbase::verification
