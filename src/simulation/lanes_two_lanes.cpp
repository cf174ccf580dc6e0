// The lane kernel for any machine.
#include "simulation/lane_step.hpp"

namespace stillbase {

const LaneKernel* lane_kernel_two_lanes() {
  static constinit const LaneKernel kernel = lane_kernel<Pack<2>>([] { return true; });
  return &kernel;
}

}  // namespace stillbase
