#include "core/sines.hpp"

#include <cassert>
#include <cfenv>
#include <initializer_list>

namespace stillbase {

void sines_and_cosines(const double* x, int n, double* sine, double* cosine) {
  assert(std::fegetround() == FE_TONEAREST);
  static const SinesKernel& widest = []() -> const SinesKernel& {
    for (const SinesKernel* kernel : {sines_kernel_avx512(), sines_kernel_avx2()}) {
      if (kernel != nullptr && kernel->runs_here()) return *kernel;
    }
    return *sines_kernel_any_machine();
  }();
  widest.run(x, n, sine, cosine);
}

}  // namespace stillbase
