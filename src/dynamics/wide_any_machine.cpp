#include "dynamics/wide_vectors.hpp"

namespace stillbase {

const WideKernel* wide_kernel_any_machine() {
  static constinit const WideKernel kernel = {[] { return true; }, wide_kinematics, wide_inertia};
  return &kernel;
}

}  // namespace stillbase
