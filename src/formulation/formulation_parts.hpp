// The inside of a Formulation. Everything but the counter is set at construction: any number of
// threads may evaluate one object.
#pragma once

#include <atomic>

#include <stillbase/formulation/formulation.hpp>

#include "formulation/constraints/constraint.hpp"
#include "formulation/objectives/differenced_terms.hpp"
#include "formulation/objectives/jump_objective.hpp"
#include "formulation/presolve/presolve.hpp"

namespace stillbase {

struct Formulation::Parts {
  CaptureModel model;
  JumpObjective jump;
  DifferencedTerms differenced;
  double objective_unit = 1;
  ConstraintSet constraints;
  SelectedRows rows;  ///< of the constraints
  /// Of each row that is kept; without shapes: of none.
  std::vector<std::optional<ShapeSpheres>> spheres;
  /// Whether one of them does, as ConstraintLabel.
  bool rows_need_inertia = false, rows_need_encounter = false, rows_need_impact = false;
  StopCondition simulations_stop;
  std::atomic<long> evaluations = 0;

  Parts(const CaptureProblem& problem, const EncounterModel& known);

  void select(SelectedRows selected);
  void count(long more) { evaluations.fetch_add(more, std::memory_order_relaxed); }

  /// 1/2 |y|^2 / unit^2 of a scenario, NaN where a simulation was given up.
  /// @param gradient over the variables (N), or null
  double objective(const Placement<double>& at, const PostureImpact<double>& posture,
                   const ScenarioImpact<double>& impact, const Scenario& scenario,
                   GradientRow* gradient) const;
  double objective(const NominalPoint& here, GradientRow* gradient) const;
  /// Adds what differenced terms are worth to a value and its gradient.
  void add_differenced(const Placement<double>& at, const Scenario& scenario, double& value,
                       GradientRow* gradient) const;
  /// y of the nominal scenario, divided by its typical size, and its Jacobian below `first` rows
  /// that are left to be filled in.
  void add_vector(const Placement<double>& at, const PostureImpact<double>& posture,
                  const ScenarioImpact<double>& impact, Eigen::Index first, Eigen::VectorXd& y,
                  Eigen::MatrixXd& jacobian) const;
  /// Posture and nominal impact as far as the rows need them.
  PostureImpact<double> posture_of_rows(const Placement<double>& at) const;
  ScenarioImpact<double> impact_of_rows(const Placement<double>& at,
                                        const PostureImpact<double>& posture) const;
  /// Whether a row that is kept is known to hold by more than `by` without being evaluated.
  bool surely_holds(std::size_t row, const ConstraintPoint<double>& at, const ShapeOrigins& origins,
                    double by) const;
  /// Values of the rows, and unless it is null their Jacobian; both have their sizes.
  /// @param far see nlp::Evaluation; only with a Jacobian
  void evaluate_rows(const ConstraintPoint<double>& at, Eigen::VectorXd& values,
                     Eigen::MatrixXd* jacobian, double far = kInfinity) const;

  /// sum w_k grad f_k over scenarios + sum multipliers_i grad g_i.
  VectorX<Tangent> lagrangian_gradient(const VectorX<Tangent>& x,
                                       const std::vector<Scenario>& scenarios,
                                       const Eigen::VectorXd& weights,
                                       const Eigen::VectorXd& multipliers) const;

  // Scenarios in the lanes of wide registers (scenarios.cpp).
  bool in_packs(const std::vector<Scenario>& scenarios) const;
  void resize_batch(Eigen::Index count, ImpactBatch& batch) const;
  void put_in_batch(const Placement<double>& at, const ScenarioImpact<double>& impact,
                    const Scenario& scenario, Eigen::Index row, ImpactBatch& batch) const;
  void evaluate_batch(bool derivatives, const ImpactBatch& batch, BatchObjectiveValues& out) const;
  void evaluate_in_packs(const Placement<double>& at, const std::vector<Scenario>& scenarios,
                         bool derivatives, ScenarioEvaluation& out) const;
};

}  // namespace stillbase
