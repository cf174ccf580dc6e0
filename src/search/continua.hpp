// Solutions that lie on curves, and the best ones of each curve.
#pragma once

#include <functional>
#include <vector>

#include <stillbase/core/interrupt.hpp>
#include <stillbase/search/search.hpp>

namespace stillbase {

/// A solution of the nominal problem, as often as starts ended there.
struct ContinuumMember {
  Eigen::VectorXd x;
  int reached = 1;
  int family = -1;  ///< -1: on no curve
};

struct Continua {
  std::vector<SolutionFamily> families;
  /// In place of the members of a curve: the local minima of the worst case along it, with the
  /// starts that ended on this side of the next maximum. Where the worst case is the same all along
  /// a curve (the direction is known): the middle of the curve, or of each part that touches
  /// nothing. Those on no curve as they are; after a stop those on curves, too.
  std::vector<ContinuumMember> solutions;
  bool stopped = false;
};

/// Follows the curve through every solution at which the objective vanishes and one direction is
/// open.
/// @param is_free may be empty; else the minima over the part of each curve where it holds are kept
/// as well (reached: 0 where they are no minima of the whole curve); several threads may call it
/// @param jobs threads, each for another solution, then for another point of a curve
Continua follow_continua(const CaptureProblem& problem, const Formulation& formulation,
                         const std::vector<ContinuumMember>& solutions,
                         const std::function<bool(const Configuration&)>& is_free,
                         const StopCondition& stop, int jobs, const ContinuumOptions& options);

}  // namespace stillbase
