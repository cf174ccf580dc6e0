// The problem's measure over the uncertainty set: its value at a point, its local minimisation, its
// certificate. Values are 1/2 |y|^2 / unit^2, as the nominal objective's.
#pragma once

#include <optional>
#include <vector>

#include <stillbase/formulation/measures/robust.hpp>
#include <stillbase/nlp/optimizer.hpp>

namespace stillbase {

struct MeasureSolution {
  Eigen::VectorXd x;
  int solver_calls = 0;
};

class Measure {
 public:
  Measure(const CaptureProblem& problem, const Formulation& formulation);

  RiskMeasure kind() const { return problem_.measure.kind; }
  bool is_nominal() const { return problem_.measure.kind == RiskMeasure::Nominal; }
  /// NaN when simulations were given up. Values are kept: a point is evaluated once.
  double value(const Eigen::VectorXd& x);
  /// The same as the objective's value, in its unit.
  double reported(const Eigen::VectorXd& x);
  /// Of the problem's cone, whatever the measure is; kept likewise.
  WorstCase worst_at(const Eigen::VectorXd& x);
  /// Whether value and worst case of this point are known.
  bool knows(const Eigen::VectorXd& x);

  /// A few steps of local minimisation from x0, for a first ranking of many starts.
  ///
  /// Worst case by an exchange method: minimise the worst of the active directions (epigraph), add
  /// the worst directions of the cone at the solution, until none is much worse than the active
  /// ones. Samples: nothing, one solve is all that they need.
  MeasureSolution minimize_roughly(const nlp::Optimizer& optimizer,
                                   const nlp::OptimizeOptions& options, const Eigen::VectorXd& x0);

  /// Local minimisation from x0 until KKT holds. Worst case: with directions that follow the maxima
  /// of the cone, so x0 should be near.
  MeasureSolution finish(const nlp::Optimizer& optimizer, const nlp::OptimizeOptions& options,
                         const Eigen::VectorXd& x0);

  /// KKT of the smooth form at x, without anything that the solver knew: active directions are
  /// searched for.
  nlp::Certificate certify(const Eigen::VectorXd& x);

 private:
  MeasureSolution exchange(const nlp::Optimizer& optimizer, const nlp::OptimizeOptions& options,
                           const Eigen::VectorXd& x0);
  MeasureSolution follow(const nlp::Optimizer& optimizer, const nlp::OptimizeOptions& options,
                         const Eigen::VectorXd& x0);
  std::vector<ConeMaximum> maxima_at(const Eigen::VectorXd& x) const;
  /// 1/2 |y|^2 / unit^2 at a value of the objective.
  double half_square(double value) const;
  double sampled_value(const Eigen::VectorXd& x);
  std::optional<double> level() const;

  /// What is known of a point: worst cases and samples may take a simulation each.
  struct Known {
    Eigen::VectorXd x;
    std::optional<WorstCase> worst;
    std::optional<double> sampled;
  };
  Known& known(const Eigen::VectorXd& x);

  const CaptureProblem& problem_;
  const Formulation& formulation_;
  std::vector<Scenario> samples_;  ///< Expectation, Cvar
  Eigen::VectorXd weights_;
  std::vector<Known> known_;
};

}  // namespace stillbase
