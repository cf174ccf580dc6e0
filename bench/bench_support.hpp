// What the benchmark's source files share: the robot, a sequence of postures, and the measuring
// loop.
#pragma once

#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include <stillbase/core/random.hpp>
#include <stillbase/robot/robot_model.hpp>
#include <stillbase/simulation/plant.hpp>

namespace stillbase {

/// The seven-joint arm of problems/robots/iiwa_on_cube.urdf.
const RobotModel& robot();

/// Calls of malloc so far, or -1 when they are not counted.
long allocations_so_far();

/// Postures one after the other, so that neither branches nor values can be predicted.
class Postures {
 public:
  explicit Postures(int n = robot().n()) {
    Random random(1);
    for (int i = 0; i < 64; ++i) {
      JointVectord phi(n);
      for (double& angle : phi) angle = random.uniform(-2, 2);
      postures_.push_back(phi);
    }
  }
  const JointVectord& next() { return postures_[++i_ % postures_.size()]; }

 private:
  std::vector<JointVectord> postures_;
  std::size_t i_ = 0;
};

/// Runs f over and over; reports the allocations of a call beside its time.
template <class F>
void measure(benchmark::State& state, const F& f) {
  f();  // whatever is set up once
  const long before = allocations_so_far();
  long calls = 0;
  for (auto _ : state) {
    f();
    ++calls;
  }
  if (before >= 0 && calls > 0) {
    state.counters["allocations"] =
        static_cast<double>(allocations_so_far() - before) / static_cast<double>(calls);
  }
}

inline Vector6d wrench() {
  Vector6d F;
  F << 0.48, 0.6, 0.64, 0, 0, 0;
  return F;
}

inline JointVectord joint_rates() { return JointVectord::LinSpaced(robot().n(), -0.5, 0.5); }

/// The arm in motion, the base at the origin and parallel to N: where steps and runs begin.
PlantState moving_arm();

inline constexpr double kStep = 0.001;  ///< s

/// Another library's answers for the robot, against which the benchmark holds ours before it
/// compares times. Base at the origin, parallel to N; its twist is [v; omega].
struct PeerAnswers {
  Eigen::MatrixXd H;             ///< (6+n) x (6+n)
  Eigen::VectorXd jump;          ///< 6+n, of wrench() at the hand
  Eigen::VectorXd acceleration;  ///< 6+n, at joint_rates(), base at rest, no torques
  /// Joint positions and rates and the base's angular velocity, one below the other, after a step
  /// of Runge and Kutta's classical method over kStep from moving_arm(), no torques; empty: not
  /// asked for.
  Eigen::VectorXd step = {};
};

/// Throws std::runtime_error when the peer's answers differ from ours.
void require_agreement(const std::string& peer, const JointVectord& phi,
                       const PeerAnswers& answers);

}  // namespace stillbase
