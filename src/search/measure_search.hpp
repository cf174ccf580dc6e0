// Local minima of the measure from many starts: rough solves from all, fine ones from the best,
// then the other branches of the best.
#pragma once

#include <stillbase/search/search.hpp>

#include "formulation/measures/measure.hpp"

namespace stillbase {

struct MeasureMinima {
  std::vector<Eigen::VectorXd>
      points;  ///< on the constraints; repeated when reached more than once
  int solver_calls = 0;
  bool stopped = false;
};

/// @param starts on the constraints to about 1e-3
MeasureMinima measure_minima(const Formulation& formulation, Measure& measure,
                             const nlp::Optimizer& optimizer, const nlp::OptimizeOptions& solve,
                             const std::vector<Eigen::VectorXd>& starts,
                             const MeasureSearchOptions& options);

}  // namespace stillbase
