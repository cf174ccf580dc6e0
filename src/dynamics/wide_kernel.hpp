// The dynamics of a robot on doubles, with vectors of three numbers in wide registers.
//
// A single posture keeps a processor waiting: each rotation takes the one before. With a vector per
// instruction there is a third of them. Other processors take the templates, whose sums have
// another order: results differ by rounding. What this header names takes plain numbers: the source
// file for wide registers shares no inline function on doubles with the rest of the program.
#pragma once

#include <stillbase/robot/robot_model.hpp>

namespace stillbase {

/// Robots with more bodies have no matrices in wide registers, but poses and bias forces.
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

/// Where a jump of the rates is written, or the accelerations.
struct WideMotion {
  double *Omega, *phidot;
};

/// What acts on the base, [force; moment] about its centroid, and at the joints.
struct WideLoad {
  const double *F_b, *tau;
};

/// Rates and accelerations of the joints.
struct WideJointMotion {
  const double *phidot, *phiddot;
};

/// Where compute_bias() writes.
struct WideBias {
  double *c_b, *c_phi;
};

/// A motion, and the impulse [force; moment about the hand's origin] on the hand.
struct WideLoadedMotion {
  const double *Omega, *phidot, *F;
};

/// Where the impulses of two motions act, and their moment on each other's motion.
struct WideHandLoads {
  const double *r_bh, *moment;
};

/// Two rotations u and w of the whole robot about its centroid.
struct WideRotations {
  const double *r_bg, *u, *w;
};

/// Only `kinematics` takes coupled robots; from `inertia` on there are at most kWideBodies bodies.
struct WideKernel {
  bool (*runs_here)();  ///< on this processor
  void (*kinematics)(const RobotModel& robot, const WideJoints& at, const WidePoses& out);
  /// @param I 9 per body
  void (*bias)(const RobotModel& robot, const KnownWidePoses& poses, const double* I,
               const KnownWideMotion& motion, const WideBias& out);
  void (*inertia)(const RobotModel& robot, const KnownWidePoses& poses, const WideInertia& out);
  /// @param added_inertia of each joint
  void (*jump)(const RobotModel& robot, const WideJoints& at, const double* added_inertia,
               const double* F, const WideMotion& out);
  void (*motion)(const RobotModel& robot, const WideJoints& at, const double* added_inertia,
                 const KnownWideMotion& now, const WideLoad& load, const WideMotion& out);
  // See free_base.hpp; what is written does not overlap what is read.
  void (*base_velocity)(const RobotModel& robot, const WideJoints& at, const double* phidot,
                        double* Omega);
  void (*torques)(const RobotModel& robot, const WideJoints& at, const WideJointMotion& motion,
                  bool base_moves, double* tau);
  // Both add to the gradient (n).
  /// @param I 9 per body
  void (*motion_gradient)(const RobotModel& robot, const KnownWidePoses& poses, const double* I,
                          const WideHandLoads& hand, const WideLoadedMotion& a,
                          const WideLoadedMotion& b, double* gradient);
  /// @param subtrees 13 per body, as WideInertia
  void (*rotation_gradient)(const RobotModel& robot, const KnownWidePoses& poses,
                            const double* subtrees, const WideRotations& rotations,
                            double* gradient);
};

// Null where the compiler has no such registers.
const WideKernel* wide_kernel_avx2();
const WideKernel* wide_kernel_avx512();

/// Null where the processor has no such registers, the robot has too many bodies, or none, or is
/// coupled.
const WideKernel* wide_kernel(const RobotModel& robot);
/// The same for poses and bias forces, however many bodies, coupled or not.
const WideKernel* wide_passes(const RobotModel& robot);

}  // namespace stillbase
