// The planning problem as a nonlinear program: variables, objective, constraints.
//
//   variables    free joints; rotation of the base (about one axis, or a rotation vector); contact
//                time. The base position is never a variable: a free station follows the hand, a
//                boxed one becomes a bound on where the hand's point puts it.
//   objective    1/2 |y|^2, y the chosen momentum or rate (norms are not differentiable at zero)
//   constraints  hand equations, case equations reduced to independent rows, closing speed
//
// The only place where the impact model and the optimizers meet. The robot is at rest when it is
// hit. Every evaluation with derivatives costs one evaluation of the model.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <stillbase/impact/gradient.hpp>
#include <stillbase/nlp/problem.hpp>
#include <stillbase/plan/plan.hpp>

namespace stillbase {

/// The encounter at one attitude and time, in B.
struct Encounter {
  Vector6d F;                            ///< [n; moment per unit of impulse]
  double closing_speed = 0;              ///< v_n, m/s (stated, or of the predicted motion)
  double target_inverse_mass = 0;        ///< n' W_t n, 1/kg
  bool magnitude_given = false;          ///< the impulse is stated: no contact law
  bool speed_stated = true;              ///< v_n is the same for every direction
  Vector3d velocity = Vector3d::Zero();  ///< of the target's contact point, when predicted
  Vector3d r = Vector3d::Zero();         ///< contact point from the target's centroid
  Matrix3d target_inverse_inertia = Matrix3d::Zero();  ///< I_t^-1; zero for a point mass
  double target_mass = kInfinity;
};

/// Impulse along the encounter's direction: p of the contact law (1 when given).
double impulse_magnitude(const CaptureProblem& problem, const Encounter& encounter,
                         double hand_inverse_mass);

class Formulation final : public nlp::Problem {
 public:
  /// @throws InputError when there are fewer free variables than independent equations (with the
  /// count), or when the problem's parts do not fit together
  explicit Formulation(const CaptureProblem& problem);
  ~Formulation() override;

  int num_variables() const override;
  int num_constraints() const override;
  Eigen::VectorXd lower() const override;
  Eigen::VectorXd upper() const override;
  Eigen::VectorXd constraint_lower() const override;
  Eigen::VectorXd constraint_upper() const override;
  void evaluate(const Eigen::VectorXd& x, nlp::Evaluation& out) const override;
  void evaluate_value(const Eigen::VectorXd& x, nlp::Evaluation& out) const override;
  /// Central differences of the exact first derivatives, to about 1e-9: the curvature of the hand
  /// equations matters as much as that of the objective, so Gauss-Newton alone creeps.
  bool has_hessian() const override { return true; }
  void lagrangian_hessian(const Eigen::VectorXd& x, double sigma,
                          const Eigen::VectorXd& multipliers, Eigen::MatrixXd& out) const override;
  double objective_scale() const override { return 1; }

  int num_equations() const;
  /// Degrees of freedom that the equations leave.
  int freedom() const { return num_variables() - num_equations(); }

  /// The vector y behind the objective, divided by its typical size (3), with its Jacobian (3 x N).
  void objective_vector(const Eigen::VectorXd& x, Vector3d& y, Eigen::MatrixXd& jacobian) const;
  /// Typical size of y by which the objective is divided.
  double objective_unit() const;

  Configuration configuration(const Eigen::VectorXd& x) const;
  Encounter encounter(const Configuration& configuration) const;
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

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

/// Name and unit of an objective in files.
std::string to_string(ObjectiveQuantity quantity);
std::string unit_of(ObjectiveQuantity quantity);

}  // namespace stillbase
