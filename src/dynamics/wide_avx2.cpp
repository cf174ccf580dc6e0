#ifdef __AVX2__
#include "dynamics/wide_functions.hpp"
#else
#include "dynamics/wide_kernel.hpp"
#endif

namespace stillbase {

const WideKernel* wide_kernel_avx2() {
#ifdef __AVX2__
  static constinit const WideKernel kernel = wide_functions(
      [] { return __builtin_cpu_supports("avx2") != 0 && __builtin_cpu_supports("fma") != 0; });
  return &kernel;
#else
  return nullptr;
#endif
}

}  // namespace stillbase
