// Compass search: polls 2 N points around the best one, halves the step when none is better.
#include "nlp/adapters.hpp"
#include "nlp/monitor.hpp"

namespace stillbase::nlp {
namespace {

double merit(const Monitor& monitor, const Evaluation& e) {
  return e.objective + 100 * signed_violation(e.constraints, monitor.constraint_lower(),
                                              monitor.constraint_upper())
                                 .lpNorm<1>();
}

class CompassSearch final : public Optimizer {
 public:
  CompassSearch()
      : Optimizer({.name = "compass-search", .about = "polls the axes", .uses_gradient = false}) {}

 private:
  NativeOutcome solve(Monitor& monitor, const Eigen::VectorXd& start,
                      const OptimizeOptions&) const override {
    Eigen::VectorXd x = start;
    const Evaluation* e = monitor.evaluate(x.data());  // null: NaN, or the solver has to stop
    if (e == nullptr) return {-1, "no finite start", ""};
    double best = merit(monitor, *e);
    for (double step = 0.5; step > 1e-10 && !monitor.stopped();) {
      bool is_better = false;
      for (Eigen::Index i = 0; i < 2 * x.size() && !is_better; ++i) {
        Eigen::VectorXd trial = x;
        trial[i / 2] += i % 2 == 0 ? step : -step;
        trial = trial.cwiseMax(monitor.lower()).cwiseMin(monitor.upper());
        e = monitor.evaluate(trial.data());
        is_better = e != nullptr && merit(monitor, *e) < best;
        if (is_better) best = merit(monitor, *e), x = trial;
      }
      if (!is_better) step /= 2;
    }
    return {0, "the step is small", ""};
  }
};

}  // namespace

Optimizers compass_search() { return single<CompassSearch>(); }

}  // namespace stillbase::nlp
