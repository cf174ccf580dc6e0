// Watches a run: extremes, limits, trace.
#pragma once

#include "simulation/closed_loop.hpp"

namespace stillbase {

class Recorder final : public StepObserver {
 public:
  /// @param watch_stops false: enforced stops are told by stop_met()
  Recorder(const RobotModel& robot, const Controller& controller, bool watch_stops);

  /// The next observed state goes into the trace.
  void record_next() { record_now_ = true; }
  void observe(double t, const PlantState& state, const PlantTerms& terms,
               const ControlCommand& command, bool saturated) override;
  void observe_target(const TargetPlantState& target, const Vector3d& contact_force) override;
  void stop_met(double t, int joint, LimitKind kind, double rate) override;
  /// Ends the run: hands over what was seen, the last observed state being the end.
  SimulationResult take(SimulationStatus status, long steps);

 private:
  void start(const PlantState& state, const PlantTerms& terms, const Momentum<double>& momentum);
  void watch_momentum(const PlantState& state, const Momentum<double>& momentum);
  void watch_lost_momentum(const PlantTerms& terms, const Momentum<double>& momentum);
  void watch_limits(double t, const PlantState& state);
  void watch_stops(int k, double t, const PlantState& state);
  void note(int joint, LimitKind kind, double time);

  const RobotModel& robot_;
  const Controller& controller_;
  SimulationResult result_;
  bool watch_stops_;
  bool started_ = false;
  bool record_now_ = true;
  double t_ = 0;      ///< of the observation before
  PlantState state_;  ///< of the observation before
  Eigen::Quaterniond first_attitude_;
  Vector3d first_P_N_, first_L_N_;
  double P_scale_ = 0, L_scale_ = 0;
  std::optional<TargetPlantState> target_;
  Vector3d contact_force_ = Vector3d::Zero();
};

}  // namespace stillbase
