#include "dynamics/wide_kernel.hpp"

namespace stillbase {

const WideKernel* wide_passes(const RobotModel& robot) {
  static const WideKernel* const kernel = [] {
    const WideKernel* wide = wide_kernel_avx2();
    return wide != nullptr && wide->runs_here() ? wide : nullptr;
  }();
  return robot.num_bodies() > 0 ? kernel : nullptr;
}

const WideKernel* wide_kernel(const RobotModel& robot) {
  return robot.num_bodies() <= kWideBodies ? wide_passes(robot) : nullptr;
}

}  // namespace stillbase
