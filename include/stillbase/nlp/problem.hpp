// The neutral form of a smooth optimisation problem. Knows no robot and no solver.
//
//   minimise f(x)   subject to   g_l <= g(x) <= g_u,   l <= x <= u,   x in R^N, g in R^m
//
// Assumptions: f and g are twice differentiable where they are defined; variables, constraints and
// (after division by objective_scale) the objective are of order one, so that one absolute
// tolerance means the same for all of them: a problem divides by its own typical sizes. The
// equations among the constraints are independent; solvers fail on redundant ones.
#pragma once

#include <Eigen/Core>
#include <any>
#include <limits>

#include <stillbase/core/constants.hpp>

namespace stillbase::nlp {

using stillbase::kInfinity;

/// Scratch memory of any type, which goes its own way: copies have none, and an assignment leaves
/// it as it is.
class Workspace {
 public:
  Workspace() = default;
  Workspace(const Workspace& /*other*/) {}
  Workspace(Workspace&&) = default;
  Workspace& operator=(const Workspace& /*other*/) { return *this; }
  Workspace& operator=(Workspace&&) = default;
  ~Workspace() = default;

  /// What is kept as a T, a fresh one when it was none.
  template <class T>
  T& as() {
    if (std::any_cast<T>(&kept_) == nullptr) kept_ = T();
    return *std::any_cast<T>(&kept_);
  }

 private:
  std::any kept_;
};

/// Values and first derivatives at one point.
struct Evaluation {
  double objective = 0.0;       ///< f
  Eigen::VectorXd gradient;     ///< df/dx (N)
  Eigen::VectorXd constraints;  ///< g (m)
  Eigen::MatrixXd jacobian;     ///< dg/dx (m x N)
  /// Set by the caller: evaluate() may give an inequality that holds by more than this as if it
  /// held by just this, with a zero gradient.
  double far = kInfinity;
  /// For evaluate(), kept between calls: what another one left there, of this or of another
  /// problem.
  Workspace workspace;
};

/// A problem. Every function is a pure function of its arguments: same x, same bytes, from any
/// number of threads, each with its own Evaluation. An evaluation may throw: the exception comes
/// out of Optimizer::minimize with type and text. It may also return NaN or infinity where the
/// model is not defined: such a point is refused.
class Problem {
 public:
  virtual ~Problem() = default;

  virtual int num_variables() const = 0;    ///< N >= 1
  virtual int num_constraints() const = 0;  ///< m >= 0

  /// l and u (N), l <= u; infinite where there is no bound. The model is never asked outside.
  virtual Eigen::VectorXd lower() const;
  virtual Eigen::VectorXd upper() const;

  /// g_l and g_u (m), g_l <= g_u; infinite where there is no bound, equal for an equation.
  virtual Eigen::VectorXd constraint_lower() const = 0;
  virtual Eigen::VectorXd constraint_upper() const = 0;

  /// Whether g_i may be the least of several smooth functions, as a distance of bodies is, with the
  /// gradient of one of them. Of use to `sqp`, for a lower bound.
  virtual bool may_have_kinks(int /*i*/) const { return false; }

  /// Everything at x (N) in one evaluation of the model. `out` keeps its storage between calls; all
  /// four members must be set, with the sizes above (m may be 0).
  virtual void evaluate(const Eigen::VectorXd& x, Evaluation& out) const = 0;

  /// f and g alone, for solvers without derivatives; the other two members may be left as they are.
  /// Must give the same bytes as evaluate(). Default: evaluate().
  virtual void evaluate_value(const Eigen::VectorXd& x, Evaluation& out) const { evaluate(x, out); }

  virtual bool has_hessian() const { return false; }

  /// sigma d2f/dx2 + sum_i multipliers_i d2g_i/dx2 (N x N, both triangles). Called only when
  /// has_hessian().
  virtual void lagrangian_hessian(const Eigen::VectorXd& x, double sigma,
                                  const Eigen::VectorXd& multipliers, Eigen::MatrixXd& out) const;

  /// Size of f that matters, > 0: gradients below optimality_tolerance * objective_scale() count as
  /// zero. Needed because an objective such as a square leaves no scale at its minimum.
  virtual double objective_scale() const { return 1.0; }
};

/// Distance of x from its box and of g from its range, componentwise and signed: positive above the
/// upper bound, negative below the lower bound, zero inside. Shapes as `value`.
Eigen::VectorXd signed_violation(const Eigen::VectorXd& value, const Eigen::VectorXd& lower,
                                 const Eigen::VectorXd& upper);

}  // namespace stillbase::nlp
