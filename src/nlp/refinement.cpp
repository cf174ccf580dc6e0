#include "nlp/refinement.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include <stillbase/core/linear_algebra.hpp>
#include <stillbase/nlp/certificate.hpp>

#include "nlp/restoration.hpp"

namespace stillbase::nlp {

namespace {

/// Rows and bounds that hold with equality at a minimum: their gradients, and what is missing.
struct Active {
  Eigen::MatrixXd normals;  ///< columns (N x k)
  Eigen::VectorXd missing;  ///< bound minus value (k)
};

/// What is known of a point.
struct Known {
  Evaluation at;
  Certificate certificate;

  /// Whether the same rows and bounds balance the gradient.
  bool has_active_set_of(const Known& other) const {
    const auto same = [](const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
      return ((a.array() != 0) == (b.array() != 0)).all();
    };
    return same(certificate.multipliers, other.certificate.multipliers) &&
           same(certificate.bound_multipliers, other.certificate.bound_multipliers);
  }
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
        along_flat_(Eigen::VectorXd::Zero(lower_.size())),
        beyond_(Eigen::VectorXd::Zero(g_lower_.size())) {}

  Eigen::VectorXd from(const Eigen::VectorXd& x0) {
    if (!is_stationary_at(x0)) return x0;
    violation_ = std::max(options_.feasible, here_.certificate.max_violation);
    Eigen::VectorXd minimum = converged(x0);
    if (!has_flat_ || !is_stationary_at(minimum)) return minimum;
    const double residual = here_.certificate.kkt_residual;
    Eigen::VectorXd x = minimum;
    along_flat_ = (x0 / options_.grid).array().round().matrix() * options_.grid - x;
    const std::optional<Eigen::VectorXd> d = step(x);
    if (!d || length(*d) > options_.longest_step || !move(x, *d)) return minimum;
    along_flat_.setZero();
    x = converged(x);
    return is_stationary_at(x) && is_acceptable(residual) ? x : minimum;
  }

 private:
  /// The last of Newton's steps from x, of which all is known, that is no worse than the ones
  /// before.
  Eigen::VectorXd converged(Eigen::VectorXd x) {
    Eigen::VectorXd best = x;
    double least = here_.certificate.kkt_residual, longest = options_.longest_step;
    for (int k = 0; k < options_.most_steps; ++k) {
      const std::optional<Eigen::VectorXd> d = step(x);
      // Too long at first: no minimum is near. Later: rounding alone is left.
      if (!d || !(length(*d) <= longest)) break;
      longest = length(*d) / 2;
      const Known before = here_;
      if (!move(x, *d)) break;
      if (is_bend_ || !here_.has_active_set_of(before)) {  // other directions are curved now
        longest = options_.longest_step;
        H_.resize(0, 0);
      }
      if (!is_acceptable(least)) continue;
      best = x;
      least = std::min(least, here_.certificate.kkt_residual);
    }
    return best;
  }

  static double length(const Eigen::VectorXd& d) { return d.lpNorm<Eigen::Infinity>(); }

  /// Of the point that was evaluated last, beside one with this residual.
  bool is_acceptable(double residual) const {
    return here_.certificate.max_violation <= violation_ &&
           here_.certificate.kkt_residual <= std::max(options_.stationary, residual);
  }

  /// Moves x by a step. Whether it is still where a minimum may be.
  bool move(Eigen::VectorXd& x, const Eigen::VectorXd& d) {
    const Known before = here_;
    Eigen::VectorXd there = inside(x + d);
    if (!is_stationary_at(there)) {
      // The minimum is at a kink of a row, the least of several distances, where another one is the
      // least beyond it. A little farther out the row is still the one that it was.
      if (!mark_kinks(before)) return false;
      here_ = before;
      const std::optional<Eigen::VectorXd> other = step(x);
      if (!other) return false;
      there = inside(x + *other);
      if (!is_stationary_at(there)) return false;
    }
    x = there;
    return true;
  }

  /// Inequalities that count and have another gradient at the point that was evaluated last.
  bool mark_kinks(const Known& before) {
    bool has_new = false;
    for (Eigen::Index i = 0; i < g_lower_.size(); ++i) {
      const double other = (here_.at.jacobian.row(i) - before.at.jacobian.row(i)).norm();
      const bool counts =
          g_lower_[i] != g_upper_[i] && before.certificate.multipliers[i] != 0 && beyond_[i] == 0;
      if (other <= options_.other_slope || !counts) continue;
      beyond_[i] = options_.beyond_kink;
      has_new = true;
    }
    return has_new;
  }

  Eigen::VectorXd inside(const Eigen::VectorXd& x) const {
    return x.cwiseMax(lower_).cwiseMin(upper_);
  }

  bool is_stationary_at(const Eigen::VectorXd& x) {
    problem_.evaluate(x, here_.at);
    here_.certificate = certify(problem_, x, here_.at, {.activity_tolerance = options_.active});
    return here_.certificate.kkt_residual <= options_.near;
  }

  Active active_at(const Eigen::VectorXd& x) const {
    std::vector<Eigen::VectorXd> normals;
    std::vector<double> missing;
    const auto add = [&](const auto& normal, double value, double lower, double upper,
                         double multiplier, double beyond) {
      if (lower != upper && multiplier == 0) return;
      normals.emplace_back(normal);
      missing.push_back((multiplier > 0 ? upper + beyond : lower - beyond) - value);
    };
    for (Eigen::Index i = 0; i < here_.at.constraints.size(); ++i) {
      add(here_.at.jacobian.row(i).transpose(), here_.at.constraints[i], g_lower_[i], g_upper_[i],
          here_.certificate.multipliers[i], beyond_[i]);
    }
    for (Eigen::Index j = 0; j < x.size(); ++j) {
      add(Eigen::VectorXd::Unit(x.size(), j), x[j], lower_[j], upper_[j],
          here_.certificate.bound_multipliers[j], 0);
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

  /// The step of Newton's method, and `along_flat_` along flat directions; nothing at a saddle, or
  /// where a number is not finite.
  std::optional<Eigen::VectorXd> step(const Eigen::VectorXd& x) {
    const Active active = active_at(x);
    Eigen::VectorXd d = Eigen::VectorXd::Zero(x.size());
    Eigen::MatrixXd Z = Eigen::MatrixXd::Identity(x.size(), x.size());
    if (active.normals.cols() > 0) {
      d = shortest_step(active.normals.transpose(), active.missing);
      Z = PivotedQr(active.normals).complement();
    }
    has_flat_ = is_bend_ = false;
    if (Z.cols() == 0) return d;
    const bool is_new = H_.size() == 0 || open_ != Z.cols();
    if (is_new) H_ = hessian(x, Z);
    open_ = Z.cols();
    if (!H_.allFinite()) return std::nullopt;
    const SymmetricEigen curvature = symmetric_eigen(Z.transpose() * H_ * Z);
    const Eigen::MatrixXd axes = Z * curvature.vectors;
    const Eigen::VectorXd slope = axes.transpose() * (here_.at.gradient + H_ * d);
    const Eigen::VectorXd flat_part = axes.transpose() * along_flat_;
    if (is_new) set_flat(slope);
    if (curvature.values[0] < -flat_) return std::nullopt;
    has_flat_ = curvature.values[0] <= flat_;
    is_bend_ = has_flat_ && flat_ > rounding_;
    for (Eigen::Index i = 0; i < axes.cols(); ++i) {
      const double curved = curvature.values[i];
      d += axes.col(i) * (curved <= flat_ ? flat_part[i] : -slope[i] / curved);
    }
    return d;
  }

  /// Curvature that may be none: rounding of the Hessian, or the bend of an orbit of equal values
  /// beside which x lies, where the slope across it appears as a curvature along it. A minimum that
  /// so little curvature places is farther off than the longest step.
  void set_flat(const Eigen::VectorXd& slope) {
    rounding_ = problem_.has_hessian() ? options_.flat * H_.norm()
                                       : options_.flat_by_differences * std::max(H_.norm(), 1.0);
    flat_ = std::max(rounding_, options_.bend * slope.lpNorm<Eigen::Infinity>());
  }

  /// Of the Lagrangian at x. Without second derivatives of the problem as far as steps along the
  /// columns of Z and their slopes need it: H Z by differences, zero between two directions across.
  Eigen::MatrixXd hessian(const Eigen::VectorXd& x, const Eigen::MatrixXd& Z) const {
    if (problem_.has_hessian()) {
      Eigen::MatrixXd H;
      problem_.lagrangian_hessian(x, 1, here_.certificate.multipliers, H);
      return H;
    }
    constexpr double kRounding = 1e-9;  // of unit vectors
    Evaluation there;
    const auto slope_at = [&](const Eigen::VectorXd& beside) -> Eigen::VectorXd {
      problem_.evaluate(beside, there);
      return there.gradient + there.jacobian.transpose() * here_.certificate.multipliers;
    };
    const auto along = [&](const Eigen::VectorXd& v, double ahead, double back) -> Eigen::VectorXd {
      const Eigen::VectorXd above = slope_at(inside(x + ahead * v));
      return (above - slope_at(inside(x - back * v))) / (ahead + back);
    };
    const double h = options_.difference;
    Eigen::MatrixXd HZ = Eigen::MatrixXd::Zero(Z.rows(), Z.cols()), roomy = Z;
    // Variables at their bounds go one way, each by itself: together they might go none.
    for (Eigen::Index j = 0; j < x.size(); ++j) {
      const double ahead = std::min(h, upper_[j] - x[j]), back = std::min(h, x[j] - lower_[j]);
      if (std::min(ahead, back) >= h || Z.row(j).norm() <= kRounding) continue;
      roomy.row(j).setZero();
      if (ahead + back < h / 2) continue;  // it is as good as fixed
      HZ += along(Eigen::VectorXd::Unit(x.size(), j), ahead, back) * Z.row(j);
    }
    for (Eigen::Index j = 0; j < Z.cols(); ++j) HZ.col(j) += along(roomy.col(j), h, h);
    const Eigen::MatrixXd ZHZ = Z.transpose() * HZ;
    const Eigen::MatrixXd mixed = (HZ - Z * ZHZ) * Z.transpose();  // one across, one along
    return Z * ((ZHZ + ZHZ.transpose()) / 2) * Z.transpose() + mixed + mixed.transpose();
  }

  const Problem& problem_;
  const RefinementOptions& options_;
  const Eigen::VectorXd lower_, upper_, g_lower_, g_upper_;
  Eigen::VectorXd along_flat_;  // what steps go along flat directions
  Eigen::VectorXd beyond_;      // the bound of each row, where it has a kink
  Eigen::MatrixXd H_;           // of the Lagrangian, while the active set is one: x hardly moves
  Eigen::Index open_ = 0;       // directions that the active set leaves open
  double rounding_ = 0;         // of its curvatures
  double flat_ = 0;             // curvature that may be none, where H was taken
  double violation_ = 0;        // the largest acceptable one
  bool has_flat_ = false;       // whether the last step knew a flat direction,
  bool is_bend_ = false;        // and it may be one for its slope alone
  Known here_;                  // of the point that was evaluated last
};

}  // namespace

Eigen::VectorXd refined_minimum(const Problem& problem, const Eigen::VectorXd& x,
                                const RefinementOptions& options) {
  return Refinement(problem, options).from(x);
}

}  // namespace stillbase::nlp
