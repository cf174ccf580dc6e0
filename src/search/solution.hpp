// A point that a search ended at: judged by our own evaluation, made exact, told apart from others.
#pragma once

#include <cmath>
#include <vector>

#include <stillbase/formulation/formulation.hpp>

namespace stillbase {

inline constexpr double kOptimal = 1e-6;  ///< largest KKT residual of an optimal plan

struct Solution {
  Eigen::VectorXd x;
  double objective = kInfinity;  ///< nominal, or the measure's; 1/2 |y|^2 in objective units
  double violation = kInfinity;
  int reached = 1;
  int family = -1;  ///< the curve that it is on
  /// The solver ended here at a kink of a constraint, as nlp::OptimizeResult::at_kink has it.
  bool at_kink = false;
  bool is_refined = false;  ///< to its last digits, as far as that goes

  double length() const { return std::sqrt(2 * objective); }  ///< |y|, in objective units
};

/// Largest violation of the constraints and, where its rows hold and the case does not, of the
/// case: rows along two columns of a coupling matrix of rank 2 say little of it where the two are
/// nearly parallel.
double largest_violation(const CaptureProblem& problem, const Formulation& formulation,
                         const Eigen::VectorXd& x);

/// Nominal objective, which takes a simulation even where others were given up, and violation.
Solution judge(const CaptureProblem& problem, const Formulation& formulation,
               const Eigen::VectorXd& x);

/// The better of two points: feasible before infeasible, then the lower objective.
bool better(const Solution& a, const Solution& b);

/// What a local solver leaves is close; Newton steps make constraints exact and zeros exact.
Solution polish(const CaptureProblem& problem, const Formulation& formulation,
                const Solution& found);

/// Adds a solution, or a start to the one that it repeats. @param same largest distance of these
void keep_distinct(const Formulation& formulation, const Solution& found,
                   std::vector<Solution>& solutions, double same);

}  // namespace stillbase
