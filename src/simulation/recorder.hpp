// Watches a run: extremes, limits, trace.
#pragma once

#include "simulation/closed_loop.hpp"

namespace stillbase {

class Recorder final : public StepObserver {
 public:
  Recorder(const RobotModel& robot, const Controller& controller);

  /// The next observed state goes into the trace.
  void record_next() { record_now_ = true; }
  void observe(double t, const PlantState& state, const PlantTerms& terms, const JointVectord& tau,
               bool saturated) override;
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
  bool started_ = false;
  bool record_now_ = true;
  double t_ = 0;      ///< of the observation before
  PlantState state_;  ///< of the observation before
  Eigen::Quaterniond first_attitude_;
  Vector3d first_P_N_, first_L_N_;
  double P_scale_ = 0, L_scale_ = 0;
};

}  // namespace stillbase
