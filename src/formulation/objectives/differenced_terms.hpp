// Terms of the objective that are known by their values alone: simulated ones and the user's.
// Central differences give their derivatives, unless a term of the user has a gradient of its own.
#pragma once

#include <vector>

#include "formulation/capture_model.hpp"
#include "formulation/objectives/attitude_turned.hpp"

namespace stillbase {

class DifferencedTerms {
 public:
  /// @throws InputError as AttitudeTurned
  explicit DifferencedTerms(const CaptureProblem& problem);

  bool empty() const { return simulated_.empty() && users_.empty(); }
  bool is_simulated() const { return !simulated_.empty(); }

  /// y over the terms' sizes and over `unit`, all below each other: three components of each
  /// simulated term, one of each of the user's.
  /// @param stop as AttitudeTurned
  Eigen::VectorXd value(const CaptureModel& model, const Eigen::VectorXd& x,
                        const Scenario& scenario, double unit, const StopCondition& stop) const;
  /// Of value() over the variables.
  Eigen::MatrixXd jacobian(const CaptureModel& model, const Eigen::VectorXd& x,
                           const Scenario& scenario, double unit, const StopCondition& stop) const;
  /// |y|^2 at an impact.
  double square(const Configuration& configuration, const ImpactSummary& impact,
                const StopCondition& stop) const;

 private:
  std::vector<AttitudeTurned> simulated_;
  std::vector<UserTerm> users_;
};

/// The nominal or a scenario's impact at x, as users' functions get it.
ImpactSummary summarize_scenario(const CaptureModel& model, const Placement<double>& at,
                                 const ScenarioImpact<double>& impact, const Scenario& scenario);

/// The gradient that a user's function has of its own, as a row of N.
/// @param name of the term or constraint, for the message
/// @throws std::invalid_argument when it has not N components
Eigen::RowVectorXd users_gradient(const std::string& name, const UserGradient& gradient,
                                  const Configuration& configuration, const ImpactSummary& impact,
                                  Eigen::Index N);

/// Column i of the Jacobian of f at x by a central difference, one-sided at bounds.
template <class F>
auto difference_along(const VariableLayout& layout, const Eigen::VectorXd& x, Eigen::Index i,
                      const F& f) -> decltype(f(x)) {
  constexpr double kStep = 1e-5;  // errors of rounding and of the third derivative are as small
  Eigen::VectorXd a = x, b = x;
  // Beyond its bound a joint would reach its stop at once.
  a[i] = std::min(x[i] + kStep, std::max(x[i], layout.upper[i]));
  b[i] = std::max(x[i] - kStep, std::min(x[i], layout.lower[i]));
  if (a[i] == b[i]) return 0 * f(x);
  return (f(a) - f(b)) / (a[i] - b[i]);
}

}  // namespace stillbase
