#include "search/nearest_zero.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <stillbase/core/constants.hpp>
#include <stillbase/core/linear_algebra.hpp>
#include <stillbase/core/parallel.hpp>
#include <stillbase/encounter/encounter.hpp>
#include <stillbase/nlp/certificate.hpp>
#include <stillbase/nlp/optimizer.hpp>
#include <stillbase/plan/turns.hpp>

#include "formulation/projection.hpp"
#include "formulation/variables/layout.hpp"
#include "nlp/refinement.hpp"

namespace stillbase {

namespace {

/// Components of y that vanish together where all of y does: M y, with independent slopes.
struct IndependentZeros {
  std::vector<Eigen::Index> rows;  ///< of y
  Eigen::MatrixXd M;               ///< their slopes beside the equations become orthonormal
};

IndependentZeros independent_zeros(const Formulation& formulation, const Eigen::VectorXd& zero,
                                   double dependent) {
  Eigen::VectorXd residual, y;
  Eigen::MatrixXd equations, J_y;
  evaluate_equations(formulation, zero, false, residual, equations);
  formulation.objective_vector(zero, y, J_y);
  std::vector<Eigen::VectorXd> basis;  // orthonormal
  const auto adds = [&](const Eigen::VectorXd& row) {
    Eigen::VectorXd across = row;
    for (int twice = 0; twice < 2; ++twice) {
      for (const Eigen::VectorXd& other : basis) across -= other.dot(across) * other;
    }
    if (!(across.norm() > dependent * std::max(1.0, row.norm()))) return false;
    basis.push_back(across.normalized());
    return true;
  };
  for (Eigen::Index i = 0; i < equations.rows(); ++i) adds(equations.row(i).transpose());
  const std::size_t of_equations = basis.size();
  IndependentZeros out;
  for (Eigen::Index i = 0; i < J_y.rows(); ++i) {
    if (adds(J_y.row(i).transpose())) out.rows.push_back(i);
  }
  // Their slopes over that basis, without what the equations take: lower triangular.
  const auto k = static_cast<Eigen::Index>(out.rows.size());
  Eigen::MatrixXd L = Eigen::MatrixXd::Zero(k, k);
  for (Eigen::Index i = 0; i < k; ++i) {
    for (Eigen::Index j = 0; j <= i; ++j) {
      L(i, j) = basis[of_equations + static_cast<std::size_t>(j)].dot(
          J_y.row(out.rows[static_cast<std::size_t>(i)]).transpose());
    }
  }
  out.M = L.triangularView<Eigen::Lower>().solve(Eigen::MatrixXd::Identity(k, k));
  return out;
}

/// The problem of this file's header.
class DistanceAmongZeros final : public nlp::Problem {
 public:
  DistanceAmongZeros(const CaptureProblem& problem, const Formulation& formulation,
                     const Eigen::VectorXd& zero, const NearestZeroOptions& options)
      : formulation_(formulation),
        zeros_(independent_zeros(formulation, zero, options.dependent)),
        options_(options) {
    const VariableLayout layout(problem);
    Configuration start = start_configuration(problem);
    weights_ = Eigen::VectorXd::Constant(zero.size(), options.attitude_weight);
    if (layout.time >= 0) {
      const double from = layout.lower[layout.time], half = (layout.upper[layout.time] - from) / 2;
      start.contact_time = from + half;
      weights_[layout.time] = options.time_weight / (half * half);
    }
    start_ = formulation.variables(start);
    const JointVectord way = way_from_start(problem, formulation.configuration(zero));
    for (std::size_t i = 0; i < layout.joints.size(); ++i) {
      const auto k = static_cast<Eigen::Index>(i);
      weights_[k] = 1;
      start_[k] = zero[k] - way[layout.joints[i]];
    }
  }

  int num_variables() const override { return formulation_.num_variables(); }
  int num_constraints() const override {
    return formulation_.num_constraints() + static_cast<int>(zeros_.rows.size());
  }
  Eigen::VectorXd lower() const override { return formulation_.lower(); }
  Eigen::VectorXd upper() const override { return formulation_.upper(); }
  Eigen::VectorXd constraint_lower() const override {
    return with_zeros(formulation_.constraint_lower());
  }
  Eigen::VectorXd constraint_upper() const override {
    return with_zeros(formulation_.constraint_upper());
  }

  void evaluate(const Eigen::VectorXd& x, nlp::Evaluation& out) const override {
    auto& here = out.workspace.as<Workspace>();
    const nlp::Evaluation& inner = here.inner;
    formulation_.evaluate_vector(x, here.inner, here.y, here.J_y);
    const Eigen::VectorXd away = x - start_;
    out.gradient = weights_.cwiseProduct(away);
    out.objective = away.dot(out.gradient) / 2;
    push_off(x, lower(), upper(), options_.bound_margin, out,
             [&](Eigen::Index i, double slope) { out.gradient[i] += slope; });
    push_off(inner.constraints, formulation_.constraint_lower(), formulation_.constraint_upper(),
             options_.row_margin, out, [&](Eigen::Index i, double slope) {
               out.gradient += slope * inner.jacobian.row(i).transpose();
             });
    const Eigen::Index m = inner.constraints.size();
    const auto more = static_cast<Eigen::Index>(zeros_.rows.size());
    out.constraints.resize(m + more);
    out.jacobian.resize(m + more, x.size());
    out.constraints.head(m) = inner.constraints;
    out.jacobian.topRows(m) = inner.jacobian;
    out.constraints.tail(more) = zeros_.M * here.y(zeros_.rows);
    out.jacobian.bottomRows(more) = zeros_.M * here.J_y(zeros_.rows, Eigen::all);
  }

 private:
  struct Workspace {
    nlp::Evaluation inner;
    Eigen::VectorXd y;
    Eigen::MatrixXd J_y;
  };

  /// Adds the second term of the objective for some values, and their slopes by `add`.
  template <class Add>
  void push_off(const Eigen::VectorXd& values, const Eigen::VectorXd& lower,
                const Eigen::VectorXd& upper, double most, nlp::Evaluation& out,
                const Add& add) const {
    for (Eigen::Index i = 0; i < values.size(); ++i) {
      const double margin = std::min(most, (upper[i] - lower[i]) / 20);
      if (!(margin > 0)) continue;
      for (const double side : {-1.0, 1.0}) {
        const double distance = side > 0 ? upper[i] - values[i] : values[i] - lower[i];
        const double part = std::max(0.0, 1 - distance / margin);
        out.objective += options_.push * margin * part * part / 2;
        if (part > 0) add(i, side * options_.push * part);
      }
    }
  }

  Eigen::VectorXd with_zeros(const Eigen::VectorXd& bounds) const {
    Eigen::VectorXd out = Eigen::VectorXd::Zero(num_constraints());
    out.head(bounds.size()) = bounds;
    return out;
  }

  const Formulation& formulation_;
  const IndependentZeros zeros_;
  const NearestZeroOptions& options_;
  Eigen::VectorXd start_, weights_;  ///< x_s, diagonal of W
};

/// The least singular value of the slopes of equations and y, of the `rank` that are not zero in
/// general.
double least_slope(const Formulation& formulation, const Eigen::VectorXd& x, Eigen::Index rank) {
  if (rank == 0) return 0;
  Eigen::VectorXd residual;
  Eigen::MatrixXd J;
  evaluate_equations(formulation, x, true, residual, J);
  return right_svd(J).sigma[rank - 1];
}

double value_at(const nlp::Problem& problem, const Eigen::VectorXd& x) {
  nlp::Evaluation here;
  problem.evaluate(x, here);
  return here.objective;
}

/// How far the joints are from the start posture, as least_way_from_start(), but for those that
/// zeros do not depend on.
double way_among_zeros(const CaptureProblem& problem, const Formulation& formulation,
                       const Eigen::VectorXd& zero) {
  constexpr double kNothing = 1e-9;  // slopes over typical sizes
  Eigen::VectorXd residual;
  Eigen::MatrixXd J;
  evaluate_equations(formulation, zero, true, residual, J);
  JointVectord way = way_from_start(problem, formulation.configuration(zero));
  const std::vector<int> joints = VariableLayout(problem).joints;
  for (std::size_t i = 0; i < joints.size(); ++i) {
    if (J.col(static_cast<Eigen::Index>(i)).isZero(kNothing)) way[joints[i]] = 0;
  }
  return way.norm();
}

}  // namespace

std::optional<Eigen::VectorXd> nearest_zero(const CaptureProblem& problem,
                                            const Formulation& formulation,
                                            const Eigen::VectorXd& zero, const StopCondition& stop,
                                            const NearestZeroOptions& options) {
  const Eigen::Index open = open_directions(formulation, zero, true).cols();
  if (open < 2) return std::nullopt;
  const DistanceAmongZeros distance(problem, formulation, zero, options);
  const auto optimizer = nlp::make_optimizer("sqp");
  nlp::OptimizeOptions rough, fine;
  rough.stop = fine.stop = stop;
  rough.explain_infeasibility = fine.explain_infeasibility = false;
  rough.max_evaluations = options.rough_evaluations;
  rough.feasibility_tolerance = options.rough_violation;
  fine.max_evaluations = options.evaluations;
  fine.certain = 1;  // refined afterwards
  const auto residual = [&](const Eigen::VectorXd& at) {
    return nlp::certify(distance, at).kkt_residual;
  };
  const double near = nlp::RefinementOptions{}.near;
  Eigen::VectorXd x = zero;
  double least = value_at(distance, x);
  for (int solve = 0; solve < options.rough_solves && residual(x) > near; ++solve) {
    const Eigen::VectorXd end = optimizer->minimize(distance, x, rough).x;
    const ProjectionResult there = project_onto_constraints(formulation, end, true, 20);
    if (!(there.violation <= kFeasibilityTolerance)) break;
    const double value = value_at(distance, there.x);
    if (!(value < least - options.stationary)) break;
    x = there.x;
    least = value;
  }
  if (residual(x) > near) x = optimizer->minimize(distance, x, fine).x;
  x = nlp::refined_minimum(distance, x);
  const Eigen::Index rank = zero.size() - open;
  const bool is_regular =
      least_slope(formulation, x, rank) >= options.singular * least_slope(formulation, zero, rank);
  const bool is_minimum = residual(x) <= options.stationary;
  return is_regular && is_minimum ? std::optional(x) : std::nullopt;
}

bool move_zeros_nearer(const CaptureProblem& problem, const Formulation& formulation, int most,
                       double zero, const std::function<bool(const Configuration&)>& is_free,
                       const StopCondition& stop, int jobs, std::vector<Solution>& solutions) {
  const auto is_zero = [&](const Solution& solution) {
    return std::sqrt(2 * solution.objective) <= zero;
  };
  const auto is_blocked = [&](const Eigen::VectorXd& x) {
    return is_free && !is_free(formulation.configuration(x));
  };
  std::vector<std::pair<double, Solution*>> zeros;
  for (Solution& solution : solutions) {
    if (solution.family >= 0 || !is_zero(solution)) continue;
    zeros.emplace_back(way_among_zeros(problem, formulation, solution.x), &solution);
  }
  std::stable_sort(zeros.begin(), zeros.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  const int count = std::min(static_cast<int>(zeros.size()), most);
  const int done = for_each_index(jobs, count, stop, [&](int i) {
    Solution& from = *zeros[static_cast<std::size_t>(i)].second;
    const auto x = nearest_zero(problem, formulation, from.x, stop);
    if (!x) return;
    Solution nearest = judge(problem, formulation, formulation.normalised(*x));
    if (!(nearest.violation <= kFeasibilityTolerance && is_zero(nearest))) return;
    if (is_blocked(nearest.x) && !is_blocked(from.x)) return;
    nearest.reached = from.reached;
    from = nearest;
  });
  return done == count && !stop.reached();
}

}  // namespace stillbase
