// What the plan should say about the impact, from the problem and a configuration, by `reference`.
#pragma once

#include <optional>
#include <string>

#include <stillbase/plan/plan.hpp>
#include <stillbase/plan/scenario.hpp>
#include <stillbase/reference/reference.hpp>

namespace stillbase::verification {

/// The problem with the contact feature that a configuration meets.
CaptureProblem problem_at(const CaptureProblem& problem, const Configuration& at);

/// The chosen contact feature of the problem, if it has one.
std::optional<ContactFeature> feature_of(const CaptureProblem& problem);

/// Motion of the target from `first_time` (s) on, which may be far before the contact: the
/// predicted one, or, when the impulse direction is stated, that of a target that comes along it
/// and meets the hand (the encounter of plan/encounter.hpp, written apart). Empty without a target.
/// @throws std::invalid_argument when it cannot be predicted over that time
std::optional<TargetMotion> target_motion(const CaptureProblem& problem,
                                          const Configuration& configuration,
                                          const Vector3d& hand_N, double first_time);

/// The contact as the problem and the motion of the target fix it, at one configuration.
struct ContactEvent {
  std::string missing;                  ///< why it is not known; empty: it is
  std::optional<ContactState> feature;  ///< where the predicted target is hit, in N
  Eigen::Quaterniond R_NT = Eigen::Quaterniond::Identity();  ///< with `feature`
  Vector3d n = Vector3d::Zero();               ///< direction of the impulse on the hand, unit, in B
  Vector3d moment = Vector3d::Zero();          ///< given moment impulse in B, N m s
  std::optional<Vector3d> velocity;            ///< with `feature`: of its point in B, m/s
  Vector3d r = Vector3d::Zero();               ///< contact point from the target's centroid, B, m
  Matrix3d target_inertia = Matrix3d::Zero();  ///< in B, kg m^2
};

/// @param motion null: the problem has no target
ContactEvent contact_event(const CaptureProblem& problem, const TargetMotion* motion,
                           const Configuration& configuration);

/// How fast target and hand close along d (robot at rest), m/s.
///
/// With a predicted target the velocity of its contact point decides; along a stated direction (and
/// along those about it) it comes with the stated closing speed.
double closing_speed(const CaptureProblem& problem, const ContactEvent& event, const Vector3d& d);

/// The hand axes in N that the problem wants at a configuration; empty when it leaves some open.
///
/// At a contact feature with roll zero: the shortest turn of the target's axes that brings the
/// approach axis to the inward normal; the roll is about the outward normal.
std::optional<Eigen::Quaterniond> wanted_hand_axes(const CaptureProblem& problem,
                                                   const ContactEvent& event,
                                                   const Configuration& configuration);

/// Everything linear in the impulse at one posture.
struct PostureResponse {
  Eigen::VectorXd phi;               ///< n
  reference::Dynamics dynamics;      ///< at rest
  Eigen::VectorXd added_inertia;     ///< n
  std::vector<bool> locked;          ///< n or empty
  Matrix3d W = Matrix3d::Zero();     ///< hand velocity per force impulse, 1/kg
  Eigen::Matrix<double, 3, 6> B;     ///< Delta omega = B Fbar
  Vector3d r_gh = Vector3d::Zero();  ///< system centroid to hand, in B, m

  reference::Impact impact(const Vector6d& Fbar) const {
    return reference::impact(dynamics, added_inertia, locked, Fbar);
  }
  /// |f| |r_gh| + |t|: what angular momenta are measured against. Where hand and centroid meet to
  /// 1e-6 of the two arms, it is rounding_scale().
  double momentum_scale(const Vector6d& Fbar) const {
    const double arms = dynamics.hand_position.norm() + dynamics.centroid.norm();
    if (r_gh.norm() <= 1e-6 * arms) return rounding_scale(Fbar);
    return Fbar.head<3>().norm() * r_gh.norm() + Fbar.tail<3>().norm();
  }
  /// |f| (|r_bh| + |r_bg|) + |t|: sizes of what angular momenta about the centroid are differences
  /// of. Two evaluations agree to a part of this one only.
  double rounding_scale(const Vector6d& Fbar) const {
    const double arms = dynamics.hand_position.norm() + dynamics.centroid.norm();
    return Fbar.head<3>().norm() * arms + Fbar.tail<3>().norm();
  }
};
/// What the joint resistance adds to the joint inertia during the impact (n).
Eigen::VectorXd added_inertia_of(const JointResistance& resistance, int n);
PostureResponse posture_response(const CaptureProblem& problem, const Eigen::VectorXd& phi);

/// The impulse [f; t] at the hand along d, by the problem's contact law, in B. Zero when hand and
/// target separate.
/// @pre event.missing is empty
Vector6d impulse_along(const CaptureProblem& problem, const ContactEvent& event,
                       const PostureResponse& response, const Vector3d& d);

/// The impulse of one scenario of the uncertainty set, in B.
/// @param motion of the target, reaching beyond the contact by the scenario's time offset; null
/// without a target
Vector6d scenario_impulse(const CaptureProblem& problem, const TargetMotion* motion,
                          const Configuration& configuration, const PostureResponse& response,
                          const Scenario& scenario);

/// How far the base has turned `after` seconds after an impulse under the problem's first
/// controller, rad: simulated with adaptive steps from the jump of `reference`. At most pi; pi when
/// the simulation breaks off.
/// @param planned the robot that the controller was made for; null: the problem's
double attitude_turned(const CaptureProblem& problem, const PostureResponse& response,
                       const Vector6d& Fbar, double after, const RobotModel* planned = nullptr);

/// The most by which objectives of the problem as predicted may be misstated, relative: two
/// integrations of one motion agree less well than two evaluations of one formula.
double objective_tolerance(const CaptureProblem& problem, double recompute_tolerance);

/// One term of an objective for an impulse, in its own unit.
double term_value(const CaptureProblem& problem, const ObjectiveTerm& term,
                  const PostureResponse& response, const Vector6d& Fbar,
                  const RobotModel* planned = nullptr);

/// The problem's objective for an impulse, and the size of what its terms are sums and differences
/// of: positive for every impulse but none, and at a hand in the centroid as well.
double objective_value(const CaptureProblem& problem, const PostureResponse& response,
                       const Vector6d& Fbar, const RobotModel* planned = nullptr);
double objective_scale(const std::vector<ObjectiveTerm>& terms, const PostureResponse& response,
                       const Vector6d& Fbar);

/// The problem's measure over its samples (expectation, CVaR), as a root.
double sampled_measure(const CaptureProblem& problem, const TargetMotion* motion,
                       const Configuration& configuration, const PostureResponse& response);

/// Orthonormal projector onto the null space of A (3 x n) and its rank.
struct NullSpace {
  Eigen::MatrixXd projector;
  int rank = 0;
};
NullSpace null_space(const Eigen::MatrixXd& A, double relative_tolerance);

}  // namespace stillbase::verification
