#include "search/zero_watch.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

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

/// Newton steps of least norm, each a quadratic program.
class ZeroSteps {
 public:
  explicit ZeroSteps(const Formulation& formulation)
      : formulation_(formulation),
        lower_(formulation.lower()),
        upper_(formulation.upper()),
        row_lower_(formulation.constraint_lower()),
        row_upper_(formulation.constraint_upper()) {}

  std::optional<Eigen::VectorXd> from(Eigen::VectorXd x, const ZeroOptions& options) {
    std::optional<nlp::DenseQp> program;
    double before = kInfinity;
    for (int step = 0; step <= options.steps; ++step) {
      formulation_.evaluate_vector(x, here_, y_, J_y_);
      const double left =
          std::max(violation_of(here_, row_lower_, row_upper_), y_.lpNorm<Eigen::Infinity>());
      if (left <= options.exact) return x;
      if (!std::isfinite(left) || (step >= options.first_steps && left > 0.5 * before)) break;
      before = left;
      if (!program) {
        const Eigen::Index most_rows = 2 * (row_lower_.size() + x.size()) + y_.size();
        program.emplace(static_cast<int>(x.size()), static_cast<int>(most_rows));
      }
      set(*program, x);
      if (program->solve() != nlp::DenseQp::Outcome::Solved) break;
      const double longest = program->solution().lpNorm<Eigen::Infinity>();
      const double part = longest > options.longest_step ? options.longest_step / longest : 1;
      x = (x + part * program->solution()).cwiseMax(lower_).cwiseMin(upper_);
    }
    return std::nullopt;
  }

 private:
  void set(nlp::DenseQp& program, const Eigen::VectorXd& x) const {
    program.begin(static_cast<int>(x.size()));
    program.hessian().setIdentity();
    program.gradient().setZero();
    for (Eigen::Index i = 0; i < y_.size(); ++i) {
      if (J_y_.row(i).isZero(kNothing) && std::abs(y_[i]) <= kNothing) continue;
      program.add_row(-y_[i], true) = J_y_.row(i).transpose();
    }
    for (Eigen::Index i = 0; i < row_lower_.size(); ++i) {
      if (row_lower_[i] != row_upper_[i]) continue;
      program.add_row(row_lower_[i] - here_.constraints[i], true) =
          here_.jacobian.row(i).transpose();
    }
    for (const double sign : {1.0, -1.0}) {
      const Eigen::VectorXd& ends = sign > 0 ? row_lower_ : row_upper_;
      for (Eigen::Index i = 0; i < ends.size(); ++i) {
        if (row_lower_[i] == row_upper_[i] || !std::isfinite(ends[i])) continue;
        program.add_row(sign * (ends[i] - here_.constraints[i])) =
            sign * here_.jacobian.row(i).transpose();
      }
      const Eigen::VectorXd& box = sign > 0 ? lower_ : upper_;
      for (Eigen::Index j = 0; j < box.size(); ++j) {
        if (!std::isfinite(box[j])) continue;
        program.add_bound(static_cast<int>(j), sign, std::min(sign * (box[j] - x[j]), 0.0));
      }
    }
  }

  const Formulation& formulation_;
  const Eigen::VectorXd lower_, upper_, row_lower_, row_upper_;
  nlp::Evaluation here_;
  Eigen::VectorXd y_;
  Eigen::MatrixXd J_y_;
};

}  // namespace

std::optional<Eigen::VectorXd> zero_near(const Formulation& formulation, Eigen::VectorXd x,
                                         const ZeroOptions& options) {
  return ZeroSteps(formulation).from(std::move(x), options);
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
