#include "search/zero_watch.hpp"

#include <algorithm>
#include <cmath>

#include "nlp/dense_qp.hpp"

namespace stillbase {

namespace {

/// Entries of J_y, over typical sizes, that are rounding: a component of y that is zero in every
/// posture, as of planar robots.
constexpr double kNothing = 1e-12;

/// Of the constraints, the largest.
double violation_of(const nlp::Evaluation& here, const Eigen::VectorXd& lower,
                    const Eigen::VectorXd& upper) {
  if (lower.size() == 0) return 0;
  return nlp::signed_violation(here.constraints, lower, upper).lpNorm<Eigen::Infinity>();
}

/// The quadratic program of one step of least norm.
/// @param program room for 2 (m + N) + rows of y
void set_program(const Formulation& formulation, const Eigen::VectorXd& x,
                 const nlp::Evaluation& here, const Eigen::VectorXd& y, const Eigen::MatrixXd& J_y,
                 nlp::DenseQp& program) {
  program.begin(static_cast<int>(x.size()));
  program.hessian().setIdentity();
  program.gradient().setZero();
  for (Eigen::Index i = 0; i < y.size(); ++i) {
    if (J_y.row(i).isZero(kNothing) && std::abs(y[i]) <= kNothing) continue;
    program.add_row(-y[i], true) = J_y.row(i).transpose();
  }
  const Eigen::VectorXd lower = formulation.constraint_lower();
  const Eigen::VectorXd upper = formulation.constraint_upper();
  for (Eigen::Index i = 0; i < lower.size(); ++i) {
    if (lower[i] != upper[i]) continue;
    program.add_row(lower[i] - here.constraints[i], true) = here.jacobian.row(i).transpose();
  }
  for (const double sign : {1.0, -1.0}) {
    const Eigen::VectorXd& ends = sign > 0 ? lower : upper;
    for (Eigen::Index i = 0; i < ends.size(); ++i) {
      if (lower[i] == upper[i] || !std::isfinite(ends[i])) continue;
      program.add_row(sign * (ends[i] - here.constraints[i])) =
          sign * here.jacobian.row(i).transpose();
    }
    const Eigen::VectorXd box = sign > 0 ? formulation.lower() : formulation.upper();
    for (Eigen::Index j = 0; j < box.size(); ++j) {
      if (!std::isfinite(box[j])) continue;
      program.add_bound(static_cast<int>(j), sign, std::min(sign * (box[j] - x[j]), 0.0));
    }
  }
}

}  // namespace

std::optional<Eigen::VectorXd> zero_near(const Formulation& formulation, Eigen::VectorXd x,
                                         const ZeroOptions& options) {
  const Eigen::VectorXd lower = formulation.lower(), upper = formulation.upper();
  const Eigen::VectorXd row_lower = formulation.constraint_lower();
  const Eigen::VectorXd row_upper = formulation.constraint_upper();
  nlp::Evaluation here;
  Eigen::VectorXd y;
  Eigen::MatrixXd J_y;
  formulation.objective_vector(x, y, J_y);
  const Eigen::Index most_rows = 2 * (row_lower.size() + x.size()) + y.size();
  nlp::DenseQp program(static_cast<int>(x.size()), static_cast<int>(most_rows));
  double before = kInfinity;
  for (int step = 0; step <= options.steps; ++step) {
    if (step > 0) formulation.objective_vector(x, y, J_y);
    formulation.evaluate(x, here);
    const double left =
        std::max(violation_of(here, row_lower, row_upper), y.lpNorm<Eigen::Infinity>());
    if (left <= options.exact) return x;
    if (!std::isfinite(left) || (step >= options.first_steps && left > 0.5 * before)) break;
    before = left;
    set_program(formulation, x, here, y, J_y, program);
    if (program.solve() != nlp::DenseQp::Outcome::Solved) break;
    const double longest = program.solution().lpNorm<Eigen::Infinity>();
    const double part = longest > options.longest_step ? options.longest_step / longest : 1;
    x = (x + part * program.solution()).cwiseMax(lower).cwiseMin(upper);
  }
  return std::nullopt;
}

LocalEnd minimize_to_zero(const nlp::Optimizer& optimizer, const Formulation& formulation,
                          const Eigen::VectorXd& from, nlp::OptimizeOptions solve,
                          const ZeroOptions& options) {
  const Eigen::VectorXd lower = formulation.constraint_lower();
  const Eigen::VectorXd upper = formulation.constraint_upper();
  double next = options.near;  // objective of the next try
  std::optional<Eigen::VectorXd> zero;
  solve.ends_at = [&](const Eigen::VectorXd& x, const nlp::Evaluation& at_x) {
    if (!(at_x.objective < next)) return false;
    if (!(violation_of(at_x, lower, upper) <= options.violation)) return false;
    next = options.again * at_x.objective;
    zero = zero_near(formulation, x, options);
    return zero.has_value();
  };
  const nlp::OptimizeResult end = optimizer.minimize(formulation, from, solve);
  return zero ? LocalEnd{*zero, false} : LocalEnd{end.x, end.at_kink};
}

}  // namespace stillbase
