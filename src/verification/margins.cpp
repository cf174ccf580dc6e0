#include "verification/margins.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <fmt/format.h>

namespace stillbase::verification {
namespace {

constexpr int kTarget = -2;

double smallest_of_rank(const Eigen::MatrixXd& A) {
  const Eigen::VectorXd values = Eigen::BDCSVD<Eigen::MatrixXd>(A).singularValues();
  double smallest = values[0];
  for (const double value : values) {
    if (value > 1e-9 * values[0]) smallest = value;
  }
  return smallest;
}

/// Minimum of a convex function over [-1, 1]: golden section.
template <class Function>
double convex_minimum(const Function& f) {
  const double golden = (std::sqrt(5.0) - 1) / 2;
  double low = -1, high = 1;
  double a = high - golden * (high - low), b = low + golden * (high - low);
  double fa = f(a), fb = f(b);
  double best = std::min({f(low), f(high), fa, fb});
  for (int i = 0; i < 90; ++i) {
    if (fa <= fb) {
      high = b;
      b = a;
      fb = fa;
      a = high - golden * (high - low);
      fa = f(a);
    } else {
      low = a;
      a = b;
      fa = fb;
      b = low + golden * (high - low);
      fb = f(b);
    }
    best = std::min({best, fa, fb});
  }
  return best;
}

/// Half the length of the axis and the radius of what is round.
std::optional<std::pair<double, double>> round_of(const Geometry& geometry) {
  if (const auto* s = std::get_if<Sphere>(&geometry)) return std::pair{0.0, s->radius};
  if (const auto* c = std::get_if<Capsule>(&geometry)) return std::pair{c->length / 2, c->radius};
  if (const auto* c = std::get_if<Cylinder>(&geometry)) return std::pair{c->length / 2, c->radius};
  return std::nullopt;
}

double to_box(const Vector3d& point, const Vector3d& size) {
  Vector3d out;
  for (int i = 0; i < 3; ++i) out[i] = std::abs(point[i]) - size[i] / 2;
  if (out.maxCoeff() <= 0) return out.maxCoeff();
  for (double& x : out) x = std::max(x, 0.0);
  return out.norm();
}

double to_axis(const Vector3d& point, double half) {
  return std::hypot(point.x(), point.y(), std::max(std::abs(point.z()) - half, 0.0));
}

std::vector<Vector3d> corners(const Pose& pose, const Vector3d& size) {
  std::vector<Vector3d> out;
  for (int i = 0; i < 8; ++i) {
    const Vector3d signs(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1);
    out.push_back(pose * Vector3d(signs.cwiseProduct(size) / 2));
  }
  return out;
}

double widest_gap(const Pose& a, const Vector3d& a_size, const Pose& b, const Vector3d& b_size) {
  const Matrix3d A = a.orientation.toRotationMatrix(), B = b.orientation.toRotationMatrix();
  std::vector<Vector3d> axes;
  for (int i = 0; i < 3; ++i) {
    axes.push_back(A.col(i));
    axes.push_back(B.col(i));
    for (int j = 0; j < 3; ++j) {
      const Vector3d axis = Vector3d(A.col(i)).cross(Vector3d(B.col(j)));
      if (axis.norm() > 1e-6) axes.push_back(axis.normalized());
    }
  }
  const std::vector<Vector3d> on_a = corners(a, a_size), on_b = corners(b, b_size);
  double widest = -kInfinity;
  for (const Vector3d& axis : axes) {
    double a_low = kInfinity, a_high = -kInfinity, b_low = kInfinity, b_high = -kInfinity;
    for (const Vector3d& p : on_a) {
      a_low = std::min(a_low, axis.dot(p));
      a_high = std::max(a_high, axis.dot(p));
    }
    for (const Vector3d& p : on_b) {
      b_low = std::min(b_low, axis.dot(p));
      b_high = std::max(b_high, axis.dot(p));
    }
    widest = std::max({widest, a_low - b_high, b_low - a_high});
  }
  return widest;
}

}  // namespace

double joint_rate_limit(const CaptureProblem& problem, int joint) {
  const ConstraintSpec& wanted = problem.constraints;
  if (wanted.joint_rate_max.size() == problem.robot.n()) return wanted.joint_rate_max[joint];
  if (!wanted.joint_rate_scale) return kInfinity;
  return problem.robot.joints[static_cast<std::size_t>(joint)].max_velocity *
         *wanted.joint_rate_scale;
}

double coupling_singular_value(const PostureResponse& response) {
  return smallest_of_rank(response.dynamics.Htilde_omegaphi);
}

double jacobian_singular_value(const PostureResponse& response, double length) {
  const Eigen::MatrixXd& H = response.dynamics.H;
  const Eigen::MatrixXd& J = response.dynamics.J;
  const Eigen::Index n = H.cols() - 6;
  Eigen::MatrixXd Jhat = J.rightCols(n) - J.leftCols(6) * H.topLeftCorner(6, 6).fullPivLu().solve(
                                                              H.topRightCorner(6, n));
  Jhat.bottomRows(3) *= length;
  return smallest_of_rank(Jhat);
}

ContactShapes::ContactShapes(const CaptureProblem& problem, const Configuration& at,
                             const Pose* target)
    : problem_(problem) {
  const std::vector<Pose> bodies = reference::body_poses(problem.robot, at.phi);
  for (const CollisionShape& shape : problem.robot.shapes) {
    const Pose body = shape.body == kBase ? Pose{} : bodies[static_cast<std::size_t>(shape.body)];
    shapes_.push_back({shape.body, shape.link, false, body * shape.pose, &shape.geometry});
  }
  const Pose N = at.base.inverse();
  for (const Obstacle& obstacle : problem.obstacles) {
    const Pose pose = obstacle.frame == Frame::Base ? obstacle.pose : N * obstacle.pose;
    shapes_.push_back({kBase, obstacle.name, true, pose, &obstacle.geometry});
    if (obstacle.frame == Frame::Inertial) shapes_.back().geometry = nullptr;
  }
  if (!problem.target || target == nullptr) return;
  for (const TargetShape& shape : problem.target->shapes) {
    shapes_.push_back({kTarget, "target", false, N * *target * shape.pose, &shape.geometry});
  }
}

std::optional<double> ContactShapes::distance(int i, int j) const {
  if (i < 1 || j < 1 || i > count() || j > count()) return std::nullopt;
  const Shape& a = shapes_[static_cast<std::size_t>(i - 1)];
  const Shape& b = shapes_[static_cast<std::size_t>(j - 1)];
  if (a.geometry == nullptr || b.geometry == nullptr) return std::nullopt;
  const auto round_a = round_of(*a.geometry), round_b = round_of(*b.geometry);
  const auto* box_a = std::get_if<Box>(a.geometry);
  const auto* box_b = std::get_if<Box>(b.geometry);
  const auto along = [](const Shape& shape, double half, double t) -> Vector3d {
    return shape.pose * Vector3d(0, 0, half * t);
  };
  if (round_a && round_b) {
    const auto [half, radius] = *round_a;
    const double other = round_b->first;
    return convex_minimum([&, half = half](double t) {
             return to_axis(b.pose.inverse() * along(a, half, t), other);
           }) -
           radius - round_b->second;
  }
  if (round_a && box_b) {
    const auto [half, radius] = *round_a;
    return convex_minimum([&, half = half](double t) {
             return to_box(b.pose.inverse() * along(a, half, t), box_b->size);
           }) -
           radius;
  }
  if (box_a && round_b) return distance(j, i);
  if (box_a && box_b) return widest_gap(a.pose, box_a->size, b.pose, box_b->size);
  return std::nullopt;
}

bool ContactShapes::must_be_apart(int i, int j) const {
  const Shape& a = shapes_[static_cast<std::size_t>(i - 1)];
  const Shape& b = shapes_[static_cast<std::size_t>(j - 1)];
  if (a.body == b.body) return false;
  for (const auto& [one, other] : problem_.allowed_contacts) {
    if ((one == a.name && other == b.name) || (one == b.name && other == a.name)) return false;
  }
  const int hand = problem_.robot.hand_body;
  if ((a.body == kTarget && b.body == hand) || (b.body == kTarget && a.body == hand)) return false;
  return !are_neighbours(i, j);
}

bool ContactShapes::are_neighbours(int i, int j) const {
  const auto is_parent = [&](const Shape& parent, const Shape& child) {
    return child.body >= 0 && !parent.is_obstacle &&
           problem_.robot.joints[static_cast<std::size_t>(child.body)].parent == parent.body;
  };
  const Shape& a = shapes_[static_cast<std::size_t>(i - 1)];
  const Shape& b = shapes_[static_cast<std::size_t>(j - 1)];
  return is_parent(a, b) || is_parent(b, a);
}

std::optional<std::pair<int, int>> clearance_numbers(const std::string& name) {
  int i = 0, j = 0;
  if (std::sscanf(name.c_str(), "clearance_%d_%d_", &i, &j) != 2) return std::nullopt;
  return std::pair{i, j};
}

MarginNumbers margin_numbers(const CaptureProblem& problem, const Configuration& at,
                             const TargetMotion* motion, const ContactEvent& event,
                             const PostureResponse& response) {
  const ConstraintSpec& wanted = problem.constraints;
  MarginNumbers out;
  if (wanted.joint_rate_scale || wanted.joint_rate_max.size() > 0) {
    const auto rates =
        response.impact(impulse_along(problem, event, response, event.n)).Delta_phidot;
    for (int k = 0; k < problem.robot.n(); ++k) {
      const double excess = std::abs(rates[k]) - joint_rate_limit(problem, k);
      if (excess <= out.rate_excess) continue;
      out.rate_excess = excess;
      out.fastest = problem.robot.joints[static_cast<std::size_t>(k)].name;
    }
  }
  if (wanted.coupling_singular_value_min > 0) out.coupling = coupling_singular_value(response);
  if (wanted.jacobian_singular_value_min > 0) {
    out.jacobian = jacobian_singular_value(response, wanted.jacobian_length);
  }
  if (!wanted.clearance) return out;
  std::optional<Pose> target;
  if (motion != nullptr) target = motion->state(at.contact_time).pose;
  const ContactShapes shapes(problem, at, target ? &*target : nullptr);
  const auto take = [&](int i, int j) {
    const auto distance = shapes.distance(i, j);
    if (!distance || (out.distance && *distance >= *out.distance)) return;
    out.distance = distance;
    out.nearest = shapes.name(i) + " with " + shapes.name(j);
  };
  for (int i = 1; i <= shapes.count(); ++i) {
    for (int j = i + 1; j <= shapes.count(); ++j) {
      if (shapes.must_be_apart(i, j)) take(i, j);
    }
  }
  return out;
}

double neighbours_distance(const CaptureProblem& problem, const Configuration& at) {
  const ContactShapes here(problem, at, nullptr);
  const ContactShapes start(problem, {problem.start, at.base, at.contact_time}, nullptr);
  double least = kInfinity;
  for (int i = 1; i <= here.count(); ++i) {
    for (int j = i + 1; j <= here.count(); ++j) {
      if (!here.are_neighbours(i, j)) continue;
      const auto distance = here.distance(i, j), stated = start.distance(i, j);
      if (distance && stated && *stated > 0) least = std::min(least, *distance);
    }
  }
  return least;
}

void check_margins(const Context& context, const ContactEvent& event,
                   const PostureResponse& response, ClaimList& claims) {
  const ConstraintSpec& wanted = context.problem.constraints;
  const double tolerance = context.options.constraint_tolerance;
  const MarginNumbers found =
      margin_numbers(context.problem, context.plan.configuration, context.motion, event, response);
  if (!found.fastest.empty() && std::isfinite(found.rate_excess)) {
    claims.at_most("joint_rate_limits", found.rate_excess, tolerance, "rad/s",
                   "furthest beyond its rate limit right after the impact: " + found.fastest);
  }
  if (found.coupling) {
    claims.at_least("coupling_singular_value", *found.coupling, wanted.coupling_singular_value_min,
                    tolerance, "kg m^2", "smallest one of the coupling matrix");
  }
  if (found.jacobian) {
    claims.at_least("jacobian_singular_value", *found.jacobian, wanted.jacobian_singular_value_min,
                    tolerance, "m", "smallest one of the generalized Jacobian");
  }
  if (wanted.clearance && found.distance) {
    claims.at_least("shape_clearance", *found.distance, *wanted.clearance, tolerance, "m",
                    "nearest shapes at the contact: " + found.nearest);
  }
}

}  // namespace stillbase::verification
