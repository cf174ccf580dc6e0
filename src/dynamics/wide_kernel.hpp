// The dynamics of a robot on doubles, with vectors of three numbers in wide registers.
//
// A single posture keeps a processor waiting: each rotation takes the one before. With a vector per
// instruction there is a third of them. Other processors take the templates, whose sums have
// another order: results differ by rounding. What this header names takes plain numbers: the source
// file for wide registers shares no inline function on doubles with the rest of the program.
#pragma once

#include <stillbase/robot/robot_model.hpp>

namespace stillbase {

/// Robots with more bodies have no wide kernel.
inline constexpr int kWideBodies = kJointsInPlace<double>;

/// Where compute_kinematics() writes: 9 numbers per body, column by column, 3 and 3.
struct WidePoses {
  double *R, *o, *c;
};

/// Of the joint of each body.
struct WideJoints {
  const double *positions, *sine, *cosine;
};

/// Poses that are known.
struct KnownWidePoses {
  const double *R, *o, *c;
};

/// Where compute_inertia() writes.
struct WideInertia {
  double* I;        ///< 9 per body
  double* subtree;  ///< 13 per body: m, h, I
  double* H_bphi;   ///< 6 n
  double* H_phi;    ///< n n
  double* total;    ///< 13: m, h, I of the whole robot
};

struct KnownWideMotion {
  const double *Omega, *phidot;
};

/// Where compute_jump() writes.
struct WideMotion {
  double *Omega, *phidot;
};

/// Where compute_bias() writes.
struct WideBias {
  double *c_b, *c_phi;
};

/// Of robots with 1 to kWideBodies bodies.
struct WideKernel {
  bool (*runs_here)();  ///< on this processor
  void (*kinematics)(const RobotModel& robot, const WideJoints& at, const WidePoses& out);
  // Without couplings.
  void (*inertia)(const RobotModel& robot, const KnownWidePoses& poses, const WideInertia& out);
  /// @param I 9 per body
  void (*bias)(const RobotModel& robot, const KnownWidePoses& poses, const double* I,
               const KnownWideMotion& motion, const WideBias& out);
  /// @param added_inertia of each joint
  void (*jump)(const RobotModel& robot, const WideJoints& at, const double* added_inertia,
               const double* F, const WideMotion& out);
};

/// Null where the compiler has no such registers.
const WideKernel* wide_kernel_avx2();

/// Null where the processor has no such registers or the robot has too many bodies, or none.
const WideKernel* wide_kernel(const RobotModel& robot);

}  // namespace stillbase
