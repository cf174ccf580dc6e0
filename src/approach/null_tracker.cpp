#include "approach/null_tracker.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Cholesky>
#include <stillbase/core/linear_algebra.hpp>
#include <stillbase/core/parallel.hpp>

#include "dynamics/null_velocity_kernel.hpp"
#include "impact/null_velocities.hpp"

namespace stillbase {

namespace {

/// A point of the reference and its slope: weighted sums of the knots around it.
struct ReferenceWeights {
  std::array<Eigen::Index, 4> knots;
  std::array<double, 4> value, slope;

  /// Of one knot.
  double value_of(Eigen::Index knot) const { return of(knot, value); }
  double slope_of(Eigen::Index knot) const { return of(knot, slope); }

 private:
  double of(Eigen::Index knot, const std::array<double, 4>& weights) const {
    double sum = 0;  // the first and the last knot may count twice
    for (std::size_t i = 0; i < 4; ++i) sum += knots[i] == knot ? weights[i] : 0;
    return sum;
  }
};

ReferenceWeights reference_weights(const Knots& knots, double s) {
  const auto count = knots.cols() - 1;
  const auto i = std::clamp(static_cast<Eigen::Index>(s * static_cast<double>(count)),
                            Eigen::Index{0}, count - 1);
  const double u = s * static_cast<double>(count) - static_cast<double>(i);
  const double n = static_cast<double>(count);
  ReferenceWeights out;
  out.knots = {std::max<Eigen::Index>(i - 1, 0), i, i + 1, std::min(i + 2, count)};
  // Slopes at the knots i and i + 1, per interval, are differences of their neighbours.
  const double before = 1.0 / static_cast<double>(i + 1 - out.knots[0]);
  const double after = 1.0 / static_cast<double>(out.knots[3] - i);
  const auto weigh = [&](double rise, double m0, double m1, double here) {
    return std::array<double, 4>{-m0 * before, here - rise - m1 * after, rise + m0 * before,
                                 m1 * after};
  };
  out.value = weigh(u * u * (3 - 2 * u), u * (1 - u) * (1 - u), -u * u * (1 - u), 1);
  out.slope = weigh(n * (6 * u * (1 - u)), n * ((1 - u) * (1 - 3 * u)), n * (u * (3 * u - 2)), 0);
  return out;
}

/// The velocity wanted of the free joints where the reference is r, less its pull on where they
/// are.
JointVectord pulled_along(const Knots& knots, const ReferenceWeights& at, double pull) {
  JointVectord out = JointVectord::Zero(knots.rows());
  for (std::size_t i = 0; i < 4; ++i) {
    out += (at.slope[i] + pull * at.value[i]) * knots.col(at.knots[i]);
  }
  return out;
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
      stop_(stop) {
  lower_ = upper_ = start(free_);
  for (std::size_t i = 0; i < free_.size(); ++i) {
    const Joint& joint = robot.joints[free_[i]];
    lower_[i] = std::min(joint.lower + options_.limit_margin, lower_[i]);
    upper_[i] = std::max(joint.upper - options_.limit_margin, upper_[i]);
  }
}

JointVectord NullTracker::projected(const JointVectord& phi, const JointVectord& wanted) const {
  const NullVelocity<double> found = nearest_null_velocity<double>(robot_, phi, free_, wanted);
  if (found.conditioning > options_.well_conditioned) return found.phidot;
  return projected_by_rank(phi, wanted);
}

JointVectord NullTracker::projected_by_rank(const JointVectord& phi,
                                            const JointVectord& wanted) const {
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
  const JointVectord wanted = pulled_along(knots, reference_weights(knots, s), options_.pull) -
                              options_.pull * JointVectord(phi(free_));
  return with_free_part(JointVectord::Zero(phi.size()), free_, projected(phi, wanted));
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

/// Curves side by side, one per row of the knots, whose entry in one column is moved.
class NullTracker::Beside {
 public:
  Beside(const NullTracker& tracker, const Knots& knots, Eigen::Index knot, JointVectord from)
      : tracker_(tracker), knots_(knots), knot_(knot) {
    const Eigen::Index m = knots.rows();
    phi_ = from.transpose().replicate(m, 1);
    batch_.wanted.resize(m, m);
  }

  void step(double s, double h) {
    const Eigen::MatrixXd k1 = slope(s, phi_);
    const Eigen::MatrixXd k2 = slope(s + h / 2, moved(h / 2, k1));
    const Eigen::MatrixXd k3 = slope(s + h / 2, moved(h / 2, k2));
    const Eigen::MatrixXd k4 = slope(s + h, moved(h, k3));
    phi_ = moved(h / 6, k1 + 2 * k2 + 2 * k3 + k4);
  }
  /// One column per curve.
  Eigen::MatrixXd free_parts() const { return phi_(Eigen::all, tracker_.free_).transpose(); }

 private:
  Eigen::MatrixXd moved(double h, const Eigen::MatrixXd& slopes) const {
    Eigen::MatrixXd out = phi_;
    out(Eigen::all, tracker_.free_) += h * slopes;
    return out;
  }

  /// As NullTracker::slope, of the free joints.
  const Eigen::MatrixXd& slope(double s, const Eigen::MatrixXd& phi) {
    const NullSpaceOptions& options = tracker_.options_;
    const ReferenceWeights at = reference_weights(knots_, s);
    const JointVectord along = pulled_along(knots_, at, options.pull);
    batch_.phi = phi;
    batch_.wanted = -options.pull * phi(Eigen::all, tracker_.free_);
    batch_.wanted.rowwise() += along.transpose();
    batch_.wanted.diagonal().array() +=
        options.difference * (at.slope_of(knot_) + options.pull * at.value_of(knot_));
    find_null_velocities(tracker_.robot_, tracker_.free_, batch_);
    for (Eigen::Index i = 0; i < phi.rows(); ++i) {
      if (batch_.conditioning[i] > options.well_conditioned) continue;
      batch_.phidot.row(i) =
          tracker_.projected_by_rank(phi.row(i).transpose(), batch_.wanted.row(i).transpose());
    }
    return batch_.phidot;
  }

  const NullTracker& tracker_;
  const Knots& knots_;
  const Eigen::Index knot_;
  Eigen::MatrixXd phi_;  // curves x n
  NullVelocities batch_;
};

Eigen::MatrixXd NullTracker::end_jacobian(const Knots& knots) const {
  const int steps = options_.coarse_steps;
  const JointPath curve = follow(knots, steps);
  const Eigen::Index m = knots.rows(), count = knots.cols() - 1;
  const auto total = static_cast<int>(count) * steps;
  const Eigen::VectorXd end = free_part(curve.phi.back());
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(m, m * count);
  for_each_index(jobs_, static_cast<int>(count), stop_, [&](int knots_before) {
    const Eigen::Index k = knots_before + 1;
    // A knot bends the reference from two knots before it on.
    const int from = static_cast<int>(std::max<Eigen::Index>(k - 2, 0)) * steps;
    Beside curves(*this, knots, k, curve.phi[static_cast<std::size_t>(from)]);
    for (int i = from; i < total; ++i) curves.step(static_cast<double>(i) / total, 1.0 / total);
    J.middleCols(knots_before * m, m) = (curves.free_parts().colwise() - end) / options_.difference;
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

Knots NullTracker::bent(const Knots& knots, const Eigen::VectorXd& push, double stride) const {
  const Eigen::MatrixXd J = end_jacobian(knots);
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
  // d(end less goal) / d(knots). It costs as much as many curves, so a step updates it by what the
  // step itself has shown (Broyden), for as long as steps go well.
  Eigen::MatrixXd J;
  bool is_updated = false;
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
    if (J.size() == 0) {
      J = directions_asked(goal, curve.phi.back()) * end_jacobian(knots);
      is_updated = false;
    }
    const Eigen::MatrixXd square = J * J.transpose();
    bool better = false;
    const int dampings = is_updated ? options_.dampings_of_update : options_.dampings;
    for (int trial = 0; trial < dampings && !better && !stop_.reached(); ++trial) {
      const Eigen::MatrixXd damped = square + damping * Eigen::MatrixXd::Identity(m, m);
      const Eigen::VectorXd shift = J.transpose() * damped.ldlt().solve(error);
      Knots there = shifted_knots(knots, shift);
      JointPath moved = follow(there, steps);
      const Eigen::VectorXd left = missing(moved);
      better = left.norm() < error.norm();
      damping = better ? damping / 8 : damping * 6;
      if (!better) continue;
      const Eigen::VectorXd step = (there - knots).rightCols(knots.cols() - 1).reshaped();
      J += (error - left - J * step) * step.transpose() / step.squaredNorm();
      is_updated = true;
      if (left.norm() > options_.good_step * error.norm()) J.resize(0, 0);
      knots = std::move(there);
      curve = std::move(moved);
    }
    if (better) continue;
    if (!is_updated) return std::nullopt;
    J.resize(0, 0);
  }
  return std::nullopt;
}

}  // namespace stillbase
