// Pure random search: S. H. Brooks, A discussion of random methods for seeking maxima, Operations
// Research 6 (1958). Evenly spread points of the box, each moved onto the constraints; the best
// one counts. No optimizer that costs more and finds less is worth its name.
#include "nlp/adapters.hpp"
#include "nlp/restoration.hpp"

#include <stillbase/core/random.hpp>

namespace stillbase::nlp {
namespace {

// From a far point, Newton's method either converges within about ten steps or not at all.
constexpr int kStepsToFeasible = 12;

class RandomSearch final : public Optimizer {
 public:
  RandomSearch()
      : Optimizer({.name = "random-search",
                   .about = "low-discrepancy points moved onto the constraints, the best counts",
                   .global = true,
                   .stochastic = true}) {}

 private:
  NativeOutcome solve(Monitor& monitor, const Eigen::VectorXd& start,
                      const OptimizeOptions& options) const override {
    const int n = static_cast<int>(start.size());
    for (int index = 0; !monitor.stopped(); ++index) {
      const Eigen::VectorXd u = low_discrepancy_point(index, n, options.seed);
      Eigen::VectorXd x = monitor.lower() + u.cwiseProduct(monitor.upper() - monitor.lower());
      const Evaluation* e = monitor.evaluate(x.data());
      if (e == nullptr) continue;
      Evaluation at_x = *e;
      restore(monitor, monitor.constraint_lower(), monitor.constraint_upper(),
              0.1 * options.feasibility_tolerance, kStepsToFeasible, x, at_x);
    }
    return {0, "ran until it was stopped", ""};
  }
};

}  // namespace

Optimizers random_search() { return single<RandomSearch>(); }

}  // namespace stillbase::nlp
