// The problem's measure over the uncertainty set: its value at a point, its local minimisation, its
// certificate. Values are 1/2 |y|^2 / unit^2, as the nominal objective's.
#pragma once

#include <mutex>
#include <optional>
#include <vector>

#include <stillbase/core/constants.hpp>
#include <stillbase/formulation/measures/robust.hpp>
#include <stillbase/nlp/optimizer.hpp>

namespace stillbase {

struct MeasureSolution {
  Eigen::VectorXd x;
  int solver_calls = 0;
  bool at_kink = false;  ///< finish(): a minimum as OptimizeResult::at_kink has it
};

/// A rough solve, and what it would have been, had it been given up.
struct RoughSolution : MeasureSolution {
  /// After a round over fixed directions.
  struct Round : MeasureSolution {
    double reached = 0;  ///< the minimum over these directions, see RoughLimits::hopeless
  };
  std::vector<Round> rounds;

  /// The same solve with a lower RoughLimits::hopeless.
  MeasureSolution given_up_at(double hopeless) const;
};

/// What ends a rough solve over fixed directions of the cone early.
struct RoughLimits {
  int evaluations = 24;  ///< of a solve with fixed directions: most of its descent
  /// Largest violation of its end, which is then moved onto the constraints. A descent seldom comes
  /// back onto curved constraints before it is over: were its points to satisfy them, half of those
  /// of deos_client_224 would end where they began.
  double violation = 1e-3;
  /// Tolerance of its end: it goes on to a thousandth of it. With 1e-2 two more seeds of sixty miss
  /// the best minimum of the hardest random problem of the tests.
  double kkt_residual = 1e-4;
  int projection_steps = 8;
  double projected = 1e-6;  ///< violation that is left then
  /// Measure beyond which a start is given up: what it reached over the directions so far exceeds
  /// it, and over the cone its minimum is no less than over these.
  double hopeless = kInfinity;
  /// On the rim, beside the worst ones, from the first solve on; 0: none. Without them it leaves
  /// for places where others are worse: from 0.1 rad off a minimum over a cone of 20 deg one of 30
  /// solves comes back to it, with eight directions 26.
  int rim_directions = 8;
};

/// How the worst case over the cone is minimised.
struct MeasureOptions {
  int rounds = 6;  ///< of a local solve and a new set of directions
  /// Of a solve with directions that follow the maxima, which needs 10 to 100: a thousand without a
  /// way down take as long as all others of a search. Not where each is simulated.
  int evaluations = 120;
  double near = 1e-2;  ///< relative excess at which the directions hardly change any more
  double counting_maximum = 0.25;  ///< of the worst |y|^2: smaller maxima do not count yet
  double finished = 1e-8;          ///< KKT residual after which no round follows
  double same_point = 1e-6;        ///< rad: a solve that has moved no farther has found its start
  double same_value = 1e-9;        ///< relative excess of |y|^2 over the maxima that were followed
  double zero = kZeroObjective;    ///< of the typical size: of less only rounding is left
};

/// Several threads may use one object: what is known of a point does not depend on who asked first.
class Measure {
 public:
  Measure(const CaptureProblem& problem, const Formulation& formulation,
          const MeasureOptions& options = {});

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
  /// ones. Mean over the residual velocity: the solve of finish() with fewer evaluations. Samples:
  /// nothing, their solve costs too much for many starts.
  RoughSolution minimize_roughly(const nlp::Optimizer& optimizer,
                                 const nlp::OptimizeOptions& options, const Eigen::VectorXd& x0,
                                 const RoughLimits& limits = {});

  /// Local minimisation from x0 until KKT holds. Worst case: with directions that follow the maxima
  /// of the cone, so x0 should be near.
  MeasureSolution finish(const nlp::Optimizer& optimizer, const nlp::OptimizeOptions& options,
                         const Eigen::VectorXd& x0);

  /// KKT of the smooth form at x, without anything that the solver knew: active directions are
  /// searched for. Kept where nothing is simulated, but for the nominal value.
  nlp::Certificate certify(const Eigen::VectorXd& x);

  /// The local minimum of the measure over the uncertainty that x is near, to its last digits: see
  /// nlp::refined_minimum(), which does for the nominal value. x itself where derivatives take
  /// simulations or are none, of CVaR, and where nothing is left of the measure.
  Eigen::VectorXd refined(const Eigen::VectorXd& x);

 private:
  RoughSolution exchange(const nlp::Optimizer& optimizer, const nlp::OptimizeOptions& options,
                         const Eigen::VectorXd& x0, const RoughLimits& limits = {});
  MeasureSolution follow(const nlp::Optimizer& optimizer, const nlp::OptimizeOptions& options,
                         const Eigen::VectorXd& x0);
  /// Directions from which exchange() begins.
  std::vector<Scenario> first_directions(const std::vector<ConeMaximum>& worst,
                                         int rim_directions) const;
  std::vector<ConeMaximum> maxima_at(const Eigen::VectorXd& x) const;
  /// Whether no direction has to be simulated.
  bool is_closed_form() const;
  /// 1/2 |y|^2 / unit^2 at a value of the objective.
  double half_square(double value) const;
  double sampled_value(const Eigen::VectorXd& x);
  nlp::Certificate certificate_at(const Eigen::VectorXd& x);
  std::optional<double> level() const;

  /// What is known of a point: worst cases and samples may take a simulation each.
  struct Known {
    Eigen::VectorXd x;
    std::optional<WorstCase> worst = {};
    std::optional<double> sampled = {};
    std::optional<nlp::Certificate> certificate = {};
  };
  std::vector<Known>::iterator find_known(const Eigen::VectorXd& x);
  Known known(const Eigen::VectorXd& x);
  /// Adds to what is known of a point. @param add called with it
  template <class Add>
  void remember(const Eigen::VectorXd& x, const Add& add);

  const CaptureProblem& problem_;
  const Formulation& formulation_;
  const MeasureOptions options_;
  std::vector<Scenario> samples_;  ///< Expectation, Cvar
  Eigen::VectorXd weights_;
  std::mutex mutex_;  // of what follows
  std::vector<Known> known_;
};

}  // namespace stillbase
