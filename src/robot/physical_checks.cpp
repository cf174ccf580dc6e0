#include <fmt/format.h>

#include <cmath>

#include <stillbase/core/linear_algebra.hpp>
#include <stillbase/robot/physical_checks.hpp>

namespace stillbase {

std::string inertia_fault(const Matrix3d& inertia) {
  if (!inertia.allFinite()) return "the inertia tensor is not finite";
  if ((inertia - inertia.transpose()).cwiseAbs().maxCoeff() >
      1e-12 * inertia.cwiseAbs().maxCoeff()) {
    return "the inertia tensor is not symmetric";
  }
  const Vector3d moments = principal_moments(inertia);
  const std::string principal = fmt::format("principal moments {:.6g}, {:.6g}, {:.6g} kg m^2",
                                            moments[0], moments[1], moments[2]);
  // Below 1e-12 of the largest a moment is rounding, not a number of the file.
  if (!(moments[0] > 1e-12 * std::abs(moments[2]))) {
    return fmt::format("the inertia tensor is not positive definite: {}", principal);
  }
  const double sum = moments[0] + moments[1];
  if (moments[2] > sum * (1 + 1e-5)) {
    return fmt::format(
        "the inertia tensor breaks the triangle inequality ({:.6g} + {:.6g} < {:.6g}): {}",
        moments[0], moments[1], moments[2], principal);
  }
  return "";
}

std::string mass_fault(double mass) {
  if (std::isfinite(mass) && mass > 0) return "";
  return fmt::format("the mass is {:g} kg, must be greater than 0", mass);
}

}  // namespace stillbase
