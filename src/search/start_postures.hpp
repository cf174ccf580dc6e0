// Where the solves of a search begin.
#pragma once

#include <functional>
#include <vector>

#include <stillbase/search/search.hpp>

#include "formulation/projection.hpp"
#include "search/measure_search.hpp"

namespace stillbase {

/// Postures that are drawn from a low-discrepancy sequence and moved onto the constraints, and
/// those of them that look best for the measure. The same seed gives the same ones for any number
/// of threads.
class StartPostures {
 public:
  /// @param isolated  as many equations as variables: many more starts, of Newton steps alone
  /// @param jobs      threads
  StartPostures(const CaptureProblem& problem, const Formulation& formulation,
                const SearchOptions& options, bool isolated, int jobs);

  /// Number of starts of the nominal problem, those that were asked for in addition included.
  int starts() const;

  /// A start point on the constraints, or as near to them as a few draws come.
  ProjectionResult of(int start) const;

  /// Where solves of the measure begin: at the solutions of the nominal problem, and at what looks
  /// best for the measure of `postures` on the constraints and of many more. Where rounds follow,
  /// at what looks best of the solutions, too.
  MeasureStarts first(std::vector<Eigen::VectorXd> postures, std::vector<Eigen::VectorXd> solutions,
                      bool in_rounds) const;

  /// Starts of a further round: postures that look best for the measure, and zeros of the nominal
  /// value that do. Minima of the measure are often near the best zeros of a self-motion, and
  /// Newton steps to a zero cost a tenth of a solve. Where a round finds no zero later ones do not
  /// look for them.
  std::vector<Eigen::VectorXd> fresh(int round);

 private:
  /// Point i of a list.
  using PointOf = std::function<Eigen::VectorXd(int i)>;

  Eigen::VectorXd drawn(int index) const;
  ProjectionResult projected(const Eigen::VectorXd& x) const;
  /// Those of `count` points that can be moved onto the constraints, there, in their order.
  /// @param zero_objective as project_onto_constraints(), which takes `steps`
  std::vector<Eigen::VectorXd> moved_onto_constraints(int count, int steps, bool zero_objective,
                                                      const PointOf& start) const;
  /// Postures on the constraints, of a batch of draws that no start has used.
  std::vector<Eigen::VectorXd> drawn_postures(int batch) const;
  /// At most `kept` of them, by screening.
  std::vector<Eigen::VectorXd> best(const std::vector<Eigen::VectorXd>& points, int kept) const;
  /// Zeros after a few random steps along their self-motions, each taken where the measure falls.
  std::vector<Eigen::VectorXd> walk_along_zeros(std::vector<Eigen::VectorXd> zeros,
                                                int round) const;

  const CaptureProblem& problem_;
  const Formulation& formulation_;
  const SearchOptions& options_;
  const bool isolated_;
  const int jobs_;
  const int drawn_starts_;
  const int steps_;          ///< Newton steps onto the constraints
  bool may_be_zero_ = true;  ///< the nominal value, as far as rounds know
};

}  // namespace stillbase
