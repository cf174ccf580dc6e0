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
  std::string optimizer = "nlopt-slsqp";
  int starts = 64;  ///< of the search for each extreme
  std::uint64_t seed = 1;
  int levels = 24;  ///< at least 2
  /// Called after every level with (done, total); may be empty.
  std::function<void(int, int)> on_progress;
  StopCondition stop;
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
