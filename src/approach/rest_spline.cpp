#include "approach/rest_spline.hpp"

#include <algorithm>

#include <stillbase/core/linear_algebra.hpp>

namespace stillbase {

// With the points c_-1 .. c_(L+1), rest and place at u = 0 ask for c_-1 = c_1 and
// c_0 = 3/2 start - c_1 / 2; at u = 1 alike. The points c_1 .. c_(L-1) are left.
RestSpline::Weights RestSpline::weights(double u, int derivative) const {
  const int last = intervals_;
  const double t = u * last;
  const int i = std::clamp(static_cast<int>(t), 0, last - 1);
  const double s = t - i, r = 1 - s;
  double b[4];
  if (derivative == 0) {
    b[0] = r * r * r / 6;
    b[1] = (4 + s * s * (3 * s - 6)) / 6;
    b[2] = (4 + r * r * (3 * r - 6)) / 6;
    b[3] = s * s * s / 6;
  } else if (derivative == 1) {
    b[0] = -r * r / 2 * last;
    b[1] = s * (3 * s - 4) / 2 * last;
    b[2] = -r * (3 * r - 4) / 2 * last;
    b[3] = s * s / 2 * last;
  } else {
    const double scale = static_cast<double>(last) * last;
    b[0] = r * scale;
    b[1] = (3 * s - 2) * scale;
    b[2] = (3 * r - 2) * scale;
    b[3] = s * scale;
  }
  Weights out;
  out.points = Eigen::VectorXd::Zero(points());
  for (int k = 0; k < 4; ++k) {
    const int j = i - 1 + k;  // number of the point
    if (j == -1) {
      out.points[0] += b[k];
    } else if (j == 0) {
      out.start += 1.5 * b[k];
      out.points[0] -= 0.5 * b[k];
    } else if (j == last) {
      out.end += 1.5 * b[k];
      out.points[last - 2] -= 0.5 * b[k];
    } else if (j == last + 1) {
      out.points[last - 2] += b[k];
    } else {
      out.points[j - 1] += b[k];
    }
  }
  return out;
}

Eigen::MatrixXd RestSpline::fitted(const JointPath& path) const {
  const int count = 4 * intervals_;
  const double begin = path.times.front(), duration = path.times.back() - begin;
  Eigen::MatrixXd A(count - 1, points()), B(count - 1, start_.size());
  std::size_t segment = 0;
  for (int j = 1; j < count; ++j) {
    const double t = begin + duration * j / count;
    while (segment + 2 < path.times.size() && path.times[segment + 1] < t) ++segment;
    const Weights weight = weights(static_cast<double>(j) / count, 0);
    A.row(j - 1) = weight.points.transpose();
    B.row(j - 1) =
        (motion_on_segment(path, segment, t).phi - weight.start * start_ - weight.end * end_)
            .transpose();
  }
  return PivotedQr(A).solve_columns(B).transpose();
}

JointPath RestSpline::motion(const Eigen::MatrixXd& points, double duration, int parts) const {
  JointPath path;
  const int count = parts * intervals_;
  for (int j = 0; j <= count; ++j) {
    const double u = static_cast<double>(j) / count;
    path.times.push_back(u * duration);
    path.phi.push_back(at(weights(u, 0), points));
    path.phidot.push_back(at(weights(u, 1), points) / duration);
  }
  path.phi.front() = start_;
  path.phi.back() = end_;
  path.phidot.front().setZero();
  path.phidot.back().setZero();
  return path;
}

}  // namespace stillbase
