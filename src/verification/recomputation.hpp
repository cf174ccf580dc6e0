// The contact and the impact at one configuration, by `reference`: what a plan should state.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <stillbase/plan/plan.hpp>
#include <stillbase/plan/scenario.hpp>
#include <stillbase/reference/reference.hpp>

namespace stillbase::verification {

/// The chosen contact feature of the problem, if it has one.
std::optional<ContactFeature> feature_of(const CaptureProblem& problem);

/// Motion of the target from `first_time` (s) on, which may be far before the contact. With a
/// stated impulse direction the target comes along it and touches the hand at the contact time;
/// otherwise it follows its nominal motion. Empty without a target.
/// @throws std::invalid_argument when it cannot be predicted over that time
std::optional<TargetMotion> target_motion(const CaptureProblem& problem,
                                          const Configuration& configuration,
                                          const Vector3d& hand_N, double first_time);

/// The contact as the problem and the motion of the target fix it, at one configuration.
struct ContactEvent {
  std::string missing;                  ///< why it is not known; empty: it is
  std::optional<ContactState> feature;  ///< contact point on the predicted target, in N
  Eigen::Quaterniond R_NT = Eigen::Quaterniond::Identity();  ///< with `feature`
  Vector3d n = Vector3d::Zero();               ///< direction of the impulse on the hand, unit, in B
  Vector3d moment = Vector3d::Zero();          ///< given moment impulse in B, N m s
  std::optional<Vector3d> velocity;            ///< with `feature`: of its point in B, m/s
  Vector3d omega = Vector3d::Zero();           ///< with `feature`: of the target in B, rad/s
  Vector3d r = Vector3d::Zero();               ///< contact point from the target's centroid, B, m
  Matrix3d target_inertia = Matrix3d::Zero();  ///< in B, kg m^2
};

/// @param motion null: the problem has no target
ContactEvent contact_event(const CaptureProblem& problem, const TargetMotion* motion,
                           const Configuration& configuration);

/// Closing speed of target and hand along d (robot at rest), m/s: by the velocity of a predicted
/// target's contact point, else as stated, also for directions about the stated one.
double closing_speed(const CaptureProblem& problem, const ContactEvent& event, const Vector3d& d);

/// The hand axes in N that the problem wants at a configuration; empty when it leaves some open.
///
/// At a contact feature with roll zero: the shortest rotation of the target's axes that brings the
/// approach axis to the inward normal; the roll is about the outward normal.
std::optional<Eigen::Quaterniond> demanded_hand_axes(const CaptureProblem& problem,
                                                     const ContactEvent& event,
                                                     const Configuration& configuration);

/// [Delta Omega; Delta phidot], 6 + n.
Eigen::VectorXd velocity_jump(const reference::Impact& impact);

/// Velocity [v; omega] of the base per joint rates, the robot without momentum, 6 x n.
Eigen::MatrixXd base_response(const reference::Dynamics& d);
/// The same of the hand: its Jacobian with the base that follows.
Eigen::MatrixXd hand_response(const reference::Dynamics& d);

/// Angular momentum that a held target brings along, about the common centroid.
struct HeldMomentum {
  Vector3d total = Vector3d::Zero();  ///< in B, N m s
  double size = 0;                    ///< |I_t omega_t| + m_r |s| |v_t|, see momentum_scale()
};

/// A robot that moves without momentum, in B.
struct MotionOfRobot {
  Vector6d Omega = Vector6d::Zero();  ///< of the base
  Eigen::VectorXd phidot;             ///< n
  Vector6d hand = Vector6d::Zero();   ///< velocity [v; omega] of the hand
};

/// Everything linear in the impulse at one posture.
struct PostureResponse {
  Eigen::VectorXd phi;               ///< n
  reference::Dynamics dynamics;      ///< at rest
  Eigen::VectorXd added_inertia;     ///< n
  std::vector<bool> locked;          ///< n or empty
  Matrix6d W = Matrix6d::Zero();     ///< hand velocity [v; omega] per impulse [f; t] at the hand
  Eigen::Matrix<double, 3, 6> B;     ///< Delta omega = B Fbar
  Vector3d r_gh = Vector3d::Zero();  ///< system centroid to hand, in B, m
  Matrix6d H_b = Matrix6d::Zero();   ///< inertia of all that moves with the base
  std::optional<HeldMomentum> held;
  std::optional<MotionOfRobot> before;  ///< of a hand that moves before the contact

  /// From now on the joints move at these rates (n) before the contact, the robot without momentum.
  /// To be said before hold().
  void move(const Eigen::VectorXd& phidot);
  /// From now on the hand holds the body: the momenta of impacts, H_b, Htilde_omega and
  /// Htilde_omegaphi are those of both together.
  void hold(const reference::MetBody& body);

  /// Velocities and momenta right after the impact; of a robot at rest before it the jump.
  reference::Impact impact(const Vector6d& Fbar) const;
  /// The jump alone.
  reference::Impact jump(const Vector6d& Fbar) const;
  /// |f| |r_gh| + |t|: what angular momenta are measured against. Where hand and centroid coincide
  /// to 1e-6 of the two arms, it is rounding_scale(). Of a held target |I_t omega_t| + m_r |s|
  /// |v_t|, s from the robot's centroid to the target's, m_r = M m_t / (M + m_t).
  double momentum_scale(const Vector6d& Fbar) const;
  /// |f| (|r_bh| + |r_bg|) + |t|: sizes of what angular momenta about the centroid are differences
  /// of. Two evaluations agree to a part of this one only.
  double rounding_scale(const Vector6d& Fbar) const;
};
/// W and B stay empty: for callers that need one impact only.
PostureResponse posture_dynamics(const CaptureProblem& problem, const Eigen::VectorXd& phi);
PostureResponse posture_response(const CaptureProblem& problem, const Eigen::VectorXd& phi);

/// The target right before the contact, in B.
/// @pre event.missing is empty and the problem has a target
reference::MetBody met_body(const CaptureProblem& problem, const ContactEvent& event);

/// What the problem decides of the hand's velocity right before the contact.
struct DecidedVelocity {
  Eigen::MatrixXd rows;    ///< m x 6, of velocities [v; omega] of the hand in B
  Eigen::VectorXd values;  ///< m, m/s or rad/s

  /// Largest difference of what is decided, m/s or rad/s; 0 when nothing is.
  double error(const Vector6d& hand) const;
};
/// @pre event.missing is empty; the hand moves
DecidedVelocity decided_velocity(const CaptureProblem& problem, const ContactEvent& event,
                                 const Configuration& at);

/// Where the problem has the hand move before the contact: the response moves so.
void move_hand(const CaptureProblem& problem, const ContactEvent& event, const Configuration& at,
               PostureResponse& response);

/// Most that a joint may move before the contact where the hand does, rad/s (m/s).
double arrival_rate_limit(const CaptureProblem& problem, int joint);

/// After a latch: the response holds the target. Else nothing happens.
void hold_latched(const CaptureProblem& problem, const ContactEvent& event,
                  PostureResponse& response);

/// Both, in their order.
/// @pre event.missing is empty
void prepare_contact(const CaptureProblem& problem, const ContactEvent& event,
                     const Configuration& at, PostureResponse& response);

/// Whether the points of hand and target do not close in along d, the hand as it moves: nothing
/// pushes them together. A latch whose hand moves along holds them whatever the sign.
bool separates(const CaptureProblem& problem, const ContactEvent& event,
               const PostureResponse& response, const Vector3d& d);

/// The impulse [f; t] at the hand, by the problem's contact law, in B; a normal contact's along d.
/// Zero when hand and target separate along d, or a sticking contact would pull.
/// @pre event.missing is empty
Vector6d impulse_along(const CaptureProblem& problem, const ContactEvent& event,
                       const PostureResponse& response, const Vector3d& d);

/// What the cases of an impact are judged with: the nominal wrench [n; t] per newton second of
/// impulse, in B; of a sticking contact or a latch the whole impulse.
Vector6d case_wrench(const CaptureProblem& problem, const ContactEvent& event,
                     const PostureResponse& response);

/// The impulse of one scenario of the uncertainty set, in B. After a latch the response holds the
/// scenario's target.
/// @param motion of the target, reaching beyond the contact by the scenario's time offset; null
/// without a target
Vector6d scenario_impulse(const CaptureProblem& problem, const TargetMotion* motion,
                          const Configuration& configuration, PostureResponse& response,
                          const Scenario& scenario);

/// One configuration under judgement and what follows from it.
class Situation {
 public:
  /// @param stated must outlive this object
  /// @param first_time from which the target's motion is known, s; empty: the contact time
  /// @throws std::invalid_argument when the target's motion cannot be predicted
  Situation(const CaptureProblem& stated, const Configuration& at,
            std::optional<double> first_time = std::nullopt);
  Situation(const Situation&) = delete;
  Situation& operator=(const Situation&) = delete;

 private:
  std::optional<CaptureProblem> other_feature_;  ///< the problem with the feature of `at`

 public:
  const CaptureProblem& problem;  ///< with the contact feature of `at`
  const Configuration at;

 private:
  PostureResponse response_;

 public:
  const PostureResponse& response;  ///< after a latch with the target
  const Vector3d hand_N;            ///< position of the hand, m
  const Eigen::Quaterniond R_NH;    ///< hand axes
  const std::optional<TargetMotion> motion;
  const ContactEvent event;

  const TargetMotion* target() const { return motion ? &*motion : nullptr; }
  /// Pose of the target at the contact; empty without one.
  std::optional<Pose> target_pose() const;
  Vector6d impulse(const Vector3d& d) const { return impulse_along(problem, event, response, d); }
  Vector6d impulse() const { return impulse(event.n); }
};

/// Angular momenta right after an impact, relative to momentum_scale().
struct CaseResiduals {
  double total = 0, base = 0, coupling = 0;
  double wanted = 0;  ///< largest of those that the problem's case wants to vanish
};
CaseResiduals case_residuals(const CaptureProblem& problem, const PostureResponse& response,
                             const Vector6d& Fbar);

/// Momenta that vanish in a case, and their names.
struct VanishingMomenta {
  std::vector<Vector3d reference::Impact::*> momenta;
  const char* names = "";
};
VanishingMomenta vanishing_momenta(CaseConstraint wanted);

/// Orthonormal projector onto the null space of A (3 x n) and its rank.
struct NullSpace {
  Eigen::MatrixXd projector;
  int rank = 0;
};
NullSpace null_space(const Eigen::MatrixXd& A, double relative_tolerance);

}  // namespace stillbase::verification
