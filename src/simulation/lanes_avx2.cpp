// The lane kernel for registers of four doubles.
#ifdef __AVX2__
#include "simulation/lane_step.hpp"
#else
#include "simulation/lane_kernels.hpp"
#endif

namespace stillbase {

const LaneKernel* lane_kernel_avx2() {
#ifdef __AVX2__
  static constinit const LaneKernel kernel = lane_kernel<Pack<4>>(
      [] { return __builtin_cpu_supports("avx2") != 0 && __builtin_cpu_supports("fma") != 0; });
  return &kernel;
#else
  return nullptr;
#endif
}

}  // namespace stillbase
