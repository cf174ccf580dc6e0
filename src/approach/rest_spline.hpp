// Smooth motions from rest to rest with few unknowns.
#pragma once

#include "approach/joint_path.hpp"

namespace stillbase {

/// Uniform cubic B-splines over u in [0, 1]: phi(u) = first + sum_k W_k(u) c_k, from `start` to
/// `end` with phi' = 0 at both ends. Path and time law in one: with u = t / T the control points
/// shape both. Between two knots the acceleration is linear in u, so that it is largest at knots.
class RestSpline {
 public:
  /// @param intervals between knots, >= 4
  RestSpline(const JointVectord& start, const JointVectord& end, int intervals)
      : start_(start), end_(end), intervals_(intervals) {}

  int intervals() const { return intervals_; }
  int points() const { return intervals_ - 1; }

  /// What multiplies start, end and control points (K) in phi, phi' or phi'' with respect to u.
  struct Weights {
    double start = 0, end = 0;
    Eigen::VectorXd points;
  };
  /// @param derivative 0, 1 or 2
  Weights weights(double u, int derivative) const;

  /// phi or a derivative with respect to u (n). @param points n x K
  JointVectord at(const Weights& weights, const Eigen::MatrixXd& points) const {
    return weights.start * start_ + weights.end * end_ + points * weights.points;
  }

  /// Control points (n x K) nearest to a motion from start to end, in the mean of squares.
  Eigen::MatrixXd fitted(const JointPath& path) const;

  /// The motion of duration T from time 0 on, `parts` samples per interval; exact.
  JointPath motion(const Eigen::MatrixXd& points, double duration, int parts) const;

 private:
  JointVectord start_, end_;
  int intervals_;
};

}  // namespace stillbase
