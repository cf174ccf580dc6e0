#include "formulation/equations.hpp"

#include <algorithm>
#include <stillbase/core/linear_algebra.hpp>
#include <vector>

namespace stillbase {

void evaluate_equations(const Formulation& formulation, const Eigen::VectorXd& x, bool with_zero,
                        Eigen::VectorXd& residual, Eigen::MatrixXd& jacobian) {
  ScenarioEvaluation at_x;  // of no scenario: the constraints alone
  formulation.evaluate_scenarios(x, {}, true, at_x);
  const Eigen::VectorXd lower = formulation.constraint_lower();
  const Eigen::VectorXd upper = formulation.constraint_upper();
  std::vector<Eigen::Index> equations;
  for (Eigen::Index i = 0; i < lower.size(); ++i) {
    if (lower[i] == upper[i]) equations.push_back(i);
  }
  Eigen::VectorXd y;
  Eigen::MatrixXd J_y(0, x.size());
  if (with_zero) formulation.objective_vector(x, y, J_y);
  const auto rows = static_cast<Eigen::Index>(equations.size());
  residual.resize(rows + y.size());
  jacobian.resize(rows + y.size(), x.size());
  for (Eigen::Index i = 0; i < rows; ++i) {
    const Eigen::Index row = equations[static_cast<std::size_t>(i)];
    residual[i] = at_x.constraints[row] - lower[row];
    jacobian.row(i) = at_x.jacobian.row(row);
  }
  residual.tail(y.size()) = y;
  jacobian.bottomRows(y.size()) = J_y;
}

Eigen::MatrixXd open_directions(const Formulation& formulation, const Eigen::VectorXd& x,
                                bool with_zero) {
  constexpr double kRank = 1e-9;
  Eigen::VectorXd residual;
  Eigen::MatrixXd equations;
  evaluate_equations(formulation, x, with_zero, residual, equations);
  // Square at least, so that the right singular vectors are all there.
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(std::max(equations.rows(), x.size()), x.size());
  J.topRows(equations.rows()) = equations;
  const Svd svd = right_svd(J);
  return svd.V.rightCols(x.size() - numerical_rank(svd.sigma, kRank));
}

}  // namespace stillbase
