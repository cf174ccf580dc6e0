// A capture problem as plain data: what a problem file says, in SI units, after reading.
//
// Everything is stated: the reader has put every default in place. A problem is written back as a
// normalised copy that reads to the same data.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <stillbase/core/constants.hpp>
#include <stillbase/impact/joint_resistance.hpp>
#include <stillbase/plan/least_values.hpp>
#include <stillbase/plan/post_impact.hpp>
#include <stillbase/plan/quantities.hpp>
#include <stillbase/plan/user_functions.hpp>
#include <stillbase/robot/assembled_robot.hpp>
#include <stillbase/robot/robot_model.hpp>
#include <stillbase/target/prediction.hpp>
#include <stillbase/target/target.hpp>

namespace stillbase {

enum class Frame { Base, Inertial };

/// Where the impulse comes from.
enum class ImpulseSource {
  Given,      ///< direction and magnitude are stated
  PointMass,  ///< p = (1+e) v_n / (n' W_h n + 1/m_t)
  RigidBody   ///< p = (1+e) v_n / (n' W_h n + n' W_t n)
};

struct ImpulseSpec {
  ImpulseSource source = ImpulseSource::PointMass;
  /// What the contact makes of the relative velocity: of search, prediction, simulation and
  /// verification. Frictionless: p along the normal; else the impulse follows from all of it.
  ContactLaw contact = ContactLaw::Frictionless;
  /// Direction of the impulse on the hand (unit). Empty: the target's outward normal at the contact
  /// feature, from the nominal motion.
  std::optional<Vector3d> direction;
  Frame direction_frame = Frame::Base;
  double magnitude = 1;                ///< Given: N s
  Vector3d moment = Vector3d::Zero();  ///< Given: moment impulse in direction_frame, N m s
  double closing_speed = 0;            ///< PointMass with a stated direction: m/s
  double restitution = 0;              ///< e in [0, 1]; Frictionless
};

/// The motion of the hand right before a sticking contact or a latch. The robot has no momentum
/// then: Omega = -H_b^-1 H_bphi phidot, and the hand moves with Jhat_phi phidot.
struct HandMotionSpec {
  HandVelocity velocity = HandVelocity::Rest;
  /// Stated: velocity of the target's point and angular velocity of the target as the hand sees
  /// them, in T, m/s, rad/s; what is empty follows from the joint rates.
  std::optional<Vector3d> linear, angular;
  ArrivalRates rates = ArrivalRates::LeastJointRate;
  bool moves() const { return velocity != HandVelocity::Rest; }
};

enum class AttitudeFreedom {
  Fixed,
  Axis,  ///< about one axis
  Cone,  ///< one axis of the base near a direction, the roll about it free
  Free
};
enum class PositionFreedom { Fixed, Box, Free };

/// A base_attitude_max of this or more limits nothing, rad: pi as people write it.
inline constexpr double kEveryAttitude = 3.14159;

/// What the search may change. Everything else stays as stated.
struct VariableSpec {
  std::vector<bool> joints;  ///< n; false: stays at the start posture
  AttitudeFreedom base_attitude = AttitudeFreedom::Fixed;
  /// Unit, in N. Axis: the base turns about it. Cone: the axis of the base that points along it in
  /// the stated attitude stays within base_attitude_max of it.
  Vector3d base_attitude_axis = Vector3d::UnitZ();
  double base_attitude_max = kPi;  ///< rad from the stated attitude; see kEveryAttitude
  PositionFreedom base_position = PositionFreedom::Fixed;
  Vector3d base_position_lower = Vector3d::Zero();  ///< Box: corners in N, m
  Vector3d base_position_upper = Vector3d::Zero();
  double contact_time_lower = 0, contact_time_upper = 0;  ///< s; equal: fixed
  std::string feature;  ///< name of the contact feature; empty without a target body
  /// Those that the planner may choose among; empty: `feature` is stated. `feature` is the one that
  /// is looked at, of a plan the chosen one.
  std::vector<std::string> features;
};

/// What is minimised over the uncertainty set. All are measures of |y|^2, reported as a root.
enum class RiskMeasure {
  Nominal,      ///< |y| at the nominal direction
  WorstCase,    ///< largest |y| over the cone of directions
  Expectation,  ///< root of the mean of |y|^2 over the samples
  Cvar          ///< root of the mean of |y|^2 over the worst samples
};

struct MeasureSpec {
  RiskMeasure kind = RiskMeasure::Nominal;
  double cvar_level = 0.9;  ///< Cvar: the mean is over the worst 1 - level of the samples, [0, 1)
  int samples = 64;         ///< Expectation, Cvar
  std::uint64_t seed = 1;   ///< of the samples
};

/// Equations on the hand.
enum class HandConstraint {
  None,      ///< the station follows the hand (base position free), or there is no target point
  Position,  ///< hand origin at the point
  Axis,      ///< the position, and the approach axis against the normal; roll about it is free
  Pose       ///< the position and all three axes
};

struct HandSpec {
  HandConstraint constraint = HandConstraint::None;
  /// Where the hand must be. Empty: at the contact feature at the contact time.
  std::optional<Vector3d> position;
  std::optional<Eigen::Quaterniond> orientation;  ///< of the hand frame; Pose only
  Frame frame = Frame::Inertial;                  ///< of position and orientation
  Vector3d approach_axis =
      Vector3d::UnitZ();  ///< unit vector of the hand frame that points out of the hand
  double roll = 0;        ///< Pose at a contact feature: angle about the normal, rad
};

enum class CaseConstraint { None, C, C1, C2, G2, G3 };

struct ConstraintSpec {
  CaseConstraint impact_case = CaseConstraint::None;
  double joint_limit_margin = 0;  ///< rad or m kept from every joint limit
  double closing_speed_min =
      1e-3;  ///< m/s, > 0: without it the least objective is that of no contact
  /// Rates of the joints right after the nominal impact: part of the robot file's limits, or
  /// limits of their own (n, rad/s or m/s; empty: none). At most one of the two.
  std::optional<double> joint_rate_scale;
  JointVectord joint_rate_max;
  // Least values, 0: no bound. coupling_singular_value_min (kg m^2) is of Htilde_omegaphi,
  // jacobian_singular_value_min (m) of the generalized Jacobian with its angular rows times
  // `jacobian_length`, both of the matrix's generic rank.
#define STILLBASE_LEAST_VALUE(quantity, dimension, uncounted, sentence) double quantity##_min = 0;
  STILLBASE_LEAST_VALUES(STILLBASE_LEAST_VALUE)
#undef STILLBASE_LEAST_VALUE
  double jacobian_length = 1;  ///< m
  /// Kept at the contact between bodies that may not touch, m; empty: not a constraint.
  std::optional<double> clearance;
};

/// Axes in which the covariance of a residual velocity is stated: those of the target, which rotate
/// with it, or those of N.
enum class ResidualFrame { Target, Inertial };

/// What remains unknown of the relative velocity V = [v; omega] of target and hand at the contact:
/// V = Vbar + error, Vbar the nominal one, the error Gaussian of mean zero.
struct ResidualVelocity {
  /// Stated: 6 x 6, m^2/s^2, m rad/s^2, rad^2/s^2, positive semidefinite. Empty: that of the
  /// target's estimate (`target_deviations`) carried to the contact, plus the hand's tracking.
  std::optional<Matrix6d> covariance;
  ResidualFrame frame = ResidualFrame::Target;  ///< of the stated covariance
  /// Standard deviations of the hand's velocity along and about every axis; covariance not stated.
  double linear_tracking = 0, angular_tracking = 0;  ///< m/s, rad/s
  /// k: the worst case is over the ellipsoid of k standard deviations.
  double deviations = 3;
};

struct UncertaintySpec {
  double cone_half_angle = 0;  ///< rad; 0: the direction is exactly known
  /// The half-angle is the one that follows from `target_deviations` with this probability
  /// (encounter/direction_cone.hpp); empty: it is stated.
  std::optional<double> cone_confidence;
  std::optional<Vector3d>
      cone_plane_normal;  ///< planar problems: the wedge's plane (unit normal, in B)
  // Half ranges of even distributions about the nominal values; for samples alone.
  double closing_speed = 0;     ///< m/s
  double restitution = 0;       ///< on e
  double target_mass = 0;       ///< fraction of the mass
  double target_inertia = 0;    ///< fraction of the inertia
  double contact_point = 0;     ///< m: radius of a disc normal to the direction
  double contact_time = 0;      ///< s
  JointVectord joint_position;  ///< rad (m), n or empty: of the posture at the impact
  /// In place of a cone: worst case and expectation are those over the relative velocity then.
  std::optional<ResidualVelocity> residual_velocity;
};

inline constexpr int kMaxStarts = 10'000'000;  ///< of a search, in a file or on a command line

/// SearchSpec::starts of a search that decides itself, `auto` in a problem file: 64 of the nominal
/// problem, and of a worst case rounds of further ones, see SearchOptions::is_adaptive.
inline constexpr int kAutomaticStarts = 0;

struct SearchSpec {
  std::string optimizer = "sqp";
  int starts = kAutomaticStarts;
  std::uint64_t seed = 1;
  int max_candidates = 32;  ///< kept in the plan
};

/// What the base does while the arm moves.
enum class BaseMode {
  Held,         ///< actively kept where it is
  Floating,     ///< without momentum: it turns and shifts with the arm
  ReactionNull  ///< floating, the joints moving so that the attitude stays
};

/// What the path is made better in after it was found.
enum class PathPolish { None, Attitude, Time };

/// How far the planner goes on where an approach path to a good candidate was found.
enum class ApproachEffort {
  First,  ///< no further
  Best    ///< to the candidates that rank before the reached one, best first, while time is left
};

/// A fixed body that the robot may not touch.
struct Obstacle {
  std::string name;
  Frame frame = Frame::Inertial;
  Pose pose;
  Geometry geometry;
};

struct ApproachSpec {
  bool enabled = true;
  BaseMode base = BaseMode::Held;
  bool station_free = true;         ///< the start pose follows from the path's net motion
  JointVectord acceleration_limit;  ///< n, rad/s^2 or m/s^2
  double velocity_scale =
      1;            ///< fraction of the joint rate limits that the approach may use, (0, 1]
  double wait = 5;  ///< s at rest before the contact
  double max_duration = 600;        ///< s from start to contact
  double clearance = 0.01;          ///< m kept between bodies along the path
  double contact_allowance = 0.15;  ///< m: the hand's body may be near the target once the feature
                                    ///< is this close to the hand
  double resolution = 0.02;         ///< rad between checked postures
  std::string planner = "rrt_connect";
  int max_iterations = 20000;  ///< of the planner
  PathPolish polish = PathPolish::None;
  /// ReactionNull: permitted rotation angle of the base, rad; 0.1 deg.
  double attitude_tolerance = 0.0017453292519943296;
  /// Candidates are good when their objective is at most this factor times the best one's, >= 1:
  /// the approach has all of them as goals.
  double goal_factor = 1.1;
  int goal_samples = 8;  ///< tries for further goals, as good, on the self-motion at the contact
  /// Candidates whose approach is tried one by one before giving up. Every try may cost a second.
  int max_approaches = 8;
  ApproachEffort effort = ApproachEffort::First;
  /// Of a hand that moves at the contact: a path on which it stops if the grasp does not close.
  bool abort = true;
};

struct CaptureProblem {
  std::string name;       ///< stem of the file
  std::string purpose;    ///< one sentence
  std::string source;     ///< file it was read from, for messages
  std::string urdf;       ///< text of the robot file, or of what was put together
  std::string urdf_path;  ///< as written in the problem file; empty: `parts` names arms
  RobotParts parts;       ///< how `urdf` was put together; it is not done again with a text
  RobotModel robot;
  JointResistance resistance;
  JointVectord start;  ///< n, start posture
  Pose base;           ///< stated pose T_NB
  std::vector<std::pair<std::string, std::string>>
      allowed_contacts;  ///< pairs of links that may touch
  std::optional<TargetBody> target;
  TargetState target_state;                             ///< estimate
  std::optional<EstimateDeviations> target_deviations;  ///< of the estimate, when stated
  std::vector<Obstacle> obstacles;
  ImpulseSpec impulse;
  HandMotionSpec hand_motion;
  VariableSpec variables;
  /// One term of size 1: that quantity alone, in its own unit.
  std::vector<ObjectiveTerm> objective = {ObjectiveTerm{}};
  MeasureSpec measure;
  HandSpec hand;
  ConstraintSpec constraints;
  UncertaintySpec uncertainty;
  SearchSpec search;
  ApproachSpec approach;
  PostImpactSpec post_impact;
  UserFunctions user;  ///< in no file
};

}  // namespace stillbase
