// The lane kernel for registers of eight doubles.
#ifdef __AVX512F__
#include "simulation/lane_step.hpp"
#else
#include "simulation/lane_kernels.hpp"
#endif

namespace stillbase {

const LaneKernel* lane_kernel_avx512() {
#ifdef __AVX512F__
  static constinit const LaneKernel kernel = lane_kernel<Pack<8>>([] {
    return __builtin_cpu_supports("avx512f") != 0 && __builtin_cpu_supports("avx512dq") != 0;
  });
  return &kernel;
#else
  return nullptr;
#endif
}

}  // namespace stillbase
