#ifdef __AVX512F__
#include "core/sines_packs.hpp"
#else
#include "core/sines.hpp"
#endif

namespace stillbase {

const SinesKernel* sines_kernel_avx512() {
#ifdef __AVX512F__
  static constinit const SinesKernel kernel = {[] {
                                                 return __builtin_cpu_supports("avx512f") != 0 &&
                                                        __builtin_cpu_supports("avx512dq") != 0;
                                               },
                                               sines_and_cosines_in_packs<Pack<kSinesAtOnce>>};
  return &kernel;
#else
  return nullptr;
#endif
}

}  // namespace stillbase
