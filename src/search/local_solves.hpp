// Local solves of the nominal problem: judged by our own evaluation, made exact, and carried on
// from where a solver stopped short of a minimum.
#pragma once

#include <map>
#include <memory>
#include <string>

#include <stillbase/nlp/optimizer.hpp>
#include <stillbase/search/search.hpp>

#include "search/solution.hpp"

namespace stillbase {

/// Several threads may use one object.
class LocalSolves {
 public:
  /// Number of calls of each solver, by its name.
  using Calls = std::map<std::string, long>;

  /// @throws std::invalid_argument for an optimizer that is not in the registry
  LocalSolves(const CaptureProblem& problem, const Formulation& formulation,
              const SearchOptions& options);

  const nlp::Optimizer& optimizer() const { return *optimizer_; }
  /// Null where what the optimizer leaves is not meant to be a minimum.
  const nlp::Optimizer* rescuer() const { return rescuer_.get(); }
  /// Whether solves end at a zero of the objective as soon as they are near one.
  bool looks_for_zeros() const { return looks_for_zeros_; }
  /// Limits of a solve. @param start number of the start, for the optimizer's seed
  nlp::OptimizeOptions limits(int start) const;
  /// The same of the rescuer, which is close and costs ten times as much.
  nlp::OptimizeOptions brief_limits(int start) const;

  /// What one solve by the optimizer leaves.
  Solution solve(const Eigen::VectorXd& x0, int start, Calls& calls) const;
  /// The same, and on from where it stopped short of a minimum.
  Solution minimum(const Eigen::VectorXd& x0, int start, Calls& calls) const;
  /// Whether a feasible point is not the minimum that a solve is meant to end at.
  bool stopped_short(const Solution& found) const;
  /// On from such a point by the rescuer; `from` itself if that is no better.
  Solution rescued(const Solution& from, int start, Calls& calls) const;

 private:
  Solution solve_by(const nlp::Optimizer& optimizer, const Eigen::VectorXd& x0,
                    const nlp::OptimizeOptions& limits, Calls& calls) const;

  const CaptureProblem& problem_;
  const Formulation& formulation_;
  const SearchOptions& options_;
  std::unique_ptr<nlp::Optimizer> optimizer_, rescuer_;
  bool looks_for_zeros_ = false;
};

}  // namespace stillbase
