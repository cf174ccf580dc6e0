// A batch kernel of N lanes, with the registers that this source file is compiled for.
#pragma once

#include "core/pack.hpp"
#include "dynamics/inertia_kernel.hpp"
#include "dynamics/kinematics_kernel.hpp"
#include "impact/batch_run.hpp"
#include "impact/contact_response_kernel.hpp"
#include "impact/direction_squares_kernel.hpp"
#include "impact/gradient_kernel.hpp"
#include "impact/jump_kernel.hpp"

namespace stillbase {

/// @tparam P pack type, which carries the instruction set in its name
template <class P>
constexpr BatchKernel pack_kernel(bool (*runs_here)()) {
  const auto run = [](const RobotModel& robot, const ImpactResistance& resistance,
                      const BatchColumns& columns) {
    run_batch<P>(robot, resistance, columns, P::kLanes);
  };
  const auto null_velocities = [](const RobotModel& robot, const std::vector<Eigen::Index>& free,
                                  const NullVelocityColumns& columns) {
    find_null_velocities<P>(robot, free, columns, P::kLanes);
  };
  const auto sin_cos = [](const double* x, double* sine, double* cosine) {
    P s, c;
    sin_and_cos(P::load(x), s, c);
    s.store(sine);
    c.store(cosine);
  };
  return {P::kLanes,       kMaxJointsOf<P>,          runs_here, run,
          null_velocities, run_direction_squares<P>, sin_cos};
}

}  // namespace stillbase
