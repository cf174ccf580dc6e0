#include <stillbase/encounter/residual_velocity.hpp>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <stillbase/core/linear_algebra.hpp>
#include <stillbase/encounter/direction_cone.hpp>
#include <stillbase/encounter/target_motion.hpp>
#include <stillbase/plan/feature.hpp>

namespace stillbase {

namespace {

using Series = std::vector<Matrix6d>;

constexpr std::size_t kFewestNodes = 9, kMostNodes = 1025;
constexpr double kTail = 1e-11;       ///< of the last coefficients, relative to the largest
constexpr double kZeroPivot = 1e-12;  ///< relative to the diagonal before elimination

Matrix6d turned(const Matrix3d& R, const Matrix6d& A) {
  Matrix6d both = Matrix6d::Zero();
  both.topLeftCorner<3, 3>() = both.bottomRightCorner<3, 3>() = R;
  return both * A;
}

Matrix6d symmetric_root(const Matrix6d& covariance) {
  const SymmetricEigen eigen = symmetric_eigen(covariance);
  return eigen.vectors * eigen.values.cwiseMax(0).cwiseSqrt().asDiagonal() *
         eigen.vectors.transpose();
}

/// The Cholesky factor of the covariance with the angular part in front, its rows in the old order.
Matrix6d cholesky_root(const Matrix6d& covariance) {
  constexpr int kOrder[] = {3, 4, 5, 0, 1, 2};
  Matrix6d root = Matrix6d::Zero();
  for (int j = 0; j < 6; ++j) {
    const double diagonal = covariance(kOrder[j], kOrder[j]);
    const double pivot = diagonal - root.row(kOrder[j]).head(j).squaredNorm();
    if (!(pivot > kZeroPivot * diagonal)) continue;
    const double divisor = std::sqrt(pivot);
    root(kOrder[j], j) = divisor;
    for (int i = j + 1; i < 6; ++i) {
      const double left = root.row(kOrder[i]).head(j).dot(root.row(kOrder[j]).head(j));
      root(kOrder[i], j) = (covariance(kOrder[i], kOrder[j]) - left) / divisor;
    }
  }
  return root;
}

/// Roots at instants, in T.
std::vector<Matrix6d> roots_at(const CaptureProblem& problem, const TargetMotion& motion,
                               const std::vector<double>& times) {
  const ResidualVelocity& residual = *problem.uncertainty.residual_velocity;
  const auto R_TN = [&motion](double time) {
    return Matrix3d(motion.state(time).pose.orientation.conjugate().toRotationMatrix());
  };
  std::vector<Matrix6d> out;
  if (residual.covariance) {
    const Matrix6d root = symmetric_root(*residual.covariance);
    const bool in_target = residual.frame == ResidualFrame::Target;
    for (const double time : times) out.push_back(in_target ? root : turned(R_TN(time), root));
    return out;
  }
  out = predict_velocity({*problem.target, problem.target_state},
                         covariance_of(*problem.target_deviations), chosen_feature(problem), times);
  for (std::size_t i = 0; i < times.size(); ++i) {
    const Matrix3d R = R_TN(times[i]);
    Matrix6d covariance = turned(R, turned(R, out[i]).transpose());
    covariance.diagonal().head<3>().array() += std::pow(residual.linear_tracking, 2);
    covariance.diagonal().tail<3>().array() += std::pow(residual.angular_tracking, 2);
    out[i] = cholesky_root(covariance);
  }
  return out;
}

/// Coefficients of the interpolation at the nodes cos(pi (j + 1/2) / N).
Series interpolation(const std::vector<Matrix6d>& values) {
  const std::size_t N = values.size();
  Series out(N, Matrix6d::Zero());
  for (std::size_t k = 0; k < N; ++k) {
    for (std::size_t j = 0; j < N; ++j) {
      const double angle = kPi * static_cast<double>(k) * (static_cast<double>(j) + 0.5);
      out[k] += std::cos(angle / static_cast<double>(N)) * values[j];
    }
    out[k] *= (k == 0 ? 1.0 : 2.0) / static_cast<double>(N);
  }
  return out;
}

/// Cut behind the last coefficient that counts; false when all of them do. Rows have units of their
/// own.
bool shorten(Series& series) {
  Vector6d largest = Vector6d::Zero();
  for (const Matrix6d& c : series) largest = largest.cwiseMax(c.rowwise().norm());
  const auto counts = [&largest](const Matrix6d& c) {
    return ((c.rowwise().norm() - kTail * largest).array() > 0).any();
  };
  const auto last = std::find_if(series.rbegin(), series.rend(), counts);
  const auto size = static_cast<std::size_t>(series.rend() - last);
  // The last third of the coefficients has to be small, not the very last one by chance.
  const bool is_converged = 3 * size <= 2 * series.size() + 2;
  if (is_converged) series.resize(std::max<std::size_t>(size, 1));
  return is_converged;
}

/// d/dt: c'_(k-1) = c'_(k+1) + 2 k c_k, over half the window.
Series derivative(const Series& series, double half) {
  const std::size_t N = series.size();
  if (N == 1) return {Matrix6d::Zero()};
  Series out(N + 1, Matrix6d::Zero());
  for (std::size_t k = N - 1; k >= 1; --k) {
    out[k - 1] = out[k + 1] + 2 * static_cast<double>(k) * series[k];
  }
  out[0] /= 2;
  out.resize(N - 1);
  for (Matrix6d& c : out) c /= half;
  return out;
}

/// Clenshaw's sum of c_k T_k(x).
template <class Coefficient, class Value>
Value chebyshev_sum(std::size_t count, double x, const Coefficient& coefficient,
                    const Value& zero) {
  Value after = zero, next = zero;
  for (std::size_t k = count - 1; k >= 1; --k) {
    const Value here = coefficient(k) + 2 * x * next - after;
    after = next;
    next = here;
  }
  return coefficient(0) + x * next - after;
}

}  // namespace

ResidualRoot::ResidualRoot(const CaptureProblem& problem) {
  const double lower = problem.variables.contact_time_lower;
  const double upper = problem.variables.contact_time_upper;
  const ResidualVelocity& residual = *problem.uncertainty.residual_velocity;
  if (!residual.covariance) {
    const double start = problem.target_state.time;
    const double duration = std::max(std::abs(lower - start), std::abs(upper - start));
    const TargetEstimate estimate{*problem.target, problem.target_state};
    if (!(rotation_bound(estimate, *problem.target_deviations, duration) <=
          kMaxPredictedRotation)) {
      throw std::invalid_argument(
          "the target may rotate by more than 300 rad from its estimate to the contact; its "
          "velocity cannot be predicted");
    }
  }
  const TargetMotion motion(*problem.target, problem.target_state, motion_horizon(problem));
  middle_ = (lower + upper) / 2;
  const bool is_constant = residual.covariance && residual.frame == ResidualFrame::Target;
  if (is_constant || !(upper > lower)) {
    series_[0] = roots_at(problem, motion, {middle_});
  } else {
    half_ = (upper - lower) / 2;
    for (std::size_t N = kFewestNodes; series_[0].empty(); N = 2 * N - 1) {
      if (N > kMostNodes) {
        throw std::invalid_argument(
            "the covariance of the relative velocity at the contact changes too much to be "
            "followed "
            "over the contact times: it is close to a singular one (state hand_tracking), or the "
            "target's estimate is too uncertain (smaller deviations, a shorter "
            "variables.contact_time)");
      }
      std::vector<double> times;
      for (std::size_t j = 0; j < N; ++j) {
        const double angle = kPi * (static_cast<double>(j) + 0.5) / static_cast<double>(N);
        times.push_back(middle_ + half_ * std::cos(angle));
      }
      Series series = interpolation(roots_at(problem, motion, times));
      if (shorten(series)) series_[0] = std::move(series);
    }
  }
  series_[1] = derivative(series_[0], half_);
  series_[2] = derivative(series_[1], half_);
}

double ResidualRoot::argument(double time) const { return (time - middle_) / half_; }

Matrix6d ResidualRoot::at(double time, int order) const {
  const Series& series = series_[static_cast<std::size_t>(order)];
  return chebyshev_sum(
      series.size(), argument(time), [&series](std::size_t k) { return series[k]; },
      Matrix6d(Matrix6d::Zero()));
}

Vector6d ResidualRoot::applied(const Vector6d& s, double time, int order) const {
  const Series& series = series_[static_cast<std::size_t>(order)];
  return chebyshev_sum(
      series.size(), argument(time), [&](std::size_t k) -> Vector6d { return series[k] * s; },
      Vector6d(Vector6d::Zero()));
}

Matrix6d ResidualRoot::covariance(double time) const {
  const Matrix6d root = at(time);
  return root * root.transpose();
}

}  // namespace stillbase
