#ifdef __AVX2__
#include "core/sines_packs.hpp"
#else
#include "core/sines.hpp"
#endif

namespace stillbase {

const SinesKernel* sines_kernel_avx2() {
#ifdef __AVX2__
  static constinit const SinesKernel kernel = {[] { return __builtin_cpu_supports("avx2") != 0; },
                                               sines_and_cosines_in_packs<Pack<4>>};
  return &kernel;
#else
  return nullptr;
#endif
}

}  // namespace stillbase
