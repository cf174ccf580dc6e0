// Registers of four numbers again, but twice as many of them: few are spilled to the stack.
#ifdef __AVX512VL__
#include "dynamics/wide_functions.hpp"
#else
#include "dynamics/wide_kernel.hpp"
#endif

namespace stillbase {

const WideKernel* wide_kernel_avx512() {
#ifdef __AVX512VL__
  static constinit const WideKernel kernel = wide_functions([] {
    return __builtin_cpu_supports("avx512f") != 0 && __builtin_cpu_supports("avx512dq") != 0 &&
           __builtin_cpu_supports("avx512vl") != 0 && __builtin_cpu_supports("fma") != 0;
  });
  return &kernel;
#else
  return nullptr;
#endif
}

}  // namespace stillbase
