#include "impact/batch_packs.hpp"

namespace stillbase {

const BatchKernel* batch_kernel_two_lanes() {
  static constinit const BatchKernel kernel = pack_kernel<Pack<2>>([] { return true; });
  return &kernel;
}

}  // namespace stillbase
