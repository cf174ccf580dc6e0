// Local minima of the measure from many starts: rough solves from all, further rounds of starts and
// of hops from the best minimum, fine solves from the best, then the other branches of the best.
#pragma once

#include <stillbase/core/random.hpp>
#include <stillbase/search/search.hpp>

#include "formulation/measures/measure.hpp"

namespace stillbase {

/// Where solves of the measure begin.
struct MeasureStarts {
  std::vector<Eigen::VectorXd> postures;   ///< on the constraints to about 1e-3
  std::vector<Eigen::VectorXd> solutions;  ///< of the nominal problem
};

struct MeasureMinima {
  std::vector<Eigen::VectorXd>
      points;  ///< on the constraints; repeated when reached more than once
  int solver_calls = 0;
  /// Starts that ended at the best value by themselves; hops from the best minimum do not count.
  int reached = 0;
  bool is_zero = false;  ///< the best value, but for rounding
  bool stopped = false;
};

/// A place in a random direction from x, at a distance of the options: small ones are as likely as
/// large ones, by their logarithm. Not on the constraints.
Eigen::VectorXd hopped(const Eigen::VectorXd& x, Random& random,
                       const MeasureSearchOptions& options);

/// Further starts of a round (from 0), on the constraints to about 1e-3.
using MoreStarts = std::function<std::vector<Eigen::VectorXd>(int round)>;

/// Rough solves from `starts` and from those of further rounds, fine ones from the best of them.
/// @param more may be empty: then there are no further rounds
/// @param is_free whether a configuration touches nothing; may be empty
/// @param jobs threads; the result does not depend on their number
MeasureMinima measure_minima(const Formulation& formulation, Measure& measure,
                             const nlp::Optimizer& optimizer, const nlp::OptimizeOptions& solve,
                             const MeasureStarts& starts, const MoreStarts& more,
                             const std::function<bool(const Configuration&)>& is_free,
                             std::uint64_t seed, int jobs, const MeasureSearchOptions& options);

}  // namespace stillbase
