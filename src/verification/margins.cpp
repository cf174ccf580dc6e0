#include "verification/margins.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <stillbase/core/linear_algebra.hpp>

#include "verification/carrier.hpp"
#include "verification/limits.hpp"

namespace stillbase::verification {
namespace {

/// How singular values and distances are found.
struct MarginOptions {
  double rank = 1e-9;             ///< singular values that count, of the largest one
  int thirds = 90;                ///< of a range, after which its rest is rounding
  double same_axis = 1e-6;        ///< sine of two edges: of parallel ones no axis is normal to both
  double parallel_edges = 1e-12;  ///< square of the sine of two edges that do not cross
};
constexpr MarginOptions kMargins;

double smallest_of_rank(const Eigen::MatrixXd& A) {
  const Eigen::VectorXd values = singular_values(A);
  return values[std::max(numerical_rank(values, kMargins.rank), 1) - 1];
}

/// Minimum of a convex function over [-1, 1]: thirds.
template <class Function>
double convex_minimum(const Function& f) {
  double low = -1, high = 1, best = std::min(f(low), f(high));
  for (int i = 0; i < kMargins.thirds; ++i) {
    const double third = (high - low) / 3, a = low + third, b = high - third;
    const double fa = f(a), fb = f(b);
    best = std::min({best, fa, fb});
    (fa <= fb ? high : low) = fa <= fb ? b : a;
  }
  return best;
}

/// What bounds a shape: everything within a radius of a piece of its z axis, a box, or, of a
/// cylinder, both. Where neither is there its distances have no closed form.
struct Bounds {
  std::optional<std::pair<double, double>> round;  ///< half the length of the axis, radius
  std::optional<Vector3d> box;                     ///< edges
};

Bounds bounds_of(const Geometry& geometry) {
  if (const auto* s = std::get_if<Sphere>(&geometry)) return {std::pair{0.0, s->radius}, {}};
  if (const auto* b = std::get_if<Box>(&geometry)) return {{}, b->size};
  if (const auto* c = std::get_if<Capsule>(&geometry)) {
    return {std::pair{c->length / 2, c->radius}, {}};
  }
  if (const auto* c = std::get_if<Cylinder>(&geometry)) {
    return {std::pair{c->length / 2, c->radius}, Vector3d(2 * c->radius, 2 * c->radius, c->length)};
  }
  return {};
}

/// Radius of the sphere about the origin beyond which distances are counted, m; see Bounds.
double reach_of(const Bounds& bounds) {
  if (bounds.round) return bounds.round->first + bounds.round->second;
  return bounds.box ? bounds.box->norm() / 2 : kInfinity;
}

double to_box(const Vector3d& point, const Vector3d& size) {
  Vector3d out;
  for (int i = 0; i < 3; ++i) out[i] = std::abs(point[i]) - size[i] / 2;
  if (out.maxCoeff() <= 0) return out.maxCoeff();
  for (double& x : out) x = std::max(x, 0.0);
  return out.norm();
}

/// The edges of a box, as middle and half length along its axis.
std::vector<std::pair<Vector3d, Vector3d>> edges_of(const Pose& pose, const Vector3d& size) {
  std::vector<std::pair<Vector3d, Vector3d>> out;
  for (int along = 0; along < 3; ++along) {
    const int a = (along + 1) % 3, b = (along + 2) % 3;
    for (const double side_a : {-0.5, 0.5}) {
      for (const double side_b : {-0.5, 0.5}) {
        Vector3d middle = Vector3d::Zero();
        middle[a] = side_a * size[a];
        middle[b] = side_b * size[b];
        out.emplace_back(pose * middle,
                         pose.orientation * Vector3d(size[along] / 2 * Vector3d::Unit(along)));
      }
    }
  }
  return out;
}

/// The least distance of the edges of one box from another one, by a search along each that may
/// come closer than those before: no point of an edge is further from its middle than its ends.
double edges_from_box(const Pose& of, const Vector3d& size, const Pose& other,
                      const Vector3d& other_size) {
  double least = kInfinity;
  for (const auto& edge : edges_of(other.inverse() * of, size)) {
    const Vector3d &middle = edge.first, &half = edge.second;
    if (to_box(middle, other_size) - half.norm() >= least) continue;
    least = std::min(
        least, convex_minimum([&](double t) { return to_box(middle + t * half, other_size); }));
  }
  return least;
}

double to_axis(const Vector3d& point, double half) {
  return std::hypot(point.x(), point.y(), std::max(std::abs(point.z()) - half, 0.0));
}

/// @param round half the length of the axis, radius
double round_to_box(const Pose& a, const std::pair<double, double>& round, const Pose& box,
                    const Vector3d& size) {
  return convex_minimum([&](double t) {
           return to_box(box.inverse() * (a * Vector3d(0, 0, round.first * t)), size);
         }) -
         round.second;
}

double round_to_round(const Pose& a, const std::pair<double, double>& round_a, const Pose& b,
                      const std::pair<double, double>& round_b) {
  return convex_minimum([&](double t) {
           return to_axis(b.inverse() * (a * Vector3d(0, 0, round_a.first * t)), round_b.first);
         }) -
         round_a.second - round_b.second;
}

double widest_gap(const Pose& a, const Vector3d& a_size, const Pose& b, const Vector3d& b_size) {
  const Matrix3d A = a.orientation.toRotationMatrix(), B = b.orientation.toRotationMatrix();
  std::vector<Vector3d> axes;
  for (int i = 0; i < 3; ++i) {
    axes.push_back(A.col(i));
    axes.push_back(B.col(i));
    for (int j = 0; j < 3; ++j) {
      const Vector3d axis = Vector3d(A.col(i)).cross(Vector3d(B.col(j)));
      if (axis.norm() > kMargins.same_axis) axes.push_back(axis.normalized());
    }
  }
  const auto half_extent = [](const Matrix3d& R, const Vector3d& size, const Vector3d& axis) {
    return (R.transpose() * axis).cwiseAbs().dot(size) / 2;
  };
  double widest = -kInfinity;
  for (const Vector3d& axis : axes) {
    widest = std::max(widest, std::abs(axis.dot(b.position - a.position)) -
                                  half_extent(A, a_size, axis) - half_extent(B, b_size, axis));
  }
  return widest;
}

/// Exact where boxes are apart; where they overlap their widest gap along a separating axis.
double box_to_box(const Pose& a, const Vector3d& a_size, const Pose& b, const Vector3d& b_size) {
  const double gap = widest_gap(a, a_size, b, b_size);
  if (!(gap > 0)) return gap;
  return std::min(edges_from_box(a, a_size, b, b_size), edges_from_box(b, b_size, a, a_size));
}

}  // namespace

double coupling_singular_value(const PostureResponse& response) {
  return smallest_of_rank(response.dynamics.Htilde_omegaphi);
}

double jacobian_singular_value(const PostureResponse& response, double length) {
  Eigen::MatrixXd Jhat = hand_response(response.dynamics);
  Jhat.bottomRows(3) *= length;
  return smallest_of_rank(Jhat);
}

ContactShapes::ContactShapes(const CaptureProblem& problem, const Configuration& at,
                             const Pose* target)
    : problem_(problem) {
  const std::vector<Pose> bodies = reference::body_poses(problem.robot, at.phi);
  for (const CollisionShape& shape : problem.robot.shapes) {
    const Pose body = shape.body == kBase ? Pose{} : bodies[shape.body];
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
    shapes_.push_back({kOnTarget, "target", false, N * *target * shape.pose, &shape.geometry});
  }
}

std::optional<double> ContactShapes::distance(int i, int j, double enough) const {
  if (i < 1 || j < 1 || i > count() || j > count()) return std::nullopt;
  const Shape &a = shape(i), &b = shape(j);
  if (a.geometry == nullptr || b.geometry == nullptr) return std::nullopt;
  const Bounds of_a = bounds_of(*a.geometry), of_b = bounds_of(*b.geometry);
  const double apart = (a.pose.position - b.pose.position).norm() - reach_of(of_a) - reach_of(of_b);
  if (apart > enough) return apart;
  std::optional<double> out;
  const auto offer = [&out](double x) { out = std::max(out.value_or(-kInfinity), x); };
  if (of_a.round && of_b.round) offer(round_to_round(a.pose, *of_a.round, b.pose, *of_b.round));
  if (of_a.round && of_b.box) offer(round_to_box(a.pose, *of_a.round, b.pose, *of_b.box));
  if (of_a.box && of_b.round) offer(round_to_box(b.pose, *of_b.round, a.pose, *of_a.box));
  if (of_a.box && of_b.box) {
    const bool is_exact = !of_a.round && !of_b.round;
    offer((is_exact ? box_to_box : widest_gap)(a.pose, *of_a.box, b.pose, *of_b.box));
  }
  return out;
}

namespace {

/// Of two edges that pass each other, nearest between their ends; else infinite.
double crossing_distance(const std::pair<Vector3d, Vector3d>& one,
                         const std::pair<Vector3d, Vector3d>& other) {
  const auto& [p, u] = one;
  const auto& [q, v] = other;
  const Vector3d w = q - p, n = u.cross(v);
  const double square = n.squaredNorm();
  if (!(square > kMargins.parallel_edges * u.squaredNorm() * v.squaredNorm())) return kInfinity;
  const double s = w.cross(v).dot(n) / square, t = w.cross(u).dot(n) / square;
  if (!(std::abs(s) < 1 && std::abs(t) < 1)) return kInfinity;
  return std::abs(w.dot(n)) / std::sqrt(square);
}

}  // namespace

std::vector<double> ContactShapes::feature_distances(int i, int j) const {
  std::vector<double> out;
  if (shape(i).body != kBase || shape(j).body != kOnTarget) return out;
  const auto box_of = [](const Shape& shape) {
    return shape.geometry == nullptr ? nullptr : std::get_if<Box>(shape.geometry);
  };
  const Box *one = box_of(shape(i)), *other = box_of(shape(j));
  if (one == nullptr || other == nullptr) return out;
  const auto add_corners = [&out](const Shape& from, const Box& corners, const Shape& to,
                                  const Box& box) {
    const Vector3d half = corners.size / 2;
    for (const double x : {-half.x(), half.x()}) {
      for (const double y : {-half.y(), half.y()}) {
        for (const double z : {-half.z(), half.z()}) {
          out.push_back(to_box(to.pose.inverse() * (from.pose * Vector3d(x, y, z)), box.size));
        }
      }
    }
  };
  add_corners(shape(i), *one, shape(j), *other);
  add_corners(shape(j), *other, shape(i), *one);
  const auto edges = edges_of(shape(j).pose, other->size);
  for (const auto& edge : edges_of(shape(i).pose, one->size)) {
    for (const auto& across : edges) out.push_back(crossing_distance(edge, across));
  }
  return out;
}

bool ContactShapes::must_be_apart(int i, int j) const {
  const Shape &a = shape(i), &b = shape(j);
  if (a.body == b.body) return false;
  for (const auto& [one, other] : problem_.allowed_contacts) {
    if ((one == a.name && other == b.name) || (one == b.name && other == a.name)) return false;
  }
  const int hand = problem_.robot.hand_body;
  if ((a.body == kOnTarget && b.body == hand) || (b.body == kOnTarget && a.body == hand))
    return false;
  return !are_neighbours(i, j);
}

bool ContactShapes::are_neighbours(int i, int j) const {
  const auto is_parent = [&](const Shape& parent, const Shape& child) {
    return child.body >= 0 && !parent.is_obstacle &&
           problem_.robot.tree()[child.body].parent == parent.body;
  };
  const Shape &a = shape(i), &b = shape(j);
  return is_parent(a, b) || is_parent(b, a);
}

std::optional<std::pair<int, int>> clearance_numbers(const std::string& name) {
  int i = 0, j = 0;
  if (std::sscanf(name.c_str(), "clearance_%d_%d_", &i, &j) != 2) return std::nullopt;
  return std::pair{i, j};
}

ClosestShapes closest_shapes(const Situation& situation) {
  ClosestShapes out;
  const auto target = situation.target_pose();
  const ContactShapes shapes(situation.problem, situation.at, target ? &*target : nullptr);
  for (int i = 1; i <= shapes.count(); ++i) {
    for (int j = i + 1; j <= shapes.count(); ++j) {
      if (!shapes.must_be_apart(i, j)) continue;
      const auto distance = shapes.distance(i, j, out.distance.value_or(kInfinity));
      if (!distance || (out.distance && *distance >= *out.distance)) continue;
      out.distance = distance;
      out.pair = shapes.name(i) + " with " + shapes.name(j);
    }
  }
  return out;
}

namespace {

/// The smallest distance of neighbours in the tree that are apart in the start posture, m; infinite
/// without any.
double neighbours_distance(const CaptureProblem& problem, const Configuration& at) {
  const ContactShapes here(problem, at, nullptr);
  const ContactShapes start(problem, {problem.start, at.base, at.contact_time}, nullptr);
  double least = kInfinity;
  for (int i = 1; i <= here.count(); ++i) {
    for (int j = i + 1; j <= here.count(); ++j) {
      if (!here.are_neighbours(i, j)) continue;
      const auto distance = here.distance(i, j, least), stated = start.distance(i, j, 0);
      if (distance && stated && *stated > 0) least = std::min(least, *distance);
    }
  }
  return least;
}

/// The limit of a margin that is nearest, or exceeded most; empty: the problem has none.
std::optional<ContactLimit> tightest(const LimitRecord& record, const Situation& situation) {
  if (record.check == nullptr) return std::nullopt;
  const std::vector<ContactLimit> limits = limits_of(record, situation);
  const auto least = std::min_element(
      limits.begin(), limits.end(),
      [](const ContactLimit& a, const ContactLimit& b) { return a.room() < b.room(); });
  return least == limits.end() ? std::nullopt : std::optional(*least);
}

}  // namespace

bool demands_margins(const CaptureProblem& problem) {
  const std::vector<LimitRecord>& records = limit_records();
  return problem.constraints.clearance ||
         std::any_of(records.begin(), records.end(), [&](const LimitRecord& record) {
           return record.check != nullptr && record.is_set(problem);
         });
}

double least_margin(const Situation& situation) {
  double least = kInfinity;
  for (const LimitRecord& record : limit_records()) {
    if (const auto limit = tightest(record, situation)) least = std::min(least, limit->room());
  }
  const std::optional<double>& clearance = situation.problem.constraints.clearance;
  if (!clearance) return least;
  const double apart = closest_shapes(situation).distance.value_or(kInfinity);
  const double neighbours = neighbours_distance(situation.problem, situation.at);
  return std::min(least, std::min(apart, neighbours) - *clearance);
}

void check_margins(const Situation& situation, const VerifyOptions& options, ClaimList& claims) {
  const double tolerance = options.constraint_tolerance;
  for (const LimitRecord& record : limit_records()) {
    const auto limit = tightest(record, situation);
    if (!limit) continue;
    if (std::isfinite(limit->range.upper)) {
      claims.at_most(record.check, -limit->room(), tolerance, record.unit,
                     record.words + limit->joint);
    } else {
      claims.at_least(record.check, limit->value, limit->range.lower, tolerance, record.unit,
                      record.words);
    }
  }
  const std::optional<double>& clearance = situation.problem.constraints.clearance;
  if (!clearance) return;
  const ClosestShapes closest = closest_shapes(situation);
  if (!closest.distance) return;
  claims.at_least("shape_clearance", *closest.distance, *clearance, tolerance, "m",
                  "closest shapes at the contact: " + closest.pair);
}

}  // namespace stillbase::verification
