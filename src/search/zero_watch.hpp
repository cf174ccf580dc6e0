// Zeros of the objective close to where a local solve of the nominal problem has come.
//
// Near a zero of 1/2 |y|^2 the Hessian is J_y' J_y, whose eigenvalues differ by many orders where
// one component of y hardly depends on the posture, as after a latch. A quasi-Newton method knows
// nothing of J_y and creeps along such a valley for hundreds of steps. Newton steps onto y = 0 take
// ten, when the inequalities and bounds are rows of the step: at a zero some of them are active.
#pragma once

#include <optional>

#include <stillbase/formulation/formulation.hpp>
#include <stillbase/nlp/optimizer.hpp>

namespace stillbase {

struct ZeroOptions {
  /// Objective, in squares of typical sizes, below which a zero is looked for. Of the starts that
  /// come so far after a latch two of three have one near, and a try costs the evaluations of its
  /// steps alone: the solve goes on.
  double near = 1e-4;
  double again = 1e-2;        ///< part of that objective at which it is tried again
  double violation = 1e-2;    ///< of the constraints, largest at which it is tried
  int steps = 15;             ///< of Newton's method
  int first_steps = 6;        ///< from then on each has to halve what is left
  double longest_step = 0.3;  ///< rad, m, s: farther the linear model does not hold
  double exact = 1e-11;       ///< of y over its typical size, and of the constraints
};

/// The end of Newton steps of least norm onto the constraints and y = 0, inside the bounds. Empty:
/// they do not converge, or contradict each other.
std::optional<Eigen::VectorXd> zero_near(const Formulation& formulation, Eigen::VectorXd x,
                                         const ZeroOptions& options = {});

/// Where a local solve ended.
struct LocalEnd {
  Eigen::VectorXd x;
  bool at_kink = false;  ///< see nlp::OptimizeResult
};

/// What the optimizer leaves, or a zero that was found close to one of the points that it looked
/// at.
/// @param from inside the bounds
LocalEnd minimize_to_zero(const nlp::Optimizer& optimizer, const Formulation& formulation,
                          const Eigen::VectorXd& from, nlp::OptimizeOptions solve,
                          const ZeroOptions& options = {});

}  // namespace stillbase
