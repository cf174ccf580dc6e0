// Watches a run: extremes, limits, trace.
#pragma once

#include <stillbase/core/constants.hpp>
#include <stillbase/simulation/simulate.hpp>

namespace stillbase {

/// A run at the beginning of a step.
struct Observation {
  double time = 0;  ///< s
  const PlantState& state;
  const ControlCommand& command;  ///< after limits
  const JointVectord& demanded;   ///< joint torques before them, n
  bool saturated = false;         ///< a limit has cut them
  Momentum<double> momentum = {};
  double kinetic_energy = 0;                ///< J
  double mass = 0;                          ///< kg
  double central_inertia = 0;               ///< trace of Htilde_omega, kg m^2
  int rank = 3;                             ///< directions that the arm fully reaches
  Vector3d unreachable = Vector3d::Zero();  ///< momentum that it does not take over
  double momentum_seen = kInfinity;         ///< momentum_in_deviations(); of exact sensors infinite
  const PlantTerms* terms = nullptr;        ///< null: computed from the state where needed
};

/// What follows from the terms of (3).
void observe_terms(const Controller& controller, const SensorSpec& sensors, const PlantTerms& terms,
                   Observation& out);

class Recorder {
 public:
  /// @param options of the run; enforced stops are reported by stop_reached(), and the errors of
  /// the controller's sensors keep what rests from resting more exactly
  Recorder(const RobotModel& robot, const Controller& controller, const SimulationOptions& options);

  /// The next observed state goes into the trace.
  void record_next() { record_now_ = true; }
  /// A step begins.
  void observe(const Observation& now);
  /// Before observe(), in runs with a target.
  void observe_target(const TargetPlantState& target, const Vector3d& contact_force);
  /// Before observe(), in runs with a held target: the wrench on it at the hand, in B.
  void observe_grip(const Vector6d& wrench);
  /// A joint runs into an enforced stop with this rate.
  void stop_reached(double t, int joint, LimitKind kind, double rate);
  const SimulationSummary& so_far() const { return result_.summary; }
  /// Ends the run at the last observed state and hands over its result.
  SimulationResult take(SimulationStatus status, long steps);

 private:
  void start(const Observation& now);
  void watch_momentum(const Observation& now);
  void watch_lost_momentum(const Observation& now);
  void watch_rest(const Observation& now);
  void watch_loads(const Observation& now);
  void watch_limits(double t, const PlantState& state);
  void watch_stops(int k, double t, const PlantState& state);
  void note(int joint, LimitKind kind, double time);

  const RobotModel& robot_;
  const Controller& controller_;
  SimulationResult result_;
  const SimulationOptions& options_;
  bool started_ = false;
  bool record_now_ = true;
  double t_ = 0;      ///< of the observation before
  PlantState state_;  ///< of the observation before
  Eigen::Quaterniond first_attitude_;
  Vector3d first_P_N_, first_L_N_;
  double P_scale_ = 0, L_scale_ = 0;
  LoadTimes near_;  ///< of the observation before: 1 for each load near its limit, else 0
  std::optional<TargetPlantState> target_;
  Vector3d contact_force_ = Vector3d::Zero();
  Vector6d grip_wrench_ = Vector6d::Zero();
  bool touched_ = false;     ///< hand and target, at the observation before
  double rest_L_g_ = 0;      ///< |L_g| at the start or after the last contact, N m s
  double rest_L_scale_ = 0;  ///< largest |L_g| with the kinetic energy of that instant, N m s
  double peak_rate_ = 0;     ///< of any joint so far, rad/s (m/s)
};

}  // namespace stillbase
