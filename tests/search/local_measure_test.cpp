// The local minimisation of the worst case over a cone.
#include <catch2/catch.hpp>

#include <stillbase/core/random.hpp>
#include <stillbase/nlp/optimizer.hpp>
#include <stillbase/search/search.hpp>

#include "formulation/measures/measure.hpp"
#include "formulation/projection.hpp"
#include "support/random_capture.hpp"
#include "support/shipped_problem.hpp"

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
    const auto optimizer = nlp::make_optimizer("sqp");
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

// Distances and a free contact time: descents come back onto the constraints to 1e-8 seldom.
TEST_CASE("rough solves lower the worst case from nearly every start") {
  const CaptureProblem problem = test::shipped("deos_client_224");
  const Formulation formulation(problem);
  Measure measure(problem, formulation);
  nlp::OptimizeOptions solve;
  solve.feasibility_tolerance = kFeasibilityTolerance;
  const auto optimizer = nlp::make_optimizer("sqp");
  int starts = 0, halved = 0;
  for (int i = 0; i < 100; ++i) {
    const Eigen::VectorXd u = low_discrepancy_point(i, formulation.num_variables(), 1);
    const ProjectionResult start =
        project_onto_constraints(formulation, formulation.start_point(u), false, 15);
    if (!(start.violation <= 1e-6)) continue;
    ++starts;
    const RoughSolution rough = measure.minimize_roughly(*optimizer, solve, start.x);
    const ProjectionResult end = project_onto_constraints(formulation, rough.x, false, 8);
    CHECK(end.violation <= kFeasibilityTolerance);
    // Of squares: the worst case itself falls to seven tenths.
    if (measure.value(end.x) < 0.5 * measure.value(start.x)) ++halved;
  }
  INFO(halved << " of " << starts);
  CHECK(starts >= 20);
  CHECK(halved >= starts * 9 / 10);
}

}  // namespace stillbase
