#include "nlp/refinement.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include <stillbase/core/linear_algebra.hpp>
#include <stillbase/nlp/certificate.hpp>

namespace stillbase::nlp {

namespace {

/// Rows and bounds that hold with equality at a minimum: their gradients, and what is missing.
struct Active {
  Eigen::MatrixXd normals;  ///< columns (N x k)
  Eigen::VectorXd missing;  ///< bound minus value (k)
};

class Refinement {
 public:
  Refinement(const Problem& problem, const RefinementOptions& options)
      : problem_(problem),
        options_(options),
        lower_(problem.lower()),
        upper_(problem.upper()),
        g_lower_(problem.constraint_lower()),
        g_upper_(problem.constraint_upper()),
        beyond_(Eigen::VectorXd::Zero(g_lower_.size())) {}

  Eigen::VectorXd from(const Eigen::VectorXd& x0) {
    Eigen::VectorXd x = x0;
    if (!is_stationary_at(x)) return x0;
    const double violation = std::max(options_.feasible, certificate_.max_violation);
    const double residual = std::max(options_.stationary, certificate_.kkt_residual);
    const Eigen::VectorXd to_grid =
        (x0 / options_.grid).array().round().matrix() * options_.grid - x0;
    const Eigen::VectorXd none = Eigen::VectorXd::Zero(x0.size());
    Eigen::VectorXd best = x0;
    double shortest = options_.longest_step;
    for (int k = 0; k < options_.most_steps; ++k) {
      along_flat_ = k == 0 ? to_grid : none;
      const std::optional<Eigen::VectorXd> d = step(x);
      if (!d) break;
      const double length = d->lpNorm<Eigen::Infinity>();
      if (!(length <= shortest)) break;  // at first: no minimum near; then: rounding alone is left
      shortest = length / 2;
      if (!move(x, *d)) break;
      if (certificate_.max_violation <= violation && certificate_.kkt_residual <= residual)
        best = x;
    }
    return best;
  }

 private:
  /// Moves x by a step. Whether it is still where a minimum may be.
  bool move(Eigen::VectorXd& x, const Eigen::VectorXd& d) {
    const Eigen::VectorXd there = inside(x + d);
    const Evaluation before = at_;
    const Certificate certificate = certificate_;
    if (!is_stationary_at(there)) {
      // The minimum is at a kink of a row, the least of several distances, where another row is
      // the distance beyond it. A little farther out the row is still the one that it was.
      if (!mark_kinks(before, certificate)) return false;
      at_ = before;
      certificate_ = certificate;
      const std::optional<Eigen::VectorXd> other = step(x);
      if (!other || !is_stationary_at(inside(x + *other))) return false;
      x = inside(x + *other);
      return true;
    }
    x = there;
    return true;
  }

  /// Rows that count and have another gradient at the point that was evaluated last.
  bool mark_kinks(const Evaluation& before, const Certificate& certificate) {
    bool has_new = false;
    for (Eigen::Index i = 0; i < at_.constraints.size(); ++i) {
      const bool is_other =
          !((at_.jacobian.row(i) - before.jacobian.row(i)).norm() <= options_.other_slope);
      if (!is_other || certificate.multipliers[i] == 0 || beyond_[i] > 0) continue;
      beyond_[i] = options_.beyond_kink;
      has_new = true;
    }
    return has_new;
  }

  Eigen::VectorXd inside(const Eigen::VectorXd& x) const {
    return x.cwiseMax(lower_).cwiseMin(upper_);
  }

  bool is_stationary_at(const Eigen::VectorXd& x) {
    return evaluate(x) && certificate_.kkt_residual <= options_.near;
  }

  bool evaluate(const Eigen::VectorXd& x) {
    problem_.evaluate(x, at_);
    certificate_ = certify(problem_, x, at_, {.activity_tolerance = options_.active});
    return std::isfinite(certificate_.kkt_residual);
  }

  Active active_at(const Eigen::VectorXd& x) const {
    std::vector<Eigen::VectorXd> normals;
    std::vector<double> missing;
    const auto add = [&](const Eigen::VectorXd& normal, double value, double lower, double upper,
                         double multiplier, double beyond) {
      if (lower != upper && multiplier == 0) return;
      normals.push_back(normal);
      missing.push_back((multiplier > 0 ? upper + beyond : lower - beyond) - value);
    };
    for (Eigen::Index i = 0; i < at_.constraints.size(); ++i) {
      add(at_.jacobian.row(i).transpose(), at_.constraints[i], g_lower_[i], g_upper_[i],
          certificate_.multipliers[i], beyond_[i]);
    }
    for (Eigen::Index j = 0; j < x.size(); ++j) {
      add(Eigen::VectorXd::Unit(x.size(), j), x[j], lower_[j], upper_[j],
          certificate_.bound_multipliers[j], 0);
    }
    Active out;
    const auto count = static_cast<Eigen::Index>(normals.size());
    out.normals.resize(x.size(), count);
    out.missing.resize(count);
    for (Eigen::Index c = 0; c < count; ++c) {
      out.normals.col(c) = normals[static_cast<std::size_t>(c)];
      out.missing[c] = missing[static_cast<std::size_t>(c)];
    }
    return out;
  }

  /// The step of Newton's method; nothing at a saddle, or where a number is not finite.
  std::optional<Eigen::VectorXd> step(const Eigen::VectorXd& x) const {
    const Active active = active_at(x);
    const Eigen::MatrixXd H = hessian(x);
    if (!H.allFinite()) return std::nullopt;
    Eigen::VectorXd d = Eigen::VectorXd::Zero(x.size());
    Eigen::MatrixXd Z = Eigen::MatrixXd::Identity(x.size(), x.size());
    if (active.normals.cols() > 0) {
      constexpr double kIndependent = 1e-9;
      d = least_norm_solution(active.normals.transpose(), active.missing, kIndependent);
      Z = PivotedQr(active.normals).complement();
    }
    if (Z.cols() == 0) return d;
    const SymmetricEigen curvature = symmetric_eigen(Z.transpose() * H * Z);
    const double rounding =
        (problem_.has_hessian() ? options_.flat : options_.flat_by_differences) *
        curvature.values.lpNorm<Eigen::Infinity>();
    if (curvature.values[0] < -rounding) return std::nullopt;
    const Eigen::MatrixXd axes = Z * curvature.vectors;
    const Eigen::VectorXd slope = axes.transpose() * (at_.gradient + H * d);
    const Eigen::VectorXd flat = axes.transpose() * along_flat_;
    for (Eigen::Index i = 0; i < axes.cols(); ++i) {
      const bool is_flat = curvature.values[i] <= rounding;
      d += axes.col(i) * (is_flat ? flat[i] : -slope[i] / curvature.values[i]);
    }
    return d;
  }

  /// Of the Lagrangian at x.
  Eigen::MatrixXd hessian(const Eigen::VectorXd& x) const {
    Eigen::MatrixXd H;
    if (problem_.has_hessian()) {
      problem_.lagrangian_hessian(x, 1, certificate_.multipliers, H);
      return H;
    }
    H.setZero(x.size(), x.size());
    Evaluation there;
    const auto slope_at = [&](Eigen::Index j, double xj) -> Eigen::VectorXd {
      Eigen::VectorXd beside = x;
      beside[j] = xj;
      problem_.evaluate(beside, there);
      return there.gradient + there.jacobian.transpose() * certificate_.multipliers;
    };
    for (Eigen::Index j = 0; j < x.size(); ++j) {
      const double above = std::min(x[j] + options_.difference, upper_[j]);
      const double below = std::max(x[j] - options_.difference, lower_[j]);
      if (above > below) H.col(j) = (slope_at(j, above) - slope_at(j, below)) / (above - below);
    }
    return (H + H.transpose()) / 2;
  }

  const Problem& problem_;
  const RefinementOptions& options_;
  const Eigen::VectorXd lower_, upper_, g_lower_, g_upper_;
  Eigen::VectorXd along_flat_;  // what a step goes along flat directions
  Eigen::VectorXd beyond_;      // the bound of each row, where it has a kink
  Evaluation at_;               // of the point that was evaluated last
  Certificate certificate_;     // of the same
};

}  // namespace

Eigen::VectorXd refined_minimum(const Problem& problem, const Eigen::VectorXd& x,
                                const RefinementOptions& options) {
  return Refinement(problem, options).from(x);
}

}  // namespace stillbase::nlp
