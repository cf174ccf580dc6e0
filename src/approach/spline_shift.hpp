// Smooth shifts of a joint path that leave its ends alone.
#pragma once

#include "approach/joint_path.hpp"

namespace stillbase {

/// Values of the B-splines at u in [0, 1] and their derivatives with respect to u (K each).
struct SplineBasis {
  Eigen::VectorXd value, first, second;
};
SplineBasis spline_basis(double u, int count);

/// The path shifted by control points (n x K) over its time of motion.
JointPath spline_shifted(const JointPath& path, const Eigen::MatrixXd& control_points);

}  // namespace stillbase
