// The equations of a capture problem over its free variables, by `reference`: for searches apart
// from the planner's.
#pragma once

#include <array>
#include <optional>

#include "audit/free_variables.hpp"

namespace stillbase::audit {

/// Hand's offset from its point (3, m) and sines of the rotation of its axes (3), in B; zero where
/// the problem demands nothing.
Vector6d hand_rows(const CaptureProblem& problem, const ContactEvent& event,
                   const Configuration& at, const reference::Dynamics& dynamics);

/// Largest of |hand_rows()|.
double hand_residual(const Situation& situation);

/// Number of singular values above a threshold: equations that are independent at a point.
int rank_of(const Eigen::MatrixXd& jacobian);

/// Residuals over the variables, relative to the size of the momenta and to 1 m.
class Equations {
 public:
  enum class Demand {
    Hand,         ///< the hand at its contact
    HandAndCase,  ///< and the momenta of the problem's case zero
    Zero          ///< and the momentum that vanishes with the objective zero
  };
  /// @param problem,variables must outlive this object
  Equations(const CaptureProblem& problem, const FreeVariables& variables, Demand demand);

  Eigen::VectorXd residual(const Eigen::VectorXd& x) const;
  /// By central differences.
  Eigen::MatrixXd jacobian(const Eigen::VectorXd& x) const;
  /// Gauss-Newton with halved steps; empty: it does not converge.
  std::optional<Eigen::VectorXd> solve(Eigen::VectorXd x) const;

  /// Closing speed, bounds of the base position, side from which the hand approaches: each with a
  /// margin of rounding.
  bool keeps_inequalities(const Configuration& at) const;
  /// The limits on rates, singular values and clearances, likewise.
  bool keeps_margins(Configuration at) const;

 private:
  ContactEvent event_at(const Configuration& at) const;

  const CaptureProblem& problem_;
  const FreeVariables& variables_;
  std::array<bool, 3> vanishes_{};      ///< total, base, coupling
  std::optional<TargetMotion> motion_;  ///< of a predicted target
};

}  // namespace stillbase::audit
