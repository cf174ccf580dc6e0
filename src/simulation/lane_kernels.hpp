// Steps of several simulated robots at once, each in a lane of wide registers chosen at run time.
//
// Kernels for wide registers share no inline functions on doubles with other files, so they take
// columns of plain numbers, with number i of lane l at [i * lanes + l], and constants that they
// would have to make.
#pragma once

#include <vector>

#include <stillbase/simulation/controllers.hpp>

namespace stillbase {

/// Robots with the same joints; their mass properties and hands may differ.
struct LaneRobots {
  const RobotModel* pattern = nullptr;  ///< any of them
  const double* bodies = nullptr;       ///< base first, kBodyNumbers each
  const double* hand = nullptr;         ///< position (3), axes (9, by columns)
};
inline constexpr int kBodyNumbers = 13;  ///< mass, centroid (3), inertia (9)
inline constexpr int kHandNumbers = 12;
/// A held target: mass, inertia (9), its frame in that of the hand: position (3), axes (9).
inline constexpr int kHeldNumbers = 22;

/// Where the numbers of an Observation are in a column.
struct ObservationOffset {
  static constexpr int base = 0;          ///< momentum (3)
  static constexpr int coupling = 3;      ///< (3)
  static constexpr int P = 6;             ///< (3)
  static constexpr int energy = 9;        ///< kinetic
  static constexpr int inertia = 10;      ///< trace of Htilde_omega
  static constexpr int seen = 11;         ///< momentum_in_deviations()
  static constexpr int rank = 12;         ///< under control in the reaction null space
  static constexpr int unreachable = 13;  ///< (3), the same
  static constexpr int grip = 16;         ///< wrench on the held target (6)
  static constexpr int count = 22;
};

/// One step. States are [position (3), quaternion xyzw (4), phi (n), Omega (6), phidot (n)].
struct LaneStep {
  LaneRobots plant;
  LaneRobots known;  ///< by the controller; without pattern: the plant
  const Controller* controller = nullptr;
  const SensorSpec* sensors = nullptr;          ///< null: exact
  const JointVectord* rotor_inertia = nullptr;  ///< n
  const JointVectord* nothing_added = nullptr;  ///< n zeros
  const std::vector<bool>* none_locked = nullptr;
  bool torque_limits = true, rate_limits = true;
  const double* wheel_momentum = nullptr;  ///< 3
  const double* held = nullptr;            ///< null: no target is held
  bool commands = false;                   ///< a control instant; else the torques are held
  const double* measured = nullptr;        ///< states as measured; with `known` alone
  bool is_midpoint = false;                ///< else Runge and Kutta's method
  double h = 0;                            ///< s; 0: the states are only observed
  double* state = nullptr;
  double* tau = nullptr;       ///< n; held torques after limits
  double* demanded = nullptr;  ///< n; before limits
  double* observed = nullptr;  ///< of the states before the step
};

struct LaneKernel {
  int lanes;
  int max_joints;       ///< and bodies
  bool (*runs_here)();  ///< on this processor
  void (*advance)(const LaneStep& step);
};

/// Null where the compiler has no such registers.
const LaneKernel* lane_kernel_avx512();
const LaneKernel* lane_kernel_avx2();
const LaneKernel* lane_kernel_two_lanes();  ///< any machine

}  // namespace stillbase
