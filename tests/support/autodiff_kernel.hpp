// The kernel's own lines, instantiated on a forward-mode automatic differentiation number, as an
// oracle for the analytic derivatives.
#pragma once

#include <unsupported/Eigen/AutoDiff>

#include <stillbase/core/types.hpp>

#include "dynamics/bias_kernel.hpp"
#include "dynamics/inertia_kernel.hpp"
#include "dynamics/kinematics_kernel.hpp"
#include "dynamics/momentum_kernel.hpp"
#include "impact/gradient_kernel.hpp"
#include "impact/jump_kernel.hpp"

namespace stillbase {

/// Number with its derivatives.
using Dual = Eigen::AutoDiffScalar<Eigen::VectorXd>;

/// phi as independent variables: derivative k of entry k is one.
inline JointVector<Dual> independent(const JointVectord& phi) {
  JointVector<Dual> out(phi.size());
  for (Eigen::Index k = 0; k < phi.size(); ++k) {
    out[k] = Dual(phi[k], static_cast<int>(phi.size()), static_cast<int>(k));
  }
  return out;
}

}  // namespace stillbase
