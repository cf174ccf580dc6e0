// Watches a run: extremes, limits, trace.
#pragma once

#include <stillbase/simulation/simulate.hpp>

namespace stillbase {

class Recorder {
 public:
  /// @param options of the run; enforced stops are reported by stop_reached(), and the errors of
  /// the controller's sensors keep what rests from resting more exactly
  Recorder(const RobotModel& robot, const Controller& controller, const SimulationOptions& options);

  /// The next observed state goes into the trace.
  void record_next() { record_now_ = true; }
  /// A step begins: state, terms of (3), command after limits and joint torques before them.
  void observe(double t, const PlantState& state, const PlantTerms& terms,
               const ControlCommand& command, const JointVectord& demanded, bool saturated);
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
  void start(const PlantState& state, const PlantTerms& terms, const Momentum<double>& momentum);
  void watch_momentum(const PlantState& state, const Momentum<double>& momentum);
  void watch_lost_momentum(const PlantTerms& terms, const Momentum<double>& momentum);
  void watch_rest(double t, const PlantState& state, const PlantTerms& terms,
                  const Momentum<double>& momentum);
  void watch_loads(double t, const PlantState& state, const ControlCommand& command,
                   const JointVectord& demanded);
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
