#include "core/sines_packs.hpp"

namespace stillbase {

const SinesKernel* sines_kernel_any_machine() {
  static constinit const SinesKernel kernel = {[] { return true; },
                                               sines_and_cosines_in_packs<Pack<2>>};
  return &kernel;
}

}  // namespace stillbase
