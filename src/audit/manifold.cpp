#include "audit/manifold.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <stillbase/core/constants.hpp>
#include <stillbase/core/linear_algebra.hpp>
#include <stillbase/core/random.hpp>

#include "audit/equations.hpp"
#include "audit/tolerances.hpp"
#include "verification/limits.hpp"
#include "verification/margins.hpp"

namespace stillbase::audit {

using namespace verification;

namespace {

/// Corrections onto the equations, limits of shapes, and the typical size of an objective.
struct ManifoldOptions {
  double on_manifold = 1e-12;  ///< norm of the residual
  int corrections = 40;        ///< with one matrix: they converge linearly
  /// m, of two boxes: within it their distance is that of two of their features.
  double same_distance = 1e-9;
  int typical_samples = 15;  ///< configurations whose median is the typical size
  /// Of the total angular momentum: below, the objective vanishes everywhere.
  double vanishes = 1e-12;
};
constexpr ManifoldOptions kManifold;

Equations::Demand demand_of(const CaptureProblem& problem) {
  return problem.constraints.impact_case == CaseConstraint::None ? Equations::Demand::Hand
                                                                 : Equations::Demand::HandAndCase;
}

std::optional<Vector3d> hand_point(const CaptureProblem& problem, const ContactEvent& event) {
  if (problem.hand.position) return problem.hand.position;
  if (event.feature) return event.feature->point;
  return std::nullopt;
}

}  // namespace

FeasibleManifold::FeasibleManifold(const CaptureProblem& problem, const Configuration& at)
    : problem_(problem),
      variables_(problem),
      equations_(problem, variables_, demand_of(problem)),
      x_(variables_.of(at)),
      units_(variables_.units()) {
  const Eigen::Index n = x_.size();
  if (n == 0) {
    objection_ = "there are no variables";
    return;
  }
  const Eigen::MatrixXd J = equations_.jacobian(x_) * units_.cwiseInverse().asDiagonal();
  const Svd svd = right_svd(J);
  const auto above = [&](double size) { return (svd.sigma.array() > size).count(); };
  const Eigen::Index rank = above(kRecord.restricts);
  if (rank != above(kRecord.restricts_not)) {
    objection_ = "the equations nearly depend on each other there";
    return;
  }
  Z_ = svd.V.rightCols(n - rank);
  correction_ = Eigen::MatrixXd::Zero(n, J.rows());
  if (rank > 0) {
    const Eigen::MatrixXd V = svd.V.leftCols(rank);
    correction_ = V * pseudo_inverse(J * V, kRecord.restricts_not);
  }
}

Configuration FeasibleManifold::with_station(Configuration at) const {
  if (problem_.variables.base_position == PositionFreedom::Fixed) return at;
  const Situation there(problem_, at);
  if (const auto point = hand_point(problem_, there.event)) {
    at.base.position += *point - there.hand_N;
  }
  return at;
}

std::optional<Configuration> FeasibleManifold::at(const Eigen::VectorXd& u) const {
  Eigen::VectorXd x = x_ + (Z_ * u).cwiseQuotient(units_);
  for (int i = 0; i < kManifold.corrections; ++i) {
    const Eigen::VectorXd residual = equations_.residual(x);
    if (residual.norm() <= kManifold.on_manifold) return with_station(variables_.at(x));
    x -= (correction_ * residual).cwiseQuotient(units_);
  }
  return std::nullopt;
}

Configuration FeasibleManifold::beside(const Eigen::VectorXd& w) const {
  return with_station(variables_.at(x_ + w.cwiseQuotient(units_)));
}

std::vector<double> distances_from_limits(const Situation& situation,
                                          std::vector<NamedLimit>* limits) {
  const CaptureProblem& problem = situation.problem;
  const Configuration& at = situation.at;
  const VariableSpec& free = problem.variables;
  const ConstraintSpec& wanted = problem.constraints;
  std::vector<double> out;
  const auto add = [&](double distance, const NamedLimit& limit) {
    out.push_back(distance);
    if (limits != nullptr) limits->push_back(limit);
  };
  const auto between = [&](double x, double lower, double upper, const std::string& name,
                           const std::string& unit) {
    if (std::isfinite(lower)) add(x - lower, {name, unit, lower});
    if (std::isfinite(upper)) add(upper - x, {name, unit, upper, true});
  };
  for (int k = 0; k < problem.robot.n(); ++k) {
    const Joint& joint = problem.robot.joints[k];
    if (!free.joints[k] || reaches_every_angle(problem, k)) continue;
    between(at.phi[k], joint.lower + wanted.joint_limit_margin,
            joint.upper - wanted.joint_limit_margin, joint.name,
            joint.is_prismatic() ? "m" : "rad");
  }
  const Eigen::Quaterniond rotation = at.base.orientation * problem.base.orientation.conjugate();
  const Vector3d& axis = free.base_attitude_axis;
  const double most = free.base_attitude_max;
  if (free.base_attitude == AttitudeFreedom::Cone) {
    // In rad beside the limit.
    add((axis.dot(rotation * axis) - std::cos(most)) / std::sin(most),
        {"base_attitude", "rad", most, true});
  } else if (free.base_attitude == AttitudeFreedom::Axis && most < kEveryAttitude) {
    between(rotation_log(rotation).dot(axis), -most, most, "base_attitude", "rad");
  } else if (free.base_attitude == AttitudeFreedom::Free && most < kEveryAttitude) {
    // Smooth also where the angle is zero, and in rad beside the limit.
    add((most * most - rotation_log(rotation).squaredNorm()) / (2 * most),
        {"base_attitude", "rad", most, true});
  }
  if (free.contact_time_upper > free.contact_time_lower) {
    between(at.contact_time, free.contact_time_lower, free.contact_time_upper, "contact_time", "s");
  }
  if (free.base_position == PositionFreedom::Box) {
    for (int i = 0; i < 3; ++i) {
      between(at.base.position[i], free.base_position_lower[i], free.base_position_upper[i],
              std::string("base_position_") + "xyz"[i], "m");
    }
  }
  for (const LimitRecord& record : limit_records()) {
    for (const ContactLimit& limit : limits_of(record, situation)) {
      between(limit.value, limit.range.lower, limit.range.upper, limit.name, limit.unit);
    }
  }
  if (!wanted.clearance) return out;
  const auto target = situation.target_pose();
  const ContactShapes shapes(problem, at, target ? &*target : nullptr);
  for (int i = 1; i <= shapes.count(); ++i) {
    for (int j = i + 1; j <= shapes.count(); ++j) {
      if (!shapes.must_be_apart(i, j) && !shapes.are_neighbours(i, j)) continue;
      // Where several of the smooth distances of two boxes are the least one, that has a kink.
      const double least = shapes.distance(i, j).value_or(kInfinity);
      NamedLimit limit;
      if (limits != nullptr) {
        limit = {fmt::format("clearance_{}_{}_{}_{}", i, j, shapes.name(i), shapes.name(j)), "m",
                 *wanted.clearance};
      }
      bool is_of_feature = false;
      for (const double of_feature : shapes.feature_distances(i, j)) {
        add(of_feature - *wanted.clearance, limit);
        is_of_feature = is_of_feature || of_feature <= least + kManifold.same_distance;
      }
      add(is_of_feature ? kInfinity : least - *wanted.clearance, limit);
    }
  }
  return out;
}

namespace {

/// A rotation of the base from its stated attitude, in N, from three numbers in [0, 1): an axis
/// evenly over its cap with the roll about it, any rotation (Shoemake), or a ball of rotation
/// vectors.
Eigen::Quaterniond sampled_rotation(const CaptureProblem& problem, const Vector3d& u) {
  const double most = problem.variables.base_attitude_max;
  const auto circle = [](double part) {
    return Vector3d(std::cos(2 * kPi * part), std::sin(2 * kPi * part), 0);
  };
  const Eigen::Quaterniond& stated = problem.base.orientation;
  if (problem.variables.base_attitude == AttitudeFreedom::Cone) {
    const Vector3d& axis = problem.variables.base_attitude_axis;
    int least = 0;
    axis.cwiseAbs().minCoeff(&least);
    const Vector3d e_1 = axis.cross(Vector3d(Vector3d::Unit(least))).normalized();
    const Vector3d e_2 = axis.cross(e_1);
    const double tilt = std::acos(1 - u[0] * (1 - std::cos(most)));
    const Vector3d side = circle(u[1]);
    return rotation_exp(tilt * (side.x() * e_1 + side.y() * e_2)) *
           rotation_exp(kPi * (2 * u[2] - 1) * axis);
  }
  Eigen::Quaterniond in_base;
  if (most > kEveryAttitude) {
    const Vector3d b = std::sqrt(1 - u[0]) * circle(u[1]), c = std::sqrt(u[0]) * circle(u[2]);
    in_base = Eigen::Quaterniond(c.x(), b.y(), b.x(), c.y());
  } else {
    const double z = 2 * u[0] - 1;
    const Vector3d direction =
        std::sqrt(std::max(0.0, 1 - z * z)) * circle(u[1]) + z * Vector3d::UnitZ();
    in_base = rotation_exp(most * std::cbrt(u[2]) * direction);
  }
  return stated * in_base * stated.conjugate();
}

}  // namespace

double typical_objective(const CaptureProblem& problem) {
  constexpr int kSamples = kManifold.typical_samples;
  const FreeVariables variables(problem);
  std::vector<double> sizes, larger;
  for (int sample = 0; sample < kSamples; ++sample) {
    const Eigen::VectorXd u = low_discrepancy_point(sample, variables.size(), 0);
    Eigen::VectorXd x = variables.lower + u.cwiseProduct(variables.upper - variables.lower);
    if (const int i = variables.rotation_vector(); i >= 0) {
      x.segment<3>(i) = rotation_log(sampled_rotation(problem, u.segment<3>(i)));
    }
    const Situation at(problem, variables.at(x));
    ContactEvent event = at.event;
    // A target that moves away counts as if it came.
    if (event.velocity && event.n.dot(*event.velocity) < 0) {
      event.velocity = -*event.velocity;
      event.omega = -event.omega;
    }
    const auto impulse = impulse_along(problem, event, at.response, event.n);
    sizes.push_back(std::sqrt(square_of(problem, at.response, impulse)));
    larger.push_back(at.response.impact(impulse).total.norm());
  }
  const auto median = [](std::vector<double>& values) {
    std::nth_element(values.begin(), values.begin() + kSamples / 2, values.end());
    return values[kSamples / 2];
  };
  const double size = median(sizes), whole = median(larger);
  if (size > kManifold.vanishes * whole) return size;
  return whole > 0 ? whole : 1;
}

}  // namespace stillbase::audit
