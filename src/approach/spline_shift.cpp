#include "approach/spline_shift.hpp"

namespace stillbase {

SplineBasis spline_basis(double u, int count) {
  SplineBasis basis{Eigen::VectorXd::Zero(count), Eigen::VectorXd::Zero(count),
                    Eigen::VectorXd::Zero(count)};
  const double pieces = count + 3;  // spline k lives on the pieces k, .., k + 3
  for (int k = 0; k < count; ++k) {
    const double s = u * pieces - k;
    if (s <= 0 || s >= 4) continue;
    const double t = s <= 2 ? s : 4 - s;  // symmetric about its middle
    const double side = s <= 2 ? 1 : -1;
    double value, first, second;
    if (t <= 1) {
      value = t * t * t / 6;
      first = t * t / 2;
      second = t;
    } else {
      const double r = t - 1;
      value = (1 + 3 * r * (1 + r * (1 - r))) / 6;
      first = (1 + r * (2 - 3 * r)) / 2;
      second = 1 - 3 * r;
    }
    basis.value[k] = value;
    basis.first[k] = side * first * pieces;
    basis.second[k] = second * pieces * pieces;
  }
  return basis;
}

JointPath spline_shifted(const JointPath& path, const Eigen::MatrixXd& control_points) {
  JointPath out = path;
  const double begin = path.times.front(), duration = path.times.back() - begin;
  const auto count = static_cast<int>(control_points.cols());
  for (std::size_t i = 1; i + 1 < path.times.size(); ++i) {
    const SplineBasis basis = spline_basis((path.times[i] - begin) / duration, count);
    out.phi[i] += control_points * basis.value;
    out.phidot[i] += control_points * basis.first / duration;
  }
  return out;
}

}  // namespace stillbase
