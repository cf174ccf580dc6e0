// The planning problem as a nonlinear program: variables, objective, constraints.
//
//   variables    free joints; rotation of the base (about one axis, or a rotation vector); contact
//                time. The base position is never a variable: a free station follows the hand, a
//                boxed one becomes a bound on where the hand's point puts it.
//   objective    1/2 |y|^2, y the chosen momentum or rate (norms are not differentiable at zero)
//   constraints  hand equations, case equations reduced to independent rows, closing speed
//
// The only place where the impact model and the optimizers meet. The robot is at rest when it is
// hit. Every evaluation with derivatives costs one evaluation of the model; an objective with
// attitude_turned takes a simulation for every value and 2 N more for its derivatives (central
// differences).
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <stillbase/core/interrupt.hpp>
#include <stillbase/encounter/encounter.hpp>
#include <stillbase/impact/gradient.hpp>
#include <stillbase/nlp/problem.hpp>

namespace stillbase {

/// A term of the objective from outside the library: |y| is joined by value / size.
///
/// `value` is called several times for every evaluation (central differences of step 1e-5 give its
/// gradient, to about 1e-9 of its size) and must be twice differentiable in the configuration.
struct UserTerm {
  std::string name;
  std::string unit;
  double size = 1;  ///< value that counts as one, in `unit`, > 0
  std::function<double(const Configuration&, const ImpactSummary&)> value;
};

/// Scenarios and constraints at one point. Without derivatives the matrices stay as they are.
struct ScenarioEvaluation {
  Eigen::VectorXd values;     ///< f_k = 1/2 |y_k|^2 / unit^2 (K)
  Eigen::MatrixXd gradients;  ///< K x N
  Eigen::VectorXd constraints;
  Eigen::MatrixXd jacobian;  ///< m x N
};

class Formulation final : public nlp::Problem {
 public:
  /// @throws InputError when there are fewer free variables than independent equations (with the
  /// count), or when the problem's parts do not fit together (a simulated quantity without
  /// controller)
  explicit Formulation(const CaptureProblem& problem, std::vector<UserTerm> user_terms = {});
  ~Formulation() override;

  int num_variables() const override;
  int num_constraints() const override;
  Eigen::VectorXd lower() const override;
  Eigen::VectorXd upper() const override;
  Eigen::VectorXd constraint_lower() const override;
  Eigen::VectorXd constraint_upper() const override;
  void evaluate(const Eigen::VectorXd& x, nlp::Evaluation& out) const override;
  void evaluate_value(const Eigen::VectorXd& x, nlp::Evaluation& out) const override;
  /// Exact: the lines of the gradient, differentiated forwards. Not with terms of the user, and not
  /// when the turn of the base is simulated.
  bool has_hessian() const override;
  void lagrangian_hessian(const Eigen::VectorXd& x, double sigma,
                          const Eigen::VectorXd& multipliers, Eigen::MatrixXd& out) const override;
  double objective_scale() const override { return 1; }

  /// Several scenarios at once: the posture is evaluated and factorised for all of them together.
  void evaluate_scenarios(const Eigen::VectorXd& x, const std::vector<Scenario>& scenarios,
                          bool derivatives, ScenarioEvaluation& out) const;
  /// Values of many scenarios at many points (points x scenarios), several at a time in the lanes
  /// of wide registers: for screening, not for solving.
  Eigen::MatrixXd evaluate_points(const std::vector<Eigen::VectorXd>& points,
                                  const std::vector<Scenario>& scenarios) const;
  /// sum_k weights_k d2f_k/dx2 + sum_i multipliers_i d2g_i/dx2.
  void scenario_hessian(const Eigen::VectorXd& x, const std::vector<Scenario>& scenarios,
                        const Eigen::VectorXd& weights, const Eigen::VectorXd& multipliers,
                        Eigen::MatrixXd& out) const;
  const std::vector<UserTerm>& user_terms() const;
  /// What encounters of all configurations have in common.
  const EncounterModel& encounter_model() const;
  Scenario predicted_scenario() const;  ///< the nominal encounter

  /// Those that are independent where they hold.
  int num_equations() const;
  /// Degrees of freedom that the equations leave.
  int freedom() const { return num_variables() - num_equations(); }

  /// The vector y behind the objective, all terms of the problem below each other, divided by its
  /// typical size, with its Jacobian (size of y x N). Terms of the user are not in it.
  void objective_vector(const Eigen::VectorXd& x, Eigen::VectorXd& y,
                        Eigen::MatrixXd& jacobian) const;
  /// Typical size of y by which the objective is divided.
  double objective_unit() const;

  Configuration configuration(const Eigen::VectorXd& x) const;
  /// The variables of a configuration: the inverse of configuration().
  Eigen::VectorXd variables(const Configuration& configuration) const;
  /// A start point for u in [0,1)^d, d = start_dimension(): joints within their limits (one turn
  /// for continuous ones), attitudes uniform over rotations, times uniform.
  Eigen::VectorXd start_point(const Eigen::VectorXd& u) const;
  int start_dimension() const;
  /// Distance of two points on the configuration manifold: angles wrapped, rotations by their
  /// angle.
  double distance(const Eigen::VectorXd& a, const Eigen::VectorXd& b) const;
  /// Continuous angles wrapped to (-pi, pi].
  Eigen::VectorXd normalised(const Eigen::VectorXd& x) const;

  /// Values of all constraints in their own units, by name.
  std::vector<ConstraintValue> report(const Eigen::VectorXd& x) const;
  /// Evaluations of the model since construction.
  long evaluations() const;

  /// From the stop on simulations are given up: what an objective with attitude_turned is worth is
  /// NaN then, with its derivatives, and worst cases (robust.hpp) are what was seen of them. The
  /// constraints take no simulation.
  void give_up_simulations_at(const StopCondition& stop);
  const StopCondition& simulations_stop() const;

  struct Parts;

 private:
  void set_implied_rows_aside();
  std::unique_ptr<Parts> parts_;
};

}  // namespace stillbase
