#include "dynamics/wide_kernel.hpp"

namespace stillbase {

const WideKernel* wide_kernel(const RobotModel& robot) {
  static const WideKernel* const kernel = [] {
    const WideKernel* wide = wide_kernel_avx2();
    return wide != nullptr && wide->runs_here() ? wide : nullptr;
  }();
  const bool fits = robot.num_bodies() > 0 && robot.num_bodies() <= kWideBodies;
  return fits ? kernel : nullptr;
}

}  // namespace stillbase
