#ifdef __AVX2__
#include "impact/batch_packs.hpp"
#else
#include "impact/batch_kernels.hpp"
#endif

namespace stillbase {

const BatchKernel* batch_kernel_avx2() {
#ifdef __AVX2__
  static constinit const BatchKernel kernel = pack_kernel<Pack<4>>(
      [] { return __builtin_cpu_supports("avx2") != 0 && __builtin_cpu_supports("fma") != 0; });
  return &kernel;
#else
  return nullptr;
#endif
}

}  // namespace stillbase
