#include "collision/convex_gap.hpp"

#include <algorithm>
#include <cmath>

namespace stillbase {

namespace {

/// The point furthest along d of what is left of a shape without its rounding, in its frame.
struct Support {
  Vector3d d;
  double sign(int i) const { return d[i] < 0 ? -1 : 1; }
  Vector3d operator()(const Sphere&) const { return Vector3d::Zero(); }
  Vector3d operator()(const Capsule& c) const { return {0, 0, sign(2) * c.length / 2}; }
  Vector3d operator()(const Cylinder& c) const {
    Vector3d out(0, 0, sign(2) * c.length / 2);
    const double across = d.head<2>().norm();
    if (across > 0) out.head<2>() = d.head<2>() * (c.radius / across);
    return out;
  }
  Vector3d operator()(const Box& b) const {
    return Vector3d(sign(0), sign(1), sign(2)).cwiseProduct(b.size) / 2;
  }
  Vector3d operator()(const ConvexMesh& m) const {
    return *std::max_element(
        m.vertices.begin(), m.vertices.end(),
        [this](const Vector3d& x, const Vector3d& y) { return d.dot(x) < d.dot(y); });
  }
};

struct Rounding {
  double operator()(const Sphere& s) const { return s.radius; }
  double operator()(const Capsule& c) const { return c.radius; }
  template <class Sharp>
  double operator()(const Sharp&) const {
    return 0;
  }
};

Vector3d support(const PlacedGeometry& shape, const Vector3d& d) {
  return shape.R * std::visit(Support{shape.R.transpose() * d}, shape.geometry) + shape.p;
}

double rounding(const PlacedGeometry& a, const PlacedGeometry& b) {
  return std::visit(Rounding{}, a.geometry) + std::visit(Rounding{}, b.geometry);
}

/// Up to five points and their weights, of which the mean is the nearest point so far.
struct Corral {
  Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::ColMajor, 3, 5> points;
  Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, 5, 1> weights;

  Eigen::Index size() const { return points.cols(); }
  Vector3d mean() const { return points * weights; }
  void add(const Vector3d& w) {
    points.conservativeResize(3, size() + 1);
    weights.conservativeResize(size());
    points.col(size() - 1) = w;
    weights[size() - 1] = size() == 1 ? 1 : 0;
  }
  void remove(Eigen::Index i) {
    const Eigen::Index after = size() - 1 - i;
    points.middleCols(i, after) = points.rightCols(after).eval();
    weights.segment(i, after) = weights.tail(after).eval();
    points.conservativeResize(3, size() - 1);
    weights.conservativeResize(size());
  }
  /// Weights, of sum one, of the point nearest to the origin on the flat through the points.
  auto flat_weights() const {
    decltype(weights) out(size());
    out[0] = 1;
    if (size() == 1) return out;
    const Eigen::Index edges = size() - 1;
    const Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::ColMajor, 3, 4> E =
        points.rightCols(edges).colwise() - points.col(0);
    out.tail(edges) = E.colPivHouseholderQr().solve(-points.col(0));
    out[0] = 1 - out.tail(edges).sum();
    return out;
  }
  /// Moves to the nearest point of the points' hull and drops those without a weight there.
  void reduce() {
    constexpr double kNone = 1e-14;
    while (true) {
      const auto wanted = flat_weights();
      double part = 1;
      for (Eigen::Index i = 0; i < size(); ++i) {
        if (wanted[i] <= kNone) part = std::min(part, weights[i] / (weights[i] - wanted[i]));
      }
      if (!(part < 1)) {
        weights = wanted;
        return;
      }
      weights += part * (wanted - weights);
      for (Eigen::Index i = size() - 1; i >= 0; --i) {
        if (weights[i] <= kNone && size() > 1) remove(i);
      }
      weights /= weights.sum();
      if (size() == 1) return;
    }
  }
};

}  // namespace

double gap_along(const PlacedGeometry& a, const PlacedGeometry& b, const Vector3d& n) {
  return n.dot(support(a, -n) - support(b, n)) - rounding(a, b);
}

double convex_gap(const PlacedGeometry& a, const PlacedGeometry& b, const Vector3d& from) {
  constexpr int kSteps = 100;      // meshes take ten, rims of cylinders some more
  constexpr double kGap = 1e-7;    // m, between what is found and what is proven
  constexpr double kZero = 1e-12;  // m
  Corral corral;
  corral.add(support(a, -from) - support(b, from));
  double proven = -kInfinity;
  for (int step = 0; step < kSteps; ++step) {
    const Vector3d x = corral.mean();
    const double found = x.norm();
    if (found < kZero) return 0;
    const Vector3d w = support(a, -x) - support(b, x);
    proven = std::max(proven, x.dot(w) / found);
    if (found - proven <= kGap) return found - rounding(a, b);
    const bool is_known = ((corral.points.colwise() - w).colwise().norm().array() < kZero).any();
    if (is_known || corral.size() > 4) break;
    corral.add(w);
    corral.reduce();
  }
  return std::max(proven, 0.0) - rounding(a, b);
}

}  // namespace stillbase
