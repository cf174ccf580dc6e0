// A plan as plain data: what a plan file holds.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include <stillbase/impact/summary.hpp>
#include <stillbase/plan/problem.hpp>

namespace stillbase {

enum class PlanStatus { Optimal, Feasible, Infeasible, Limit };
std::string to_string(PlanStatus status);

/// Where the robot is at the contact.
struct Configuration {
  JointVectord phi;          ///< n
  Pose base;                 ///< T_NB
  double contact_time = 0;   ///< s
  std::string feature = {};  ///< name of the contact feature; empty: the problem's own
};

/// The residual velocity of a problem at the contact, [v; omega] of target minus hand, in B.
struct ResidualSummary {
  Vector6d velocity = Vector6d::Zero();        ///< Vbar, nominal, m/s, rad/s
  Matrix6d covariance = Matrix6d::Zero();      ///< m^2/s^2, m rad/s^2, rad^2/s^2
  double deviations = 0;                       ///< k of the ellipsoid of the worst case
  Vector6d worst_velocity = Vector6d::Zero();  ///< where in it the worst case is
  /// Probability that target and hand separate along the normal, so that there is no contact. The
  /// measures count these velocities as if the contact held: they are upper bounds.
  double separating = 0;
};

struct ObjectiveValue {
  std::string name;    ///< e.g. "base_angular_momentum"
  std::string unit;    ///< e.g. "N m s"
  double nominal = 0;  ///< at the nominal direction
  /// Over the direction cone, or the ellipsoid of the residual velocity; = nominal without both.
  double worst_case = 0;
  Vector3d worst_direction = Vector3d::Zero();  ///< unit, in B
  double value = 0;                             ///< of the measure that was minimised
  /// False: a limit came before worst case and measure were worked out. Then worst_case is the
  /// largest value over the directions that were evaluated, the nominal one among them, and value
  /// is the same (of samples: the nominal value).
  bool is_judged = true;
  std::map<std::string, double> terms;  ///< nominal |y_i|, each in its own unit
  /// Names of the user's terms, of which `verify` knows no function.
  std::vector<std::string> user_terms;
  std::optional<ResidualSummary> residual;  ///< where the problem states a residual velocity
};

/// The configuration with the lowest nominal value; among equal ones (zeros) the one with the
/// smallest worst case, among these the nearest to the start posture. Values are equal to 1e-8 of
/// the objective's typical size.
struct NominalOptimum {
  Configuration configuration;
  double nominal = 0;
  double worst_case = 0;
  double value = 0;  ///< of the measure
};

struct ConstraintValue {
  std::string name;
  double value = 0, lower = 0, upper = 0;
  double violation = 0;   ///< max(lower - value, value - upper, 0)
  std::string unit = {};  ///< of all of them; not in a plan file
};

enum class ProofStatus {
  NotApplicable,  ///< the problem is not of the kind that can be proven
  Complete,       ///< every solution is enclosed
  Undecided       ///< every solution is enclosed or in an undecided box
};
std::string to_string(ProofStatus status);

struct Ends {
  double lower = 0, upper = 0;
};

/// Values of the variables between two ends.
struct JointBox {
  JointVectord lower, upper;              ///< n, rad or m; equal for joints that are not free
  std::optional<Ends> base_angle = {};    ///< of the base about its axis from the stated attitude,
                                          ///< rad; empty: that is no variable
  std::optional<Ends> contact_time = {};  ///< s; empty: it is fixed
};

/// What branch and bound with intervals says about all solutions at once. The ends are rounded
/// outwards.
struct Proof {
  ProofStatus status = ProofStatus::NotApplicable;
  std::string statement;            ///< in words: what was proven, or why nothing was
  std::vector<JointBox> solutions;  ///< each holds exactly one solution
  std::vector<int> candidates;      ///< per solution the candidate that is in it; -1: none
  std::vector<JointBox> undecided;  ///< may hold solutions
  int found_by_search = 0;          ///< solutions that the search had found by itself
  long boxes = 0;                   ///< looked at
  /// Of the measure, in its unit; zero: of the nominal objective, the solutions being its zeros.
  std::optional<double> lower_bound;
  std::optional<double> gap;  ///< as gap_to_bound()
};

struct Certificate {
  double kkt_residual = 0;  ///< infinite: not known, a limit came first
  double max_violation = 0;
  int starts = 0;
  int distinct_solutions = 0;
  double unseen = 1;        ///< see SearchResult::unseen
  bool had_rounds = false;  ///< see SearchResult::had_rounds
  /// Smallest curvature of the Lagrangian along the directions that the active constraints leave,
  /// of the smooth objective in typical sizes, per rad^2 (m^2, s^2). Positive: a strict local
  /// minimum; empty: no direction is left.
  std::optional<double> reduced_hessian_min_eigenvalue;
  Proof proof;  ///< of all candidates together
};

/// Solutions with vanishing nominal objective that form a curve, followed to its ends.
struct SolutionFamily {
  double length = 0;  ///< rad, m and s mixed as the variables are
  bool is_closed = false;
  bool is_complete = false;  ///< closed, or followed to limits at both ends
  int starts = 0;            ///< of the search that ended on it
  /// Along it, in order, at most 0.1 apart (as the length is measured), both ends included.
  std::vector<Configuration> points;
};

/// Whole turns that the limits of a joint leave room for: with any of them the posture is the same.
struct JointTurns {
  std::string joint;
  int least = 0, most = 0;  ///< turns of 2 pi, least <= 0 <= most
};

struct Candidate {
  Configuration configuration;
  double objective = 0;  ///< nominal
  double worst_case = 0;
  double max_violation = 0;     ///< of the constraints, in their units
  int starts_reached = 0;       ///< starts that ended here
  bool collision_free = false;  ///< at the contact: arm, base, obstacles, target
  std::string collision;        ///< "a with b" when not
  double value = 0;             ///< of the measure that was minimised
  int family = -1;              ///< index of the curve that it is on; -1: none was followed
  bool is_judged = true;        ///< as ObjectiveValue::is_judged
  /// Of a candidate that ranks before the chosen one: why it was not chosen. Empty: of the others.
  std::string excluded = {};
  /// Joints that have room for whole turns from the stated angle, each independent of the others.
  std::vector<JointTurns> turns = {};
};

enum class ApproachStatus {
  Found,
  NotRequested,
  StartInvalid,
  GoalInvalid,
  GoalUnreachable,
  UnreachableInBaseMode,  ///< the arm reaches it, but not with the base as stated
  HitEarly,
  TimeOut,      ///< a deadline came first
  Interrupted,  ///< a signal came first
  TooSlow,
  BaseDriftOpen,  ///< the base moves with the path, and no path was found that ends at the contact
  Stopped         ///< a deadline or a signal came before a path was looked for
};
std::string to_string(ApproachStatus status);

/// The robot comes to rest after a contact that did not close. Samples as those of an approach,
/// beginning with the state at the contact; the target keeps its predicted motion.
struct AbortPath {
  std::vector<double> times;  ///< s; the first one is the contact time
  std::vector<JointVectord> joint_positions;
  std::vector<JointVectord> joint_velocities;  ///< zero at the last one
  std::vector<Pose> base_poses;                ///< T_NB
  double retreat = 0;  ///< m along the normal, away from where the target's point was, asked for
  double min_clearance = 0;  ///< m, among pairs that may not touch; without hand against target
  double effort_used = 0;    ///< largest part of a joint's effort limit, 0 without limits
};

struct Approach {
  ApproachStatus status = ApproachStatus::NotRequested;
  std::string detail;         ///< what failed, by how much
  std::vector<double> times;  ///< s; the last one is the contact time
  std::vector<JointVectord> joint_positions;
  std::vector<JointVectord> joint_velocities;
  /// At the begin of the segment that starts at each sample; zero at the last one. They follow from
  /// positions and rates: a number changed afterwards no longer fits its neighbours.
  std::vector<JointVectord> joint_accelerations;
  /// At the begin of the segment that starts at each sample, by the dynamics of the floating (held)
  /// robot, rotor inertias of the problem included, friction not; zero at the last one. N m (N).
  std::vector<JointVectord> joint_torques;
  std::vector<Pose> base_poses;           ///< T_NB
  std::vector<Vector6d> base_velocities;  ///< Omega in B
  double duration = 0;                    ///< s of motion, the wait not counted
  double path_length = 0;                 ///< rad, by eight chords per segment
  double attitude_excursion = 0;  ///< rad, largest rotation angle from the base's final attitude
  double min_clearance = 0;  ///< m, among pairs that may not touch; without hand against target
  double effort_used = 0;    ///< largest part of a joint's effort limit, 0 without limits
  double late_by = 0;        ///< TooSlow: s
  int base_hits = 0;         ///< HitEarly: attempts that count for ApproachOptions::base_hits
  double hand_position_error = 0;        ///< m, hand at the end of the path from where it should be
  double hand_angle_error = 0;           ///< rad, the same of its axes
  PathPolish polish = PathPolish::None;  ///< what was made smaller
  double before_polish = 0;              ///< s of motion or rad of excursion, as OMPL's path has it
  double after_polish = 0;               ///< the same of the path as it is; never larger
  /// Of a hand that moves at the contact, where the problem asks for it.
  std::optional<AbortPath> abort = std::nullopt;
};

/// Where the chosen configuration stands among the candidates.
struct Choice {
  int better = 0;  ///< candidates that rank before it; -1: of a file that does not state it
  /// 100 (value - least value) / least value of the measure; empty: the least one is zero.
  std::optional<double> loss_percent;
};

/// A limit that is reached at the configuration and without which the measure would be smaller.
struct BindingLimit {
  std::string name;       ///< "joint_2", "contact_time", or of a constraint
  bool is_upper = false;  ///< the upper end of its range
  double value = 0;       ///< of the limit, in `unit`
  double margin = 0;      ///< distance from it, in `unit`; >= 0 but for rounding
  /// How much smaller the measure becomes per unit that the limit is moved outwards, to first
  /// order, all else chosen anew; in the objective's unit per `unit`, > 0.
  double multiplier = 0;
  std::string unit;
};

/// What the joints do after the horizon of the simulation after the impact.
struct AfterHorizon {
  double joint_rate = 0;  ///< |phidot| at the horizon, rad/s (m/s)
  /// Whether a joint still moves: it would cover more than 1e-3 rad (m) in ten horizons at its
  /// rate.
  bool moves = false;
  /// Of the first joint that reaches a stop within ten horizons: s after the impact. Empty: none.
  std::optional<double> stop_time;
  std::string joint;  ///< that reaches it
};

/// What limits the capture from the contact to the horizon.
enum class CaptureLimit {
  Reach,          ///< of the arm, from its first joint to the hand
  JointRate,      ///< after the contact
  JointTorque,    ///< that the controller demands
  JointStop,      ///< distance of a joint from the middle of its range
  GripForce,      ///< through the hand, on the latched target
  GripMoment,     ///< the same, about the hand's origin
  WheelTorque,    ///< of one axis
  WheelMomentum,  ///< that one axis holds, or has to take
  TimeWindow      ///< of the contact; under detumble also the horizon
};
std::string to_string(CaptureLimit limit);

/// How much of a limit is used.
struct LimitUse {
  CaptureLimit limit = CaptureLimit::Reach;
  std::string place;  ///< joint, axis of B ("x"), hand link, "contact_time" or "horizon"
  double value = 0;   ///< largest, in `unit`
  double most = 0;    ///< that is allowed, in `unit`, >= 0
  std::string unit;

  double margin() const { return most - value; }
  /// Of a limit that allows nothing: 0 where nothing is used, else infinite.
  double part() const { return most > 0 ? value / most : value > 0 ? kInfinity : 0; }
};

/// The limit at which a load stays longest until robot and target rest: it decides how long that
/// takes.
struct HeldLimit {
  CaptureLimit limit = CaptureLimit::WheelTorque;
  std::string place;  ///< joint, axis of B ("x") or hand link
  double time = 0;    ///< s with at least kNearLimit of it
};

/// The angular momentum that has to go somewhere after the contact, and what that takes. Of a
/// latched target it is that of robot and target, else what the impact leaves in the robot.
struct ManagedMomentum {
  Vector3d angular = Vector3d::Zero();  ///< about the common centroid, in B, N m s
  Vector3d linear = Vector3d::Zero();   ///< in B, N s; no wheel takes it
  /// Wheels: max_i |angular_i| / torque_i, s; no wheels take it sooner while the base keeps its
  /// attitude. Empty: there are none, or none of an axis that would need one.
  std::optional<double> least_time;
  // Under the problem's first controller; empty: it names none, or the simulation did not finish.
  std::optional<double> remaining;  ///< |angular momentum| outside the wheels at the horizon, N m s
  /// s after the contact: from then on at most 1 % of the angular momentum is outside the wheels
  /// and at most 1 % of the joints' largest rate is left. Empty: not within the horizon.
  std::optional<double> rest_time;
  std::vector<LimitUse> limits;  ///< the one of which most is used first
  /// Under detumble, which drives one load up to its limit: which one binds. Empty: no load comes
  /// near its limit, or the controller is another.
  std::optional<HeldLimit> longest_held;
};

/// What a plan leaves out of what its own problem says.
struct PlanWarning {
  std::string code;     ///< short name of the rule, as of a Finding
  std::string message;  ///< in words
};

struct Plan {
  CaptureProblem problem;
  PlanStatus status = PlanStatus::Infeasible;
  std::string optimizer;
  Configuration configuration;
  ImpactSummary impact;
  ObjectiveValue objective;
  std::optional<NominalOptimum> nominal_optimum;
  std::vector<ConstraintValue> constraints;
  Certificate certificate;
  std::vector<Candidate> candidates;
  std::vector<SolutionFamily> families;
  Choice choice;
  std::vector<BindingLimit> binding;  ///< the largest saving first
  Approach approach;
  /// Under the problem's first controller; empty: it names none, or the simulation did not finish.
  std::optional<AfterHorizon> after_horizon;
  std::optional<ManagedMomentum> managed_momentum;  ///< empty: the problem has no target
  std::vector<PlanWarning> warnings;
  std::map<std::string, long> solver_calls;  ///< optimizer or planner name -> calls
  std::map<std::string, double> timing;      ///< s
  /// Whether the planner knows that the configuration is reached and keeps the limits after the
  /// impact. Not in the file: false of a plan that was read.
  bool is_known_to_hold = false;
};

/// The least value among the candidates that satisfy the constraints minus the proven lower bound.
/// Where the bound is a zero of the nominal objective: the least nominal value of the candidates
/// that are enclosed solutions. Empty without a bound or such a candidate.
std::optional<double> gap_to_bound(const Plan& plan);

}  // namespace stillbase
