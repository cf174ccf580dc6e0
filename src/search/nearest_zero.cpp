#include "search/nearest_zero.hpp"

#include <cmath>
#include <utility>
#include <vector>

#include <stillbase/encounter/encounter.hpp>

#include "formulation/projection.hpp"
#include "formulation/variables/layout.hpp"
#include "nlp/refinement.hpp"

namespace stillbase {

namespace {

/// The distance from the start posture among the zeros.
class DistanceAmongZeros final : public nlp::Problem {
 public:
  DistanceAmongZeros(const Formulation& formulation, std::vector<Eigen::Index> rows,
                     Eigen::VectorXd start, Eigen::VectorXd weights)
      : formulation_(formulation),
        rows_(std::move(rows)),
        start_(std::move(start)),
        weights_(std::move(weights)) {}

  int num_variables() const override { return formulation_.num_variables(); }
  int num_constraints() const override {
    return formulation_.num_constraints() + static_cast<int>(rows_.size());
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
    auto& [inner, y, J_y] = out.workspace_as<Workspace>();
    formulation_.evaluate(x, inner);
    formulation_.objective_vector(x, y, J_y);
    const Eigen::VectorXd away = x - start_;
    out.gradient = weights_.cwiseProduct(away);
    out.objective = away.dot(out.gradient) / 2;
    const Eigen::Index m = inner.constraints.size();
    const auto more = static_cast<Eigen::Index>(rows_.size());
    out.constraints.resize(m + more);
    out.jacobian.resize(m + more, x.size());
    out.constraints.head(m) = inner.constraints;
    out.jacobian.topRows(m) = inner.jacobian;
    for (Eigen::Index i = 0; i < more; ++i) {
      out.constraints[m + i] = y[rows_[static_cast<std::size_t>(i)]];
      out.jacobian.row(m + i) = J_y.row(rows_[static_cast<std::size_t>(i)]);
    }
  }

 private:
  struct Workspace {
    nlp::Evaluation inner;
    Eigen::VectorXd y;
    Eigen::MatrixXd J_y;
  };

  Eigen::VectorXd with_zeros(const Eigen::VectorXd& bounds) const {
    Eigen::VectorXd out = Eigen::VectorXd::Zero(num_constraints());
    out.head(bounds.size()) = bounds;
    return out;
  }

  const Formulation& formulation_;
  std::vector<Eigen::Index> rows_;  ///< of y
  Eigen::VectorXd start_, weights_;
};

/// The components of y whose slopes at a zero are no combinations of those of the equations and of
/// each other.
std::vector<Eigen::Index> independent_rows(const Formulation& formulation,
                                           const Eigen::VectorXd& zero, double dependent) {
  Eigen::VectorXd residual, y;
  Eigen::MatrixXd equations, J_y;
  evaluate_equations(formulation, zero, false, residual, equations);
  formulation.objective_vector(zero, y, J_y);
  std::vector<Eigen::VectorXd> basis;  // orthonormal
  const auto adds = [&](const Eigen::VectorXd& row) {
    Eigen::VectorXd rest = row;
    for (int twice = 0; twice < 2; ++twice) {
      for (const Eigen::VectorXd& other : basis) rest -= other.dot(rest) * other;
    }
    if (!(rest.norm() > dependent * std::max(1.0, row.norm()))) return false;
    basis.push_back(rest.normalized());
    return true;
  };
  for (Eigen::Index i = 0; i < equations.rows(); ++i) adds(equations.row(i).transpose());
  std::vector<Eigen::Index> out;
  for (Eigen::Index i = 0; i < J_y.rows(); ++i) {
    if (adds(J_y.row(i).transpose())) out.push_back(i);
  }
  return out;
}

}  // namespace

std::optional<Eigen::VectorXd> nearest_zero(const CaptureProblem& problem,
                                            const Formulation& formulation,
                                            const Eigen::VectorXd& zero,
                                            const nlp::Optimizer& optimizer,
                                            nlp::OptimizeOptions solve,
                                            const NearestZeroOptions& options) {
  if (open_directions(formulation, zero, true).cols() < 2) return std::nullopt;
  const VariableLayout layout(problem);
  Configuration start = start_configuration(problem);
  if (layout.time >= 0)
    start.contact_time = (layout.lower[layout.time] + layout.upper[layout.time]) / 2;
  // The difference counts angles to the nearest whole turn.
  const Eigen::VectorXd from = zero - formulation.difference(zero, formulation.variables(start));
  Eigen::VectorXd weights = Eigen::VectorXd::Constant(zero.size(), options.other_weight);
  weights.head(static_cast<Eigen::Index>(layout.joints.size())).setOnes();
  const DistanceAmongZeros distance(
      formulation, independent_rows(formulation, zero, options.dependent), from, weights);
  solve.max_evaluations = options.max_evaluations;
  solve.certain = 1;  // refined afterwards
  const Eigen::VectorXd x = optimizer.minimize(distance, zero, solve).x;
  return nlp::refined_minimum(distance, x);
}

}  // namespace stillbase
