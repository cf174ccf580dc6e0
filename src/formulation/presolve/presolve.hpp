// Presolve: which constraints are given to the optimizers.
//
// Optimizers fail on equations that depend on each other. Three kinds of rows are redundant:
// rows that are satisfied everywhere with a zero gradient (a planar robot's third direction),
// equations that are linear combinations of others everywhere (a plane that is none of the axes'
// planes), and equations of the case that others imply at every solution. The last two are
// reported and judged with the others; of the first only distances are, which may change elsewhere.
#pragma once

#include <vector>

#include <stillbase/formulation/formulation.hpp>

#include "formulation/constraints/constraint.hpp"

namespace stillbase {

/// Thresholds of presolve, and how many points are looked at.
struct PresolveOptions {
  int samples = 8;             ///< start points for zero rows and combinations
  double zero = 1e-12;         ///< largest entry of a gradient that counts as zero, in row units
  double combination = 1e-10;  ///< remainder of a combination, of the row's size over all samples
  int solution_trials = 24;    ///< projections onto the equations, to find solutions
  int projection_steps = 40;   ///< of each
  int solutions_wanted = 8;    ///< Jacobians at solutions that are compared
  int fewest_solutions = 3;    ///< with fewer, no equation counts as implied
  double solved = 1e-10;       ///< violation of a solution
  double rank = 1e-6;          ///< singular values that count, of the largest one
  double holds = 1e-6;         ///< violation of an implied equation at a solution of the others
};

/// Rows given to the optimizers, rows reported with them, and what is redundant and why.
struct SelectedRows {
  std::vector<const Constraint*> kept, reported;
  std::vector<RedundantRow> redundant;

  int num_equations() const;
};

/// Without the rows that are zero everywhere and the equations that are combinations of others
/// everywhere. Reported are also those constraints that hold by construction, and distances
/// that are flat at all samples.
SelectedRows select_independent_rows(const CaptureModel& model, const ConstraintSet& constraints,
                                     const PresolveOptions& options = {});

}  // namespace stillbase
