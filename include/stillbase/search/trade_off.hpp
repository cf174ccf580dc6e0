// Two quantities against each other: the less the one, the more the other.
//
// Nenchev and Yoshida, section II-A: a base that takes little momentum leaves it to the arm, whose
// joints then move fast. The front is found by the epsilon-constraint method: the second quantity
// is minimised while the first may not exceed a level, for levels between the two extremes. Unlike
// weighted sums it also reaches the parts of a front that are not convex.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include <stillbase/core/interrupt.hpp>
#include <stillbase/formulation/formulation.hpp>

namespace stillbase {

struct TradeOffOptions {
  std::string optimizer = "sqp";
  int starts = 64;  ///< of the search for each extreme
  std::uint64_t seed = 1;
  int levels = 24;  ///< at least 2
  /// Called after every level with (done, total); may be empty.
  std::function<void(int, int)> on_progress;
  StopCondition stop;
  int jobs = 1;  ///< threads; 0: one per processor. The front does not depend on it

  std::size_t solves_per_kind = 6;  ///< per level: from points that keep it, and from beyond it
  int draws_per_start = 8;          ///< postures drawn per start of the search
  /// What counts as having the least of a quantity: so near to it, relative to that value.
  double near_least = 1e-6;
  /// The same relative to the value at the other end: the square of a quantity has no gradient at
  /// zero that could hold it there.
  double near_zero = 1e-5;
  double same = 1e-4;            ///< relative: what that is worth in the other quantity
  double start_distance = 0.05;  ///< rad: starts nearer to each other are one
};

/// A configuration that no other one known is better than in both quantities.
struct TradeOffPoint {
  Configuration configuration;
  double first = 0, second = 0;  ///< nominal, in their own units
  double max_violation = 0;      ///< of the problem's constraints
  /// Of "least second, with the first at most as large as here"; infinite where it is not known: a
  /// limit or an interrupt came before the simulations that it takes.
  double kkt_residual = 0;
};

struct TradeOff {
  ObjectiveQuantity first, second;
  std::vector<TradeOffPoint> points;  ///< by rising first, falling second; empty: infeasible
  bool stopped = false;               ///< a limit or an interrupt ended it early
  std::map<std::string, long> solver_calls;
};

/// The front of two nominal quantities under the constraints of the problem. Its own
/// objective does not count, but for the time of attitude_turned, which has to be one of its terms.
/// Each end is the best in one quantity of all that have the least of the other (to 1e-6 of it; to
/// 1e-5 of its value at the other end where it can vanish).
///
/// @throws std::invalid_argument for equal quantities, fewer than two levels, or an optimizer that
/// is not in the registry
/// @throws InputError as Formulation
TradeOff trade_off(const CaptureProblem& problem, ObjectiveQuantity first, ObjectiveQuantity second,
                   const TradeOffOptions& options);

}  // namespace stillbase
