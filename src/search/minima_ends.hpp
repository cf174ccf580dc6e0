// The ends of the best minima of a measure, where the solver of the search stopped short of them.
#pragma once

#include <vector>

#include <stillbase/search/search.hpp>

#include "formulation/measures/measure.hpp"
#include "search/solution.hpp"

namespace stillbase {

class MinimaEnds {
 public:
  MinimaEnds(const CaptureProblem& problem, const Formulation& formulation, Measure& measure,
             const SearchOptions& options)
      : problem_(problem), formulation_(formulation), measure_(measure), options_(options) {}

  /// Adds a point that satisfies the constraints.
  void keep(const Eigen::VectorXd& x, std::vector<Solution>& minima) const;

  /// Goes on from all that are equal to the best, because the choice between them comes later:
  /// first for the last digits, and where these are not all that is missing, by the rescuer.
  /// @returns how often the rescuer was called
  long finish(const nlp::Optimizer& rescuer, const nlp::OptimizeOptions& solve,
              std::vector<Solution>& minima) const;

 private:
  bool is_minimum(const Eigen::VectorXd& x) const;
  /// Puts x in the place of a minimum that it equals but for rounding, where its KKT residual is
  /// smaller.
  bool takes_place_of(Solution& minimum, const Eigen::VectorXd& x) const;
  /// The best of the minima that are equal to the best of all; null: all are among those seen.
  Solution* best_not_in(const std::vector<Eigen::VectorXd>& seen,
                        std::vector<Solution>& minima) const;

  const CaptureProblem& problem_;
  const Formulation& formulation_;
  Measure& measure_;
  const SearchOptions& options_;
};

}  // namespace stillbase
