// The worst of several scenarios as a smooth program: minimise s over (x, s) subject to
// s - f_k(x) >= 0 and the constraints of the formulation.
//
// The scenarios are fixed directions, or each follows the maximum over the cone that it belongs to:
// f_k(x) is then that maximum, smooth in x, with the gradient at the direction where it is taken
// (envelope theorem). Fixed ones reach far, following ones converge fast.
#pragma once

#include <stillbase/formulation/formulation.hpp>

namespace stillbase {

class EpigraphProgram final : public nlp::Problem {
 public:
  /// @param scale size of f: rows and s are divided by it, so that s is about 1
  /// @param follow the problem whose cone's maxima the scenarios follow; null: fixed directions
  EpigraphProgram(const Formulation& formulation, std::vector<Scenario> scenarios, double scale,
                  const CaptureProblem* follow = nullptr)
      : formulation_(formulation),
        scenarios_(std::move(scenarios)),
        scale_(scale),
        follow_(follow) {}

  int num_variables() const override { return formulation_.num_variables() + 1; }
  int num_constraints() const override;
  Eigen::VectorXd lower() const override;
  Eigen::VectorXd upper() const override;
  Eigen::VectorXd constraint_lower() const override;
  Eigen::VectorXd constraint_upper() const override;
  void evaluate(const Eigen::VectorXd& xs, nlp::Evaluation& out) const override;
  void evaluate_value(const Eigen::VectorXd& xs, nlp::Evaluation& out) const override;
  /// Exact for fixed directions; following ones turn with x, which it leaves out.
  bool has_hessian() const override { return follow_ == nullptr && formulation_.has_hessian(); }
  void lagrangian_hessian(const Eigen::VectorXd& xs, double sigma,
                          const Eigen::VectorXd& multipliers, Eigen::MatrixXd& out) const override;

  /// (x, s) with the least s that x allows.
  Eigen::VectorXd lifted(const Eigen::VectorXd& x) const;

 private:
  std::vector<Scenario> scenarios_at(const Eigen::VectorXd& x) const;

  const Formulation& formulation_;
  std::vector<Scenario> scenarios_;
  double scale_;
  const CaptureProblem* follow_;
};

}  // namespace stillbase
