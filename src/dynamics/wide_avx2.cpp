#ifdef __AVX2__
#include "dynamics/wide_gradient.hpp"
#include "dynamics/wide_jump.hpp"
#include "dynamics/wide_motion.hpp"
#else
#include "dynamics/wide_kernel.hpp"
#endif

namespace stillbase {

const WideKernel* wide_kernel_avx2() {
#ifdef __AVX2__
  static constinit const WideKernel kernel = {
      [] { return __builtin_cpu_supports("avx2") != 0 && __builtin_cpu_supports("fma") != 0; },
      wide_kinematics,
      wide_bias,
      wide_inertia,
      wide_jump,
      wide_motion,
      wide_motion_gradient,
      wide_rotation_gradient};
  return &kernel;
#else
  return nullptr;
#endif
}

}  // namespace stillbase
