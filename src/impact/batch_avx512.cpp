#ifdef __AVX512F__
#include "impact/batch_packs.hpp"
#else
#include "impact/batch_kernels.hpp"
#endif

namespace stillbase {

const BatchKernel* batch_kernel_avx512() {
#ifdef __AVX512F__
  static constinit const BatchKernel kernel = pack_kernel<Pack<8>>([] {
    return __builtin_cpu_supports("avx512f") != 0 && __builtin_cpu_supports("avx512dq") != 0;
  });
  return &kernel;
#else
  return nullptr;
#endif
}

}  // namespace stillbase
