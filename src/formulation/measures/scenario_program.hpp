// A measure over several scenarios as a smooth program.
//
//   worst        minimise t over (x, t) subject to t - f_k(x) >= 0
//   expectation  minimise sum w_k f_k(x)
//   CVaR         minimise t + sum w_k z_k / (1 - level) over (x, t, z), z_k >= 0, z_k + t >= f_k(x)
//                (Rockafellar and Uryasev, Optimization of conditional value-at-risk, 2000)
//
// with the constraints of the formulation, and f divided by its size, so that t is about 1.
#pragma once

#include <optional>

#include <stillbase/formulation/formulation.hpp>

namespace stillbase {

class ScenarioProgram final : public nlp::Problem {
 public:
  /// The worst scenario. Scenarios are fixed directions, or each follows the maximum over the cone
  /// that it belongs to: f_k(x) is then that maximum, smooth in x, with the gradient at the
  /// direction where it is taken (envelope theorem). Fixed ones reach far, following ones converge
  /// fast.
  /// @param scale size of f
  /// @param follow the problem whose cone's maxima the scenarios follow; null: fixed directions
  ScenarioProgram(const Formulation& formulation, std::vector<Scenario> scenarios, double scale,
                  const CaptureProblem* follow = nullptr);
  /// Expectation or CVaR. @param level of CVaR; empty: expectation
  ScenarioProgram(const Formulation& formulation, std::vector<Scenario> scenarios,
                  std::optional<double> level, double scale);

  int num_variables() const override { return n_ + (has_t_ ? 1 : 0) + (level_ ? count_ : 0); }
  int num_constraints() const override { return m_ + (has_t_ ? count_ : 0); }
  Eigen::VectorXd lower() const override;
  Eigen::VectorXd upper() const override;
  Eigen::VectorXd constraint_lower() const override;
  Eigen::VectorXd constraint_upper() const override;
  bool may_have_kinks(int i) const override { return i < m_ && formulation_.may_have_kinks(i); }
  void evaluate(const Eigen::VectorXd& xtz, nlp::Evaluation& out) const override;
  void evaluate_value(const Eigen::VectorXd& xtz, nlp::Evaluation& out) const override;
  /// Exact for fixed directions; following ones change with x, which it leaves out.
  bool has_hessian() const override { return follow_ == nullptr && formulation_.has_hessian(); }
  void lagrangian_hessian(const Eigen::VectorXd& xtz, double sigma,
                          const Eigen::VectorXd& multipliers, Eigen::MatrixXd& out) const override;

  /// (x, t, z) with the least objective that x allows.
  Eigen::VectorXd lifted(const Eigen::VectorXd& x) const;

 private:
  std::vector<Scenario> scenarios_at(const Eigen::VectorXd& x) const;
  /// Objective and constraints, and the scenarios at x that they come from.
  const ScenarioEvaluation& evaluate_at(const Eigen::VectorXd& xtz, bool derivatives,
                                        nlp::Evaluation& out) const;

  const Formulation& formulation_;
  std::vector<Scenario> scenarios_;
  double scale_;
  const CaptureProblem* follow_ = nullptr;
  bool has_t_ = true;
  std::optional<double> level_;
  int n_, m_, count_;
  Eigen::VectorXd weights_;  ///< of the scenarios
};

/// The level's quantile t of values with weights (sum 1), and t + sum w max(f - t, 0) / (1 -
/// level).
struct TailMean {
  double quantile = 0;
  double mean = 0;
};
TailMean tail_mean(const Eigen::VectorXd& values, const Eigen::VectorXd& weights, double level);

}  // namespace stillbase
