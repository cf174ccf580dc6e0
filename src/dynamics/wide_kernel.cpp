#include "dynamics/wide_kernel.hpp"

namespace stillbase {

const WideKernel* wide_passes(const RobotModel& robot) {
  static const WideKernel* const kernel = [] {
    for (const WideKernel* wide : {wide_kernel_avx512(), wide_kernel_avx2()}) {
      if (wide != nullptr && wide->runs_here()) return wide;
    }
    return static_cast<const WideKernel*>(nullptr);
  }();
  return robot.num_bodies() > 0 ? kernel : nullptr;
}

const WideKernel* wide_kernel(const RobotModel& robot) {
  const bool fits = robot.num_bodies() <= kWideBodies && !robot.is_coupled();
  return fits ? wide_passes(robot) : nullptr;
}

}  // namespace stillbase
