// The mean over samples, or over the worst of them, as a smooth program.
//
//   expectation  minimise sum w_k f_k(x)
//   CVaR         minimise t + sum w_k z_k / (1 - level) over (x, t, z), z_k >= 0, z_k + t >= f_k(x)
//                (Rockafellar and Uryasev, Optimization of conditional value-at-risk, 2000)
#pragma once

#include <stillbase/formulation/formulation.hpp>

namespace stillbase {

class SampledProgram final : public nlp::Problem {
 public:
  /// @param level of CVaR; empty: expectation
  /// @param scale size of f by which it is divided
  SampledProgram(const Formulation& formulation, const std::vector<Scenario>& scenarios,
                 std::optional<double> level, double scale);

  int num_variables() const override { return n_ + (level_ ? 1 + count_ : 0); }
  int num_constraints() const override { return m_ + (level_ ? count_ : 0); }
  Eigen::VectorXd lower() const override;
  Eigen::VectorXd upper() const override;
  Eigen::VectorXd constraint_lower() const override;
  Eigen::VectorXd constraint_upper() const override;
  void evaluate(const Eigen::VectorXd& xtz, nlp::Evaluation& out) const override;
  void evaluate_value(const Eigen::VectorXd& xtz, nlp::Evaluation& out) const override;
  bool has_hessian() const override { return formulation_.has_hessian(); }
  void lagrangian_hessian(const Eigen::VectorXd& xtz, double sigma,
                          const Eigen::VectorXd& multipliers, Eigen::MatrixXd& out) const override;

  /// (x, t, z) with the least objective that x allows.
  Eigen::VectorXd lifted(const Eigen::VectorXd& x) const;

 private:
  const Formulation& formulation_;
  const std::vector<Scenario>& scenarios_;
  std::optional<double> level_;
  double scale_;
  int n_, m_, count_;
  Eigen::VectorXd weights_;  ///< of the scenarios, sum 1
};

/// The level's quantile t of values with weights (sum 1), and t + sum w max(f - t, 0) / (1 -
/// level).
struct TailMean {
  double quantile = 0;
  double mean = 0;
};
TailMean tail_mean(const Eigen::VectorXd& values, const Eigen::VectorXd& weights, double level);

}  // namespace stillbase
