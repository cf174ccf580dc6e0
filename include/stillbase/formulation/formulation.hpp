// The planning problem as a nonlinear program: variables, objective, constraints.
//
//   variables    free joints; rotation of the base (about one axis, or a rotation vector); contact
//                time. The base position is never a variable: a free station follows the hand, a
//                boxed one becomes a bound on where the hand's point puts it.
//   objective    1/2 |y|^2, y the chosen momentum or rate (norms are not differentiable at zero)
//   constraints  hand equations, case equations reduced to independent rows, closing speed
//
// The only place where the impact model and the optimizers meet. The robot is at rest before the
// impact. Every evaluation with derivatives costs one evaluation of the model. A simulated term of
// the objective takes a simulation for every value and 2 N more for its derivatives.
//
// A Formulation does not change after construction (but for its counter, which is atomic, and by
// set_target_state()): several threads may evaluate one object, each with its own results and
// workspaces.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <stillbase/core/interrupt.hpp>
#include <stillbase/encounter/encounter.hpp>
#include <stillbase/impact/batch.hpp>
#include <stillbase/nlp/problem.hpp>

namespace stillbase {

/// Why a constraint is not given to the optimizers.
enum class Redundancy {
  ZeroEverywhere,       ///< satisfied with a zero gradient everywhere: dropped, a distance reported
  ByConstruction,       ///< holds where other constraints do: reported
  CombinationOfOthers,  ///< linear combination of other equations everywhere: reported
  ImpliedByOthers       ///< holds at every solution of the other equations: reported
};

struct RedundantRow {
  std::string name;
  Redundancy reason;
};

/// One line for each row: its name and why it is redundant.
std::string to_string(const std::vector<RedundantRow>& rows);

/// Scenarios and constraints at one point. Without derivatives the matrices stay as they are.
struct ScenarioEvaluation {
  Eigen::VectorXd values;     ///< f_k = 1/2 |y_k|^2 / unit^2 (K)
  Eigen::MatrixXd gradients;  ///< K x N
  Eigen::VectorXd constraints;
  Eigen::MatrixXd jacobian;  ///< m x N
  double far = kInfinity;    ///< see nlp::Evaluation
  // Workspace of the evaluation.
  ImpactBatch batch;
  BatchObjectiveValues batch_values;
};

class Formulation final : public nlp::Problem {
 public:
  /// @throws InputError when there are fewer free variables than independent equations (with the
  /// count), or when the problem's parts do not fit together (a simulated quantity without
  /// controller)
  explicit Formulation(const CaptureProblem& problem);
  /// The same without another table of the target's motion. @param known encounter_model() of it
  Formulation(const CaptureProblem& problem, const EncounterModel& known);
  ~Formulation() override;

  int num_variables() const override;
  int num_constraints() const override;
  Eigen::VectorXd lower() const override;
  Eigen::VectorXd upper() const override;
  Eigen::VectorXd constraint_lower() const override;
  Eigen::VectorXd constraint_upper() const override;
  bool may_have_kinks(int i) const override;
  void evaluate(const Eigen::VectorXd& x, nlp::Evaluation& out) const override;
  void evaluate_value(const Eigen::VectorXd& x, nlp::Evaluation& out) const override;
  /// Exact: the lines of the gradient, differentiated forwards. Not with functions of the user, and
  /// not with simulated terms.
  bool has_hessian() const override;
  void lagrangian_hessian(const Eigen::VectorXd& x, double sigma,
                          const Eigen::VectorXd& multipliers, Eigen::MatrixXd& out) const override;
  double objective_scale() const override { return 1; }

  /// Several scenarios at once: the posture is evaluated and factorised for all of them together.
  void evaluate_scenarios(const Eigen::VectorXd& x, const std::vector<Scenario>& scenarios,
                          bool derivatives, ScenarioEvaluation& out) const;
  /// Of the equations and, unless they alone are asked for, of the inequalities that do not hold:
  /// how far they are off, signed, with the Jacobian (rows x N).
  /// @param with_y whether objective_vector() follows below them
  void evaluate_violated(const Eigen::VectorXd& x, bool equations_alone, bool with_y,
                         Eigen::VectorXd& violation, Eigen::MatrixXd& jacobian) const;
  /// Values of many scenarios at many points (points x scenarios), several at a time in the lanes
  /// of wide registers: for screening, not for solving.
  Eigen::MatrixXd evaluate_points(const std::vector<Eigen::VectorXd>& points,
                                  const std::vector<Scenario>& scenarios) const;
  /// sum_k weights_k d2f_k/dx2 + sum_i multipliers_i d2g_i/dx2.
  void scenario_hessian(const Eigen::VectorXd& x, const std::vector<Scenario>& scenarios,
                        const Eigen::VectorXd& weights, const Eigen::VectorXd& multipliers,
                        Eigen::MatrixXd& out) const;
  /// What presolve found not to be needed by the optimizers.
  const std::vector<RedundantRow>& redundant_rows() const;
  /// What encounters of all configurations have in common.
  const EncounterModel& encounter_model() const;
  /// The nominal encounter at the variables of a configuration.
  Encounter<double> encounter(const Configuration& configuration) const;
  Scenario nominal_scenario() const;  ///< the nominal encounter

  /// Those that are independent where they hold.
  int num_equations() const;
  /// Degrees of freedom that the equations leave.
  int freedom() const { return num_variables() - num_equations(); }

  /// The vector y behind the objective, all terms below each other, divided by its typical size,
  /// with its Jacobian (size of y x N).
  void objective_vector(const Eigen::VectorXd& x, Eigen::VectorXd& y,
                        Eigen::MatrixXd& jacobian) const;
  /// evaluate() and objective_vector() in one, the gradient from J_y' y.
  void evaluate_vector(const Eigen::VectorXd& x, nlp::Evaluation& out, Eigen::VectorXd& y,
                       Eigen::MatrixXd& jacobian) const;
  /// Typical size of y by which the objective is divided.
  double objective_unit() const;
  /// How the objective's value follows from |y|.
  Power objective_power() const;

  Configuration configuration(const Eigen::VectorXd& x) const;
  /// The variables of a configuration: the inverse of configuration().
  Eigen::VectorXd variables(const Configuration& configuration) const;
  /// A start point for u in [0,1)^N: joints within their limits (2 pi for those of every angle),
  /// attitudes uniform over rotations, times uniform.
  Eigen::VectorXd start_point(const Eigen::VectorXd& u) const;
  /// Distance of two points on the configuration manifold: angles wrapped, rotations by their
  /// angle.
  double distance(const Eigen::VectorXd& a, const Eigen::VectorXd& b) const;
  /// Whether distance() is at most that: quick where it is more.
  bool are_within(const Eigen::VectorXd& a, const Eigen::VectorXd& b, double most) const;
  /// a - b, angles that are whole turns apart being equal: within [-pi, pi].
  Eigen::VectorXd difference(const Eigen::VectorXd& a, const Eigen::VectorXd& b) const;
  /// Continuous angles wrapped to (-pi, pi], those of joints with whole turns (plan/turns.hpp)
  /// brought next to the middle of their limits. A search does not know the limits of these.
  Eigen::VectorXd normalised(const Eigen::VectorXd& x) const;
  /// The same posture with the joints that have whole turns within their limits, moved only where
  /// they are beyond them.
  Eigen::VectorXd within_limits(const Eigen::VectorXd& x) const;

  /// Values of all constraints in their own units, by name.
  std::vector<ConstraintValue> report(const Eigen::VectorXd& x) const;
  /// The same again at another point, without allocation. @param out made by report()
  void update_report(const Eigen::VectorXd& x, std::vector<ConstraintValue>& out) const;
  /// The largest violation that it states.
  double largest_violation(const Eigen::VectorXd& x) const;
  /// Of these the limits on rates, singular values and distances.
  std::vector<ConstraintValue> report_limits(const Eigen::VectorXd& x) const;
  /// Evaluations of the model since construction.
  long evaluations() const;

  /// From the stop on simulations are given up: an objective with simulated terms is NaN then, with
  /// its derivatives, and worst cases (robust.hpp) are the largest over the directions seen. The
  /// constraints take no simulation.
  void give_up_simulations_at(const StopCondition& stop);
  const StopCondition& simulations_stop() const;

  /// Takes an estimate of the target in place of the problem's: the same program with other
  /// numbers, its scaling and presolve as they were. The motion of encounter_model() stays that of
  /// the problem; encounter() follows the estimate. No allocation, and not while other threads
  /// evaluate.
  /// @pre reserve_motion(), and the target rotates by no more than that within the horizon
  void set_target_state(const TargetState& estimate);
  /// The half-angle (rad) of the cone that worst cases are over, in place of the problem's.
  void set_cone_half_angle(double half_angle);
  /// Room for the motion of estimates whose target rotates by so much (rad) between estimate and
  /// contact; until then the target moves as stated.
  /// @pre the impulse follows from the target's motion
  void reserve_motion(double rotation);

  /// For the files of this room, and for a replanner, which evaluates without allocation.
  struct Parts;
  const Parts& parts() const { return *parts_; }

 private:
  void remove_implied_rows();
  std::unique_ptr<Parts> parts_;
};

}  // namespace stillbase
