// Solutions of a search to their last digits, so that another compiler or another order of
// additions ends at the same ones.
#pragma once

#include <functional>
#include <vector>

#include <stillbase/search/search.hpp>

#include "formulation/measures/measure.hpp"
#include "search/solution.hpp"

namespace stillbase {

class Refinement {
 public:
  /// @param jobs threads
  Refinement(const CaptureProblem& problem, const Formulation& formulation, Measure& measure,
             const SearchOptions& options, int jobs);

  /// Whether there are exact derivatives for Newton steps. Otherwise nothing changes.
  bool is_possible() const;

  using Counts = std::function<bool(const Solution&)>;

  /// Local minima of the nominal value. After a stop some are left as they are.
  /// @param counts the others stay as they are, too; called by several threads
  void refine_nominal(std::vector<Solution>& solutions, const Counts& counts) const;
  /// Local minima of the measure, likewise.
  void refine_measure(std::vector<Solution>& solutions) const;

  /// A local minimum of the nominal value; `from` itself where that leads elsewhere.
  Solution nominal(const Solution& from) const;

 private:
  template <class Refined>
  void refine(std::vector<Solution>& solutions, const Counts& counts, const Refined& refined) const;
  Solution by_measure(const Solution& from) const;
  bool takes_place_of(const Solution& from, const Solution& out, double most) const;
  Eigen::VectorXd rounded_zero(const Eigen::VectorXd& x) const;

  const CaptureProblem& problem_;
  const Formulation& formulation_;
  Measure& measure_;
  const SearchOptions& options_;
  const int jobs_;
};

}  // namespace stillbase
