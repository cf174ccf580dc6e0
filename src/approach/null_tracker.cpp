#include "approach/null_tracker.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <stillbase/core/linear_algebra.hpp>
#include <stillbase/core/parallel.hpp>

#include <stillbase/dynamics/inertia.hpp>

namespace stillbase {

namespace {

struct Reference {
  Eigen::VectorXd r, slope;
};

Reference reference_at(const Knots& knots, double s) {
  const auto count = knots.cols() - 1;
  const auto i = std::clamp(static_cast<Eigen::Index>(s * static_cast<double>(count)),
                            Eigen::Index{0}, count - 1);
  const double u = s * static_cast<double>(count) - static_cast<double>(i);
  const auto knot_slope = [&](Eigen::Index k) -> Eigen::VectorXd {
    const Eigen::Index a = std::max<Eigen::Index>(k - 1, 0), b = std::min(k + 1, count);
    return (knots.col(b) - knots.col(a)) / static_cast<double>(b - a);
  };
  const Eigen::VectorXd m0 = knot_slope(i), m1 = knot_slope(i + 1);
  const Eigen::VectorXd rise = knots.col(i + 1) - knots.col(i);
  return {knots.col(i) + (u * u * (3 - 2 * u)) * rise + (u * (1 - u) * (1 - u)) * m0 -
              (u * u * (1 - u)) * m1,
          static_cast<double>(count) *
              ((6 * u * (1 - u)) * rise + ((1 - u) * (1 - 3 * u)) * m0 + (u * (3 * u - 2)) * m1)};
}

}  // namespace

NullTracker::NullTracker(const RobotModel& robot, const JointVectord& start,
                         std::vector<Eigen::Index> free, const NullSpaceOptions& options, int jobs,
                         StopCondition stop)
    : robot_(robot),
      start_(start),
      free_(std::move(free)),
      options_(options),
      jobs_(jobs),
      stop_(std::move(stop)) {
  lower_ = upper_ = start(free_);
  for (std::size_t i = 0; i < free_.size(); ++i) {
    const Joint& joint = robot.joints[free_[i]];
    lower_[i] = std::min(joint.lower + options_.limit_margin, lower_[i]);
    upper_[i] = std::max(joint.upper - options_.limit_margin, upper_[i]);
  }
}

Eigen::VectorXd NullTracker::projected(const JointVectord& phi,
                                       const Eigen::VectorXd& wanted) const {
  const auto inertia = compute_inertia<double>(robot_, compute_kinematics<double>(robot_, phi));
  const Matrix3Xd all = compute_tilde_inertia<double>(inertia).Htilde_omegaphi;
  const Matrix3Xd A = all(Eigen::all, free_);
  const SymmetricEigen3 square = symmetric_eigen3(A * A.transpose());
  Vector3d momentum = square.vectors.transpose() * (A * wanted);
  const Vector3d sizes = square.values;
  for (int k = 0; k < 3; ++k) {
    momentum[k] = sizes[k] > options_.rank_squared * sizes[2] ? momentum[k] / sizes[k] : 0;
  }
  return wanted - A.transpose() * (square.vectors * momentum);
}

JointVectord NullTracker::slope(const Knots& knots, double s, const JointVectord& phi) const {
  const Reference reference = reference_at(knots, s);
  return with_free_part(
      JointVectord::Zero(phi.size()), free_,
      projected(phi, reference.slope + options_.pull * (reference.r - free_part(phi))));
}

JointVectord NullTracker::step(const Knots& knots, double s, double h, const JointVectord& phi,
                               const JointVectord& k1) const {
  const JointVectord k2 = slope(knots, s + h / 2, phi + h / 2 * k1);
  const JointVectord k3 = slope(knots, s + h / 2, phi + h / 2 * k2);
  const JointVectord k4 = slope(knots, s + h, phi + h * k3);
  return phi + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
}

JointPath NullTracker::follow(const Knots& knots, int steps) const {
  const auto total = static_cast<int>(knots.cols() - 1) * steps;
  JointPath curve;
  JointVectord phi = start_;
  for (int i = 0; i <= total; ++i) {
    const double s = static_cast<double>(i) / total;
    curve.times.push_back(s);
    curve.phi.push_back(phi);
    curve.phidot.push_back(slope(knots, s, phi));
    if (i < total) phi = step(knots, s, 1.0 / total, phi, curve.phidot.back());
  }
  return curve;
}

Eigen::MatrixXd NullTracker::end_jacobian(const Knots& knots, const JointPath& curve,
                                          int steps) const {
  const Eigen::Index m = knots.rows(), count = knots.cols() - 1;
  const auto total = static_cast<int>(count) * steps;
  const Eigen::VectorXd end = free_part(curve.phi.back());
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(m, m * count);
  for_each_index(jobs_, static_cast<int>(m * count), stop_, [&](int column) {
    const Eigen::Index k = 1 + column / m, row = column % m;
    Knots beside = knots;
    beside(row, k) += options_.difference;
    // A knot bends the reference from two knots before it on.
    const int from = static_cast<int>(std::max<Eigen::Index>(k - 2, 0)) * steps;
    JointVectord phi = curve.phi[from];
    for (int i = from; i < total; ++i) {
      const double s = static_cast<double>(i) / total;
      phi = step(beside, s, 1.0 / total, phi, slope(beside, s, phi));
    }
    J.col(column) = (free_part(phi) - end) / options_.difference;
  });
  if (stop_.reached()) J.setZero();
  return J;
}

// A goal that moves along with the posture asks for nothing in those directions: I - d goal / d
// end.
Eigen::MatrixXd NullTracker::directions_asked(const GoalNear& goal, const JointVectord& end) const {
  const auto m = static_cast<Eigen::Index>(free_.size());
  Eigen::MatrixXd asked = Eigen::MatrixXd::Identity(m, m);
  const auto here = goal(end);
  if (!here) return asked;
  for (Eigen::Index i = 0; i < m; ++i) {
    JointVectord beside = end;
    beside[free_[i]] += options_.goal_difference;
    const auto there = goal(beside);
    // A jump to another goal says nothing about this one.
    if (!there || (there->phi - here->phi).norm() > 10 * options_.goal_difference) continue;
    asked.col(i) -= (free_part(there->phi) - free_part(here->phi)) / options_.goal_difference;
  }
  return asked;
}

Knots NullTracker::bent(const Knots& knots, const JointPath& curve, const Eigen::VectorXd& push,
                        double stride) const {
  const auto steps = static_cast<int>((curve.times.size() - 1) / (knots.cols() - 1));
  const JointPath coarse =
      steps == options_.coarse_steps ? curve : follow(knots, options_.coarse_steps);
  const Eigen::MatrixXd J = end_jacobian(knots, coarse, options_.coarse_steps);
  const Eigen::VectorXd change = J.transpose() * push;
  const double size = (J * change).norm();
  return size > 0 ? shifted_knots(knots, stride / size * change) : knots;
}

// The curve keeps to its reference: a reference within the limits keeps it off them.
Knots NullTracker::shifted_knots(const Knots& knots, const Eigen::VectorXd& shift) const {
  const Eigen::Index m = knots.rows(), count = knots.cols() - 1;
  const double part = std::min(1.0, options_.largest_shift / shift.cwiseAbs().maxCoeff());
  Knots there = knots;
  there.rightCols(count) += part * Eigen::Map<const Eigen::MatrixXd>(shift.data(), m, count);
  return there.cwiseMax(lower_.replicate(1, count + 1)).cwiseMin(upper_.replicate(1, count + 1));
}

std::optional<Configuration> NullTracker::reach(const GoalNear& goal, Knots& knots,
                                                JointPath& curve) const {
  const Eigen::Index m = knots.rows();
  std::optional<Configuration> wanted;
  const auto missing = [&](const JointPath& path) -> Eigen::VectorXd {
    const JointVectord& end = path.phi.back();
    if (end.allFinite()) wanted = goal(end);
    if (!end.allFinite() || !wanted) return Eigen::VectorXd::Constant(m, kInfinity);
    return free_part(wanted->phi) - free_part(end);
  };
  int steps = options_.coarse_steps;
  double damping = options_.first_damping;
  curve = follow(knots, steps);
  for (int newton = 0; newton < options_.newton_steps; ++newton) {
    const Eigen::VectorXd error = missing(curve);  // also sets the goal of this very curve
    if (!error.allFinite()) return std::nullopt;
    if (error.norm() < options_.reached && steps == options_.fine_steps) {
      curve.phi.back() = wanted->phi;
      return wanted;
    }
    if (error.norm() < options_.nearly_reached && steps != options_.fine_steps) {
      steps = options_.fine_steps;
      curve = follow(knots, steps);
      continue;
    }
    const JointPath coarse =
        steps == options_.coarse_steps ? curve : follow(knots, options_.coarse_steps);
    const Eigen::MatrixXd J = directions_asked(goal, curve.phi.back()) *
                              end_jacobian(knots, coarse, options_.coarse_steps);
    const Eigen::MatrixXd square = J * J.transpose();
    bool better = false;
    for (int trial = 0; trial < options_.dampings && !better && !stop_.reached(); ++trial) {
      const Eigen::MatrixXd damped = square + damping * Eigen::MatrixXd::Identity(m, m);
      const Eigen::VectorXd shift = J.transpose() * damped.ldlt().solve(error);
      Knots there = shifted_knots(knots, shift);
      JointPath moved = follow(there, steps);
      better = missing(moved).norm() < error.norm();
      damping = better ? damping / 8 : damping * 6;
      if (!better) continue;
      knots = std::move(there);
      curve = std::move(moved);
    }
    if (!better) return std::nullopt;
  }
  return std::nullopt;
}

}  // namespace stillbase
