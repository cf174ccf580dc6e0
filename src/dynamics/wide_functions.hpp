// The functions of a WideKernel, for the instruction set that the source file is compiled for.
#pragma once

#include "dynamics/wide_free_base.hpp"
#include "dynamics/wide_gradient.hpp"
#include "dynamics/wide_jump.hpp"
#include "dynamics/wide_motion.hpp"

namespace stillbase {

namespace {

constexpr WideKernel wide_functions(bool (*runs_here)()) {
  return {
      runs_here,   wide_kinematics,    wide_bias,    wide_inertia,         wide_jump,
      wide_motion, wide_base_velocity, wide_torques, wide_motion_gradient, wide_rotation_gradient};
}

}  // namespace

}  // namespace stillbase
