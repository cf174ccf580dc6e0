// Is the chosen configuration a local minimum of the measure? Gradients and curvatures are
// differences of values by `reference` along the configurations that keep the equations.
#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include <fmt/format.h>

#include <stillbase/core/constants.hpp>
#include <stillbase/core/linear_algebra.hpp>

#include "audit/binding.hpp"
#include "audit/differences.hpp"
#include "audit/manifold.hpp"
#include "audit/smooth_parts.hpp"
#include "audit/tolerances.hpp"
#include "verification/arrival.hpp"

namespace stillbase::audit {

using namespace verification;

namespace {

/// Derivatives by differences, and how well they are known.
struct StationarityOptions {
  double gradient_step = 2e-3;   ///< rad, m, s; the longest
  double curvature_step = 1e-2;  ///< likewise
  double kink_step = 2.5e-4;     ///< likewise; what bends strongly is no kink within it
  double minimum = 1e-5;         ///< KKT residual of a minimum, by differences
  /// The same where each value is a simulation: two integrators agree to a part of 1e-5.
  double minimum_simulated = 1e-3;
  double slope_simulated = 1e-4;  ///< error of a slope there, relative to the largest one
  /// By how much the slopes of a limit on both sides may differ beyond its curvature, per unit of a
  /// step: more is a kink, as of two boxes that change their separating axis.
  double kink = 1e-3;
  /// Slopes of a limit per unit of a step, all of them smaller: differences do not tell it from one
  /// that nothing changes, as the distance of two bodies on one axis.
  double no_slope = 1e-7;
  /// Singular values of the limits' slopes, relative: two limits that are one, as of two bodies
  /// with a common end, differ by rounding alone.
  double same_limit = 1e-7;
  /// Least over largest singular value of what decides the joint rates of a hand that moves: below,
  /// they change within the shortest step of the differences.
  double smooth_match = 1e-3;
  double narrow_cone = 1e-4;     ///< rad: the longest steps are twenty times that
  double same_residual = 0.01;   ///< relative, between stated and recomputed large ones
  double same_curvature = 1e-3;  ///< relative, and of the largest curvature
  double no_curvature = 1e-9;    ///< smaller ones are compared as if of this size
  double same_bend = 1e-5;       ///< of two estimates of a curvature, relative to the largest one
  double no_descent = 1e-13;     ///< relative, of a slope of least squares: rounding
};
constexpr StationarityOptions kStationarity;

constexpr const char* kKinked =
    "an active limit has no gradient here: its slopes on both sides differ, as of the distance of "
    "boxes with two equally wide gaps";

/// min |C y + b| over y >= 0 (Lawson and Hanson, Solving Least Squares Problems, 1974).
Eigen::VectorXd nonnegative_solution(const Eigen::MatrixXd& C, const Eigen::VectorXd& b) {
  const Eigen::Index k = C.cols();
  Eigen::VectorXd y = Eigen::VectorXd::Zero(k);
  std::vector<Eigen::Index> used, refused;
  const auto is_in = [](const std::vector<Eigen::Index>& list, Eigen::Index j) {
    return std::find(list.begin(), list.end(), j) != list.end();
  };
  const auto over_used = [&] { return Eigen::VectorXd(-PivotedQr(C(Eigen::all, used)).solve(b)); };
  for (Eigen::Index pass = 0; pass < 3 * k + 10; ++pass) {
    const Eigen::VectorXd slope = -C.transpose() * (C * y + b);
    Eigen::Index entering = -1;
    double steepest = kStationarity.no_descent * b.norm();
    for (Eigen::Index j = 0; j < k; ++j) {
      const double relative = slope[j] / std::max(C.col(j).norm(), 1e-300);
      if (is_in(used, j) || is_in(refused, j) || relative <= steepest) continue;
      entering = j;
      steepest = relative;
    }
    if (entering < 0) break;
    used.push_back(entering);
    Eigen::VectorXd trial = over_used();
    if (trial[trial.size() - 1] <= 0) {  // a column that depends on the others
      used.pop_back();
      refused.push_back(entering);
      continue;
    }
    refused.clear();
    while (!used.empty() && trial.minCoeff() <= 0) {
      // As far towards the trial as no entry becomes negative; those that are zero then leave.
      double step = 1;
      for (std::size_t p = 0; p < used.size(); ++p) {
        const double to = trial[static_cast<Eigen::Index>(p)], from = y[used[p]];
        if (to <= 0) step = std::min(step, from / (from - to));
      }
      std::vector<Eigen::Index> kept;
      for (std::size_t p = 0; p < used.size(); ++p) {
        const double to = trial[static_cast<Eigen::Index>(p)], from = y[used[p]];
        const bool leaves = to <= 0 && from / (from - to) <= step;
        y[used[p]] = leaves ? 0 : from + step * (to - from);
        if (!leaves) kept.push_back(used[p]);
      }
      used = std::move(kept);
      if (!used.empty()) trial = over_used();
    }
    y.setZero();
    for (std::size_t p = 0; p < used.size(); ++p) y[used[p]] = trial[static_cast<Eigen::Index>(p)];
  }
  return y;
}

class Stationarity {
 public:
  Stationarity(const CaptureProblem& problem, const Configuration& at)
      : problem_(problem), here_(problem, at), manifold_(problem, at), parts_(here_) {
    const std::vector<double> distances = distances_from_limits(here_, &limits_);
    for (std::size_t i = 0; i < distances.size(); ++i) {
      if (std::abs(distances[i]) <= kRecord.reached) active_.push_back(i);
    }
    if (objection().empty()) differentiate();
  }

  /// Why nothing can be said; empty: it can.
  const std::string& objection() const {
    if (!manifold_.objection().empty()) return manifold_.objection();
    return parts_.objection().empty() ? objection_ : parts_.objection();
  }
  double residual() const { return residual_; }
  /// Whether an active limit has no gradient here, and those of both sides of its kink together
  /// with the others may make it a minimum.
  bool may_be_at_kink(double limit) const { return kinks_.cols() > 0 && kink_residual_ <= limit; }
  bool has_kink() const { return kinks_.cols() > 0; }
  /// Whether several features of two bodies are at their limit. A search has one distance of the
  /// bodies, with the gradient of one feature.
  bool has_equal_features() const {
    std::set<std::pair<std::string, bool>> ends;
    return std::any_of(active_.begin(), active_.end(), [&](std::size_t i) {
      return !ends.insert({limits_[i].name, limits_[i].is_upper}).second;
    });
  }
  Eigen::Index directions() const { return open_.cols(); }
  std::size_t active_limits() const { return active_.size(); }

  /// The limits that are reached, with their multipliers.
  /// @param error of the gradients' components by differences
  std::vector<ReachedLimit> reached(double error) const {
    const Eigen::Index parts = parts_.values(here_).size();
    const double value = parts_.values(here_).maxCoeff();
    Eigen::MatrixXd known(multipliers_.size(), 0);  // directions, by the sizes beside them
    Eigen::VectorXd sizes(0);
    if (system_.size() > 0) {
      const Svd svd = right_svd(system_);
      const Eigen::Index rank = numerical_rank(svd.sigma, kStationarity.same_limit);
      known = svd.V.leftCols(rank);
      sizes = svd.sigma.head(rank);
    }
    std::vector<ReachedLimit> out;
    for (std::size_t i = 0; i < active_.size(); ++i) {
      const NamedLimit& limit = limits_[active_[i]];
      const bool is_new = std::none_of(out.begin(), out.end(), [&](const ReachedLimit& other) {
        return other.limit.name == limit.name && other.limit.is_upper == limit.is_upper;
      });
      if (!is_new) continue;
      // All distances of one limit move with it.
      Eigen::VectorXd sum = Eigen::VectorXd::Zero(multipliers_.size());
      for (std::size_t j = i; j < active_.size(); ++j) {
        const NamedLimit& other = limits_[active_[j]];
        if (other.name != limit.name || other.is_upper != limit.is_upper) continue;
        sum[parts + static_cast<Eigen::Index>(j)] = 1 / value;
      }
      ReachedLimit& one = out.emplace_back();
      one.limit = limit;
      one.multiplier = sum.dot(multipliers_);
      const Eigen::VectorXd along = known.transpose() * sum;
      one.error = size_ * error * along.cwiseQuotient(sizes).norm();
      one.is_known = (known * along - sum).norm() <= kStationarity.same_limit * sum.norm();
    }
    return out;
  }

  /// Smallest curvature along the directions that the active limits leave open, and the largest.
  std::optional<std::pair<double, double>> curvature() {
    const Eigen::Index k = open_.cols();
    Eigen::MatrixXd H(k, k);
    for (Eigen::Index i = 0; i < k; ++i) {
      H(i, i) = second_derivative(open_.col(i));
      for (Eigen::Index j = 0; j < i; ++j) {
        H(i, j) = H(j, i) = (second_derivative(open_.col(i) + open_.col(j)) -
                             second_derivative(open_.col(i) - open_.col(j))) /
                            4;
      }
    }
    if (!objection_.empty()) return std::nullopt;
    const Eigen::VectorXd values = symmetric_eigenvalues(H);
    return std::pair(values[0], values[k - 1]);
  }

 private:
  /// Parts of the measure, then distances from the active limits.
  Eigen::VectorXd values_at(const Configuration& at) const {
    const Situation there(problem_, at);
    const Eigen::VectorXd parts = parts_.values(there);
    const std::vector<double> distances = distances_from_limits(there);
    Eigen::VectorXd out(parts.size() + static_cast<Eigen::Index>(active_.size()));
    out.head(parts.size()) = parts;
    for (std::size_t i = 0; i < active_.size(); ++i) {
      out[parts.size() + static_cast<Eigen::Index>(i)] = distances[active_[i]];
    }
    return out;
  }

  Eigen::VectorXd values_at(const Eigen::VectorXd& u) {
    if (const auto at = manifold_.at(u)) return values_at(*at);
    objection_ = "configurations beside it cannot be brought onto the equations";
    return values_at(here_.at);
  }

  void differentiate() {
    const Eigen::Index k = manifold_.dimension();
    const auto differences = [&](Eigen::Index count, const auto& value) {
      Eigen::MatrixXd out;
      for (Eigen::Index i = 0; i < count; ++i) {
        const Eigen::VectorXd slope =
            slopes_at_zero([&](double h) { return value(h * Eigen::VectorXd::Unit(count, i)); },
                           kStationarity.gradient_step);
        out.conservativeResize(slope.size(), count);
        out.col(i) = slope;
      }
      return out;
    };
    const Eigen::Index m = parts_.values(here_).size();
    if (k > 0) {
      Eigen::MatrixXd slopes =
          differences(k, [&](const Eigen::VectorXd& u) { return values_at(u); });
      const std::vector<bool> has_kink = find_kinks(m);
      // Two boxes pass a feature on one side of the configuration only: it has no distance on the
      // other.
      if (!slopes.allFinite() || !kinks_.allFinite()) {
        objection_ = kKinked;
        return;
      }
      leave_out_constant(m, has_kink, slopes);
      const Eigen::MatrixXd limits = slopes.bottomRows(slopes.rows() - m).transpose();
      find_multipliers(slopes.topRows(m).transpose(), limits);
      if (kinks_.cols() > 0) {
        Eigen::MatrixXd with_sides(k, limits.cols() + 2 * kinks_.cols());
        with_sides << limits, kinks_, -kinks_;
        kink_residual_ = nearest_to_zero(slopes.topRows(m).transpose(), with_sides).residual;
      }
      open_ = Eigen::MatrixXd::Identity(k, k);
      if (limits.cols() > 0) {
        const Svd svd = right_svd(limits.transpose());
        open_ = svd.V.rightCols(k - numerical_rank(svd.sigma, kStationarity.same_limit));
      }
    } else {
      multipliers_.setZero(m + static_cast<Eigen::Index>(active_.size()));
      open_.resize(0, 0);
    }
    if (is_lifted() || k == 0) return;
    // Relative to the gradient over all variables, where that is larger than one.
    const Eigen::MatrixXd all = differences(manifold_.variables(), [&](const Eigen::VectorXd& w) {
      return parts_.values(Situation(problem_, manifold_.beside(w)));
    });
    const double size = std::max(1.0, largest_component(all.transpose()));
    residual_ /= size;
    kink_residual_ /= size;
    size_ = size;
  }

  /// Where an active limit is the least of two functions that are equal here, its gradients on
  /// either side differ by a vector d: the limit's slope along u jumps by |d . u|. A column for
  /// each such limit.
  /// @param parts of the measure, which come before the limits among the values
  /// @return of each active limit whether it has a kink
  std::vector<bool> find_kinks(Eigen::Index parts) {
    const Eigen::Index n = manifold_.dimension(), m = static_cast<Eigen::Index>(active_.size());
    std::vector<bool> has_kink(active_.size(), false);
    kinks_.resize(n, 0);
    if (m == 0) return has_kink;
    const Eigen::VectorXd here = values_at(here_.at);
    // What is smooth bends twice as much over twice the step and drops out.
    const auto jumps = [&](const Eigen::VectorXd& direction) {
      const auto bend = [&](double step) {
        const Eigen::VectorXd u = step * direction;
        return Eigen::VectorXd((values_at(u) + values_at(Eigen::VectorXd(-u)) - 2 * here) / step);
      };
      return Eigen::VectorXd((2 * bend(kStationarity.kink_step) - bend(2 * kStationarity.kink_step))
                                 .segment(parts, m)
                                 .cwiseAbs());
    };
    Eigen::MatrixXd along(m, n);
    for (Eigen::Index k = 0; k < n; ++k) along.col(k) = jumps(Eigen::VectorXd::Unit(n, k));
    for (Eigen::Index i = 0; i < m; ++i) {
      Eigen::Index first = 0;
      const double largest = along.row(i).maxCoeff(&first);
      if (!(largest > kStationarity.kink)) continue;
      Eigen::VectorXd d = along.row(i).transpose();
      for (Eigen::Index k = 0; k < n; ++k) {
        if (k == first || !(d[k] > kStationarity.kink)) continue;
        const Eigen::VectorXd both = Eigen::VectorXd::Unit(n, first) + Eigen::VectorXd::Unit(n, k);
        const double jump = jumps(both)[i];
        const bool is_same_sign =
            std::abs(largest + d[k] - jump) < std::abs(std::abs(largest - d[k]) - jump);
        if (!is_same_sign) d[k] = -d[k];
      }
      has_kink[static_cast<std::size_t>(i)] = true;
      kinks_.conservativeResize(n, kinks_.cols() + 1);
      kinks_.col(kinks_.cols() - 1) = d;
    }
    return has_kink;
  }

  /// Limits that do not change beside the configuration leave the list of the active ones: their
  /// slopes are rounding, and a large enough multiple of rounding balances any gradient.
  /// @param slopes rows of the parts, then of the active limits
  void leave_out_constant(Eigen::Index parts, const std::vector<bool>& has_kink,
                          Eigen::MatrixXd& slopes) {
    std::vector<std::size_t> changing;
    std::vector<Eigen::Index> rows(static_cast<std::size_t>(parts));
    std::iota(rows.begin(), rows.end(), Eigen::Index{0});
    for (std::size_t i = 0; i < active_.size(); ++i) {
      const Eigen::Index row = parts + static_cast<Eigen::Index>(i);
      if (!has_kink[i] && slopes.row(row).cwiseAbs().maxCoeff() <= kStationarity.no_slope) continue;
      changing.push_back(active_[i]);
      rows.push_back(row);
    }
    active_ = std::move(changing);
    slopes = Eigen::MatrixXd(slopes(rows, Eigen::all));
  }

  /// Of the largest of several functions, a bound t of them is a variable of its own.
  bool is_lifted() const {
    const RiskMeasure kind = problem_.measure.kind;
    return kind == RiskMeasure::WorstCase || kind == RiskMeasure::Cvar;
  }

  /// Components over all variables as a plan counts them: the rotation vector in the base's axes.
  double largest_component(Eigen::VectorXd w) const {
    if (const int i = manifold_.rotation_vector(); i >= 0) {
      w.segment<3>(i) = problem_.base.orientation.conjugate() * Vector3d(w.segment<3>(i));
    }
    return w.cwiseAbs().maxCoeff();
  }

  struct Combination {
    Eigen::MatrixXd system;  ///< the gradients beside each other, then the sum of the weights
    Eigen::VectorXd multipliers;
    double residual = 0;
  };

  /// The combination of the parts' gradients, weights of sum one, and of the limits' that is
  /// nearest to zero.
  Combination nearest_to_zero(const Eigen::MatrixXd& parts, const Eigen::MatrixXd& limits) const {
    // Of the sum against the gradients: 1 for the gradient with respect to t.
    const double weight = is_lifted() ? 1 : 1e3;
    const Eigen::Index m = parts.cols(), k = parts.rows();
    Eigen::MatrixXd C = Eigen::MatrixXd::Zero(k + 1, m + limits.cols());
    C.topLeftCorner(k, m) = parts;
    C.topRightCorner(k, limits.cols()) = -limits;
    C.bottomLeftCorner(1, m).setConstant(weight);
    Eigen::VectorXd b = Eigen::VectorXd::Zero(k + 1);
    b[k] = -weight;
    Combination out;
    out.multipliers = nonnegative_solution(C, b);
    const double sum = out.multipliers.head(m).sum();
    if (!is_lifted()) out.multipliers /= sum;
    const Eigen::VectorXd left = C.topRows(k) * out.multipliers;
    out.residual = std::max(largest_component(manifold_.directions() * left),
                            is_lifted() ? std::abs(1 - sum) : 0.0);
    C.bottomRows(1) /= weight;
    out.system = std::move(C);
    return out;
  }

  void find_multipliers(const Eigen::MatrixXd& parts, const Eigen::MatrixXd& limits) {
    const Combination found = nearest_to_zero(parts, limits);
    multipliers_ = found.multipliers;
    system_ = found.system;
    residual_ = found.residual;
  }

  /// Of the Lagrangian along a direction u.
  double second_derivative(const Eigen::VectorXd& u) {
    const auto lagrangian = [&](double step) {
      const Eigen::VectorXd values = values_at(Eigen::VectorXd(step * u));
      const Eigen::Index m = values.size() - static_cast<Eigen::Index>(active_.size());
      return Eigen::VectorXd::Constant(
          1, values.head(m).dot(multipliers_.head(m)) -
                 values.tail(values.size() - m).dot(multipliers_.tail(values.size() - m)));
    };
    const double bend = bends_at_zero(lagrangian, kStationarity.curvature_step,
                                      kStationarity.same_bend * largest_curvature_)[0];
    largest_curvature_ = std::max(largest_curvature_, std::abs(bend));
    return bend;
  }

  const CaptureProblem& problem_;
  const Situation here_;
  FeasibleManifold manifold_;
  SmoothParts parts_;
  std::vector<NamedLimit> limits_;   ///< all
  std::vector<std::size_t> active_;  ///< of the distances from limits
  Eigen::VectorXd multipliers_;      ///< of the parts, then of the active limits
  Eigen::MatrixXd system_;           ///< of Combination; empty: no direction is open
  Eigen::MatrixXd open_;             ///< directions u that the active limits leave open
  double residual_ = 0;
  double size_ = 1;               ///< of the gradient over all variables, at least 1
  Eigen::MatrixXd kinks_;         ///< a column for each active limit with one
  double kink_residual_ = 0;      ///< with the gradients of both sides of every kink
  double largest_curvature_ = 0;  ///< of the directions so far
  std::string objection_;
};

void check_residual(const Context& context, const Stationarity& found, ClaimList& claims) {
  const double stated = context.plan.certificate.kkt_residual;
  const double limit =
      simulates_turn(context.problem) ? kStationarity.minimum_simulated : kStationarity.minimum;
  const std::string how = fmt::format(
      "first-order conditions by differences along the configurations that keep the equations, {} "
      "active limits",
      found.active_limits());
  if (found.residual() > limit && found.may_be_at_kink(limit)) {
    return claims.not_verified("kkt_residual", kKinked);
  }
  // Also a minimum that other candidates are better than is one.
  if (context.plan.status == PlanStatus::Optimal || stated <= kRecord.stationary) {
    claims.at_most("kkt_residual", found.residual(), limit, "1", how);
    return;
  }
  // A plan that is feasible only states a large one: at a kink that of one side.
  const bool is_of_one_side =
      found.residual() <= limit && stated > limit && found.has_equal_features();
  if (found.has_kink() || is_of_one_side) return claims.not_verified("kkt_residual", kKinked);
  if (context.problem.measure.kind == RiskMeasure::Cvar) {
    return claims.not_verified("kkt_residual", "samples at the quantile share their weight");
  }
  const double larger = std::max(stated, found.residual());
  if (context.problem.uncertainty.residual_velocity && std::min(stated, found.residual()) > limit) {
    return claims.not_verified(
        "kkt_residual", fmt::format("no minimum over the residual velocity, by {:.3g} stated and "
                                    "{:.3g} recomputed",
                                    stated, found.residual()));
  }
  claims.at_most("kkt_residual",
                 larger <= limit ? 0.0 : std::abs(stated - found.residual()) / larger,
                 kStationarity.same_residual, "1",
                 fmt::format("stated {:.6g} from {:.6g} recomputed, relative: {}", stated,
                             found.residual(), how));
}

void check_curvature(const Context& context, Stationarity& found, ClaimList& claims) {
  const char* const name = "reduced_curvature";
  const auto& stated = context.plan.certificate.reduced_hessian_min_eigenvalue;
  const RiskMeasure kind = context.problem.measure.kind;
  if (kind == RiskMeasure::Cvar) {
    return claims.not_verified(name, "the mean over a tail has no second derivative everywhere");
  }
  Objections objections;
  const bool is_stated =
      kind != RiskMeasure::WorstCase && !simulates_turn(context.problem) && found.directions() > 0;
  objections.demand(stated.has_value() == is_stated,
                    is_stated ? "the plan states none, but directions are left"
                              : "the plan states one, which this measure does not have here");
  if (!is_stated || !objections.none()) {
    return claims.none_wrong(name, objections, "smallest curvature along the remaining directions");
  }
  if (found.has_kink()) return claims.not_verified(name, kKinked);
  const auto curvature = found.curvature();
  if (!curvature) return claims.not_verified(name, found.objection());
  const double size = std::max(std::abs(curvature->first), std::abs(curvature->second));
  claims.at_most(name,
                 std::abs(*stated - curvature->first) / std::max(size, kStationarity.no_curvature),
                 kStationarity.same_curvature, "1",
                 fmt::format("stated {:.6g} from {:.6g} by differences, relative to the largest "
                             "curvature {:.3g}",
                             *stated, curvature->first, size));
}

/// Whether the measure is the norm of something that is nearly zero: smooth only within less than
/// the cone's half angle.
bool bends_at_once(const Context& context) {
  const ObjectiveValue& objective = context.plan.objective;
  const UncertaintySpec& uncertainty = context.problem.uncertainty;
  return context.problem.measure.kind == RiskMeasure::WorstCase && !uncertainty.residual_velocity &&
         uncertainty.cone_half_angle > 0 &&
         uncertainty.cone_half_angle < kStationarity.narrow_cone &&
         objective.nominal < objective.worst_case / 2;
}

}  // namespace

void check_stationarity(const Context& context, ClaimList& claims) {
  const Plan& plan = context.plan;
  // Where the base follows the path the minimum is that for the base as it arrives.
  CaptureProblem problem = context.problem;
  const ApproachSpec& approach = problem.approach;
  if (approach.enabled && approach.base == BaseMode::Floating && !approach.station_free) {
    problem.base = plan.configuration.base;
  }
  if (plan.status == PlanStatus::Limit || !plan.objective.is_judged) {
    return check_binding(context, limits_at(problem, plan.configuration),
                         "a limit ended the search", claims);
  }
  const bool simulates = simulates_turn(context.problem);
  const auto give_up = [&](const std::string& reason) {
    claims.not_verified("kkt_residual", reason);
    claims.not_verified("reduced_curvature", reason);
    check_binding(context, limits_at(problem, plan.configuration), reason, claims);
  };
  if (!plan.objective.user_terms.empty()) return give_up("the objective has terms of the user");
  if (simulates && context.problem.measure.kind != RiskMeasure::Nominal) {
    return give_up("each direction or sample is a simulation");
  }
  if (bends_at_once(context)) {
    return give_up(fmt::format(
        "a worst case over a cone of {:.3g} deg about a zero bends within the steps of differences",
        problem.uncertainty.cone_half_angle * 180 / kPi));
  }
  const double condition = match_condition({problem, plan.configuration});
  if (condition < kStationarity.smooth_match) {
    return give_up(fmt::format(
        "the posture is nearly singular for the components of the hand's velocity that it matches, "
        "least over largest singular value {:.2g}: differences say nothing of the joint rates; "
        "constraints.jacobian_singular_value_min keeps the search away",
        condition));
  }
  Stationarity found(problem, plan.configuration);
  if (!found.objection().empty()) return give_up(found.objection());
  check_residual(context, found, claims);
  check_curvature(context, found, claims);
  const double error =
      std::max(found.residual(), simulates ? kStationarity.slope_simulated : kRecord.stationary);
  check_binding(context, found.reached(error), found.has_kink() ? kKinked : "", claims);
}

}  // namespace stillbase::audit
