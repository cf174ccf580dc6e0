// Steps of several simulated robots at once, each in a lane of wide registers chosen at run time.
//
// Plain numbers: kernels for wide registers share no inline functions on doubles with other files.
// Columns of numbers hold number i of lane l at [i * lanes + l].
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

/// What Observation has of each lane.
enum LaneObservation {
  kLaneBase = 0,      ///< momentum (3)
  kLaneCoupling = 3,  ///< (3)
  kLaneLinear = 6,    ///< P (3)
  kLaneEnergy = 9,
  kLaneInertia = 10,  ///< trace of Htilde_omega
  kLaneRank = 11,
  kLaneUnreachable = 12,  ///< (3)
  kLaneGrip = 15,         ///< wrench on the held target (6)
  kLaneObservations = 21
};

/// One step. States are [position (3), quaternion xyzw (4), phi (n), Omega (6), phidot (n)].
struct LaneStep {
  LaneRobots plant;
  LaneRobots known;  ///< by the controller; without pattern: the plant
  const Controller* controller = nullptr;
  const JointVectord* rotor_inertia = nullptr;  ///< n
  const JointVectord* nothing_added = nullptr;  ///< n zeros
  const std::vector<bool>* none_locked = nullptr;
  bool torque_limits = true, rate_limits = true;
  const double* wheel_momentum = nullptr;  ///< 3
  const double* held = nullptr;            ///< null: no target is held
  bool commands = false;                   ///< a control instant; else the torques are held
  const double* measured = nullptr;        ///< states as measured; null: exactly
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

}  // namespace stillbase
