// Closed-loop simulation of the post-impact phase: plant, controller, integrator, limits.
//
// Rotation. The attitude is integrated as a quaternion, dq/dt = 1/2 q (0, omega), and brought back
// to unit length after every step. That equation is linear in q, so a wrong length never rotates
// the frame, and bringing back moves q by no more than the step's own error: a method of order 4
// stays of order 4 (projection methods; Hairer, Lubich, Wanner, Geometric Numerical Integration,
// IV.4). Base and joint velocities do not depend on the pose at all.
//
// Stops and friction. A joint that reaches its stop has its rate reversed, times a restitution,
// by an impulse between its two bodies; without rebound it rests there until it is pulled off.
// Coulomb friction is stick-slip, not smoothed: a joint that comes to rest sticks (its acceleration
// is zero, not small) for as long as no more than the friction torque is needed to hold it. A
// smoothed law would let joints creep and make the equation stiff. The instants at which a joint
// reaches a stop, sticks, slips or leaves are located within the integrator's step by bisection,
// and the step ends there.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <stillbase/core/interrupt.hpp>
#include <stillbase/simulation/controllers.hpp>

namespace stillbase {

struct SimulationSummary;

enum class IntegratorKind {
  Rk4,        ///< classical Runge-Kutta, fixed step; the paper's
  Midpoint,   ///< of order 2, fixed step: half the work of Rk4
  Dopri5,     ///< Dormand-Prince 5(4), adaptive
  Fehlberg78  ///< Runge-Kutta-Fehlberg 7(8), adaptive; the cheapest one for tight tolerances
};

/// A disturbance that no controller measures: wrench on the base [force; moment about the base
/// centroid] in B at time t.
using BaseWrench = std::function<Vector6d(double t, const PlantState& state)>;

struct SimulationOptions {
  IntegratorKind integrator = IntegratorKind::Rk4;
  /// s; of a fixed step the largest one (each interval is divided evenly), else the first one.
  double step = 0.01;
  double relative_tolerance = 1e-10;  ///< adaptive, per step
  double absolute_tolerance = 1e-12;  ///< adaptive, per step, in SI units
  /// s between evaluations of the controller, held in between; counted from start_time. 0:
  /// evaluated at each stage of the integrator (continuous control).
  double control_period = 0.01;
  double start_time = 0;        ///< s
  double horizon = 10;          ///< s after start_time
  double output_period = 0.01;  ///< s between trace samples; 0: first and last only
  bool torque_limits = true;    ///< clip at the joints' max_effort
  /// A drive at its max_velocity or faster gives no torque in that direction.
  bool rate_limits = true;
  bool joint_stops = true;      ///< enforced; false: passing one is reported only
  double stop_restitution = 0;  ///< [0, 1): part of the rate that a joint keeps, reversed
  bool ends_at_stop = false;    ///< the run ends where the first joint reaches its stop
  /// The run ends where this holds of what it showed so far, asked between control instants and
  /// samples; empty: never. Without side effects.
  std::function<bool(const SimulationSummary&)> ends_when;
  bool friction = false;   ///< viscous and Coulomb friction of the model
  WheelSpec wheels;        ///< off by default
  ThrusterSpec thrusters;  ///< off by default
  Grasp grasp;             ///< nothing is held by default
  BaseWrench base_wrench;  ///< empty: none
  SensorSpec sensors;      ///< exact by default
  /// The controller's model of the robot (same joints); empty: the robot itself. It knows the
  /// rotor inertia.
  std::optional<RobotModel> controller_robot;
  long max_steps = 100'000'000;  ///< of the integrator, failed tries included
  StopCondition stop;
};

/// Control period, horizon, friction, stops, wheels, thrusters, sensors and the controller's model
/// of the robot as a problem states them; all else has its default.
SimulationOptions plant_options_of(const PostImpactSpec& spec, const RobotModel& robot);

enum class SimulationStatus {
  Finished,
  Interrupted,  ///< by StopCondition::interrupted
  TimeLimit,    ///< by StopCondition::deadline
  StepLimit,    ///< max_steps, or the adaptive step fell below rounding
  Diverged      ///< a state beyond all bounds; the last good one ends the trace
};
std::string to_string(SimulationStatus status);

/// Motion at one instant. Momenta about the system centroid, (2).
struct TraceSample {
  double time = 0;  ///< s
  PlantState state;
  Vector3d base = Vector3d::Zero();      ///< Htilde_omega omega, in B, N m s
  Vector3d coupling = Vector3d::Zero();  ///< Htilde_omegaphi phidot, in B, N m s
  Vector3d total = Vector3d::Zero();     ///< L_g in B, N m s
  Vector3d total_N = Vector3d::Zero();   ///< L_g in N, N m s; conserved
  Vector3d P_N = Vector3d::Zero();       ///< linear momentum in N, N s; conserved
  JointVectord rns;                      ///< n; phidot's part in the angular reaction null space
  JointVectord orthogonal;               ///< n; phidot - rns
  JointVectord tau;                      ///< n; torque of the controller after limits, N m
  JointVectord demanded_tau;             ///< n; the same before limits, N m
  Vector3d wheel_torque = Vector3d::Zero();     ///< u of the wheels on the base, in B, N m
  Vector3d thruster_torque = Vector3d::Zero();  ///< on the base, in B, N m
  double kinetic_energy = 0;                    ///< J, of the robot
  std::optional<TargetPlantState> target;       ///< in runs with one
  /// On the held target at the hand's origin, [f; t] in B, N, N m; zero without one.
  Vector6d grip_wrench = Vector6d::Zero();
  Vector3d contact_force = Vector3d::Zero();  ///< on the hand, in N, N
};

enum class LimitKind { Torque, Rate, LowerStop, UpperStop };
std::string to_string(LimitKind kind);

/// The first time that a joint reaches one of its limits.
struct LimitEvent {
  int joint = 0;
  LimitKind kind = LimitKind::Torque;
  /// s; torque and rate: the end of the integrator's step; stops that are not enforced: from the
  /// cubic through the step's ends
  double time = 0;
};

inline constexpr double kAtRest = 0.01;        ///< of momentum and joint rates
inline constexpr double kJointsAtRest = 1e-6;  ///< rad/s: slower joints rest whatever they did

inline constexpr double kNearLimit = 0.9;  ///< of a limit: a load from there on is near it

/// For how long loads are near their limits (kNearLimit) until robot and target rest, s. Zero where
/// there is no limit.
struct LoadTimes {
  JointVectord joint_rates;                   ///< n
  JointVectord joint_torques;                 ///< n, of the torques that the controller asks for
  Vector3d wheel_torques = Vector3d::Zero();  ///< per axis of B
  double grip_force = 0;
  double grip_moment = 0;
};

/// Result of the run. Extremes are taken over the integrator's steps.
struct SimulationSummary {
  double peak_base_rate = 0;       ///< max |omega|, rad/s
  double residual_base_rate = 0;   ///< |omega| at the end, rad/s
  double attitude_turned = 0;      ///< largest angle away from the first attitude, rad, <= pi
  double attitude_turned_end = 0;  ///< the same at the end
  double peak_joint_rate = 0;      ///< max |phidot| (norm over the joints), rad/s
  double residual_joint_rate = 0;  ///< |phidot| at the end
  JointVectord peak_joint_rates;   ///< n, max |phidot_k|
  double peak_torque = 0;          ///< max over time and joints, N m
  JointVectord peak_torques;       ///< n, max |tau_k|
  /// As both before, of the torques that the controller asks for: no limit has cut them.
  double peak_demanded_torque = 0;
  JointVectord peak_demanded_torques;
  /// Largest |P - P(0)| and |L - L(0)| in N, L = L_g and the wheels' momentum less what the
  /// thrusters gave. With a base wrench or a contact this is its doing, not an error.
  double linear_momentum_drift = 0;   ///< N s
  double angular_momentum_drift = 0;  ///< N m s
  /// The larger of both, relative to the most that the initial kinetic energy T could hold:
  /// sqrt(2 w T) and sqrt(2 T trace(Htilde_omega)) (never zero for a robot that moves).
  double relative_momentum_drift = 0;
  /// Angular momentum that the arm cannot take over from the base, under reaction null space
  /// control (zero otherwise).
  double peak_lost_momentum = 0;               ///< N m s
  Vector3d lost_momentum = Vector3d::Zero();   ///< at the end, in B, N m s
  Vector3d lost_direction = Vector3d::Zero();  ///< its unit vector; zero without a loss
  int lowest_rank = 3;             ///< least number of directions that the arm fully reaches
  std::vector<LimitEvent> limits;  ///< by time; the first of each kind and joint
  int stop_hits = 0;               ///< times that a joint ran into an enforced stop
  double hardest_stop = 0;         ///< largest rate at which one did, rad/s (m/s)
  double peak_wheel_torque = 0;    ///< largest |u_i|, N m
  Vector3d peak_wheel_torques = Vector3d::Zero();  ///< the same per axis of B
  Vector3d peak_wheel_momenta = Vector3d::Zero();  ///< largest |h_w| per axis of B, N m s
  double peak_grip_force = 0;                      ///< through the hand on a held target, N
  double peak_grip_moment = 0;                     ///< about the hand's origin, N m
  JointVectord lowest_positions;                   ///< n, min phi_k, rad or m
  JointVectord highest_positions;                  ///< n, max phi_k
  /// From then on at most kAtRest of the first |L_g| is outside the wheels, of that after the last
  /// contact where one takes time, and no more than that part of the largest joint rate is left, s;
  /// or no more of both than one deviation of the sensors' errors. Empty: not at the end.
  std::optional<double> rest_time;
  LoadTimes near_limit;
  double peak_contact_force = 0;               ///< N
  Vector3d wheel_momentum = Vector3d::Zero();  ///< at the end, in B, N m s
  long steps = 0;                              ///< of the integrator
};

struct SimulationResult {
  SimulationStatus status = SimulationStatus::Finished;
  std::vector<TraceSample> trace;  ///< at least the first and the last state
  SimulationSummary summary;
};

/// Runs the closed loop from a state right after the impact (or any other state).
///
/// @param resistance its rotor inertia stays in plant and controller; servo and locks ended with
/// the impact
/// @throws InputError when sizes or options make no sense.
[[nodiscard]] SimulationResult simulate_post_impact(const RobotModel& robot,
                                                    const JointResistance& resistance,
                                                    const PlantState& initial,
                                                    const Controller& controller,
                                                    const SimulationOptions& options);

/// What simulate_post_impact() takes beside the controller.
struct PostImpactRun {
  RobotModel robot;
  JointResistance resistance;
  PlantState initial;
  SimulationOptions options;
};

/// simulate_post_impact() of each run, in their order. Neighbours in the list that differ in
/// masses, hands, states and seeds alone are simulated side by side in the processor's registers;
/// their numbers then differ from those of single runs by rounding.
///
/// Single ones are runs with continuous control, adaptive steps or samples within the horizon; with
/// friction, thrusters, a base wrench or a controller that uses the wheels; with joint_stops off or
/// ends_at_stop; and of robots with no joint or more than 16 joints or bodies. A run that meets a
/// joint stop goes on as a single one.
///
/// What becomes of a run does not depend on its neighbours, unless a stop is reached.
/// @throws InputError when sizes or options make no sense.
[[nodiscard]] std::vector<SimulationResult> simulate_post_impacts(
    const std::vector<PostImpactRun>& runs, const Controller& controller);

/// How many of `count` runs one thread of several takes at once: all of them are busy, and none has
/// more than this processor simulates side by side. At least one.
int size_of_group(int count, int threads);

/// Runs the controller for `lead_time`, applies the impulse, and runs on for options.horizon: the
/// paper's Figs. 6 to 8 (from rest, impact at 0.1 s). The trace shows the impact as two samples at
/// the same time; the summary is that of the time after the impact.
/// @param Fbar impulse [f; t] at the hand in B, N s, N m s
[[nodiscard]] SimulationResult simulate_impact(const RobotModel& robot,
                                               const JointResistance& resistance,
                                               const PlantState& before, const Vector6d& Fbar,
                                               double lead_time, const Controller& controller,
                                               const SimulationOptions& options);

/// The trace as CSV text, one line per sample, units in the column names. Numbers read back
/// exactly.
std::string trace_csv(const RobotModel& robot, const std::vector<TraceSample>& trace);

}  // namespace stillbase
