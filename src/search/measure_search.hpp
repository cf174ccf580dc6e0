// Local minima of the measure from many starts: rough solves from all, fine ones from the best,
// then the other branches of the best.
#pragma once

#include <stillbase/core/interrupt.hpp>

#include "formulation/measures/measure.hpp"

namespace stillbase {

struct MeasureSearchOptions {
  int finished = 16;  ///< solves that are carried to the end; most starts end at the same minima
  int flips = 48;     ///< solves in other branches of the best minima, which often differ by a
                      ///< percent only
};

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
