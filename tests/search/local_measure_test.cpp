// The local minimisation of the worst case over a cone.
#include <catch2/catch.hpp>

#include <stillbase/nlp/optimizer.hpp>
#include <stillbase/search/search.hpp>

#include "formulation/measures/measure.hpp"
#include "formulation/projection.hpp"
#include "support/random_capture.hpp"

namespace stillbase {

TEST_CASE("rough solves from 0.1 rad off a minimum of the worst case return to it") {
  constexpr int kTrials = 20;
  for (const std::uint64_t number : {14, 47, 56}) {
    const CaptureProblem problem = random_capture(number);
    const Formulation formulation(problem);
    const SearchResult found = search(problem, formulation, {});
    REQUIRE(found.status == PlanStatus::Feasible);
    Measure measure(problem, formulation);
    const Eigen::VectorXd& minimum = found.points.front();
    const double least = measure.value(minimum);

    nlp::OptimizeOptions solve;
    solve.feasibility_tolerance = kFeasibilityTolerance;
    const auto optimizer = nlp::make_optimizer("nlopt-slsqp");
    Random random(7);
    int returned = 0;
    for (int trial = 0; trial < kTrials; ++trial) {
      Eigen::VectorXd off(minimum.size());
      for (double& entry : off) entry = random.normal();
      const ProjectionResult start =
          project_onto_constraints(formulation, minimum + 0.1 * off.normalized(), false, 15);
      const MeasureSolution rough = measure.minimize_roughly(*optimizer, solve, start.x);
      const ProjectionResult exact = project_onto_constraints(formulation, rough.x, false, 8);
      if (exact.violation <= kFeasibilityTolerance && measure.value(exact.x) < 1.02 * least) {
        ++returned;
      }
    }
    INFO("problem " << number);
    CHECK(returned >= kTrials * 3 / 4);
  }
}

}  // namespace stillbase
