// The constraints of sequential quadratic programming, one side at a time.
#pragma once

#include <algorithm>
#include <cmath>

#include <stillbase/nlp/problem.hpp>

namespace stillbase::nlp {

/// A point with its values and derivatives.
struct SqpPoint {
  Eigen::VectorXd x;
  Evaluation at;
};

/// One side of a constraint: sign (g_index - bound) >= 0, or = 0.
struct Side {
  Eigen::Index index;
  double sign, bound;
  bool is_equation;
  bool may_have_kinks;
};

inline double room(const Side& side, const SqpPoint& point) {
  return side.sign * (point.at.constraints[side.index] - side.bound);
}

/// Gradient of the room.
inline Eigen::VectorXd normal(const Side& side, const SqpPoint& point) {
  return side.sign * point.at.jacobian.row(side.index).transpose();
}

inline double violation(const Side& side, double room) {
  return side.is_equation ? std::abs(room) : std::max(0.0, -room);
}

}  // namespace stillbase::nlp
