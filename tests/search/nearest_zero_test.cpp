// Zeros nearest to the start posture, judged by steps along the surface of zeros.
#include <catch2/catch.hpp>

#include <stillbase/core/random.hpp>
#include <stillbase/nlp/optimizer.hpp>

#include "formulation/projection.hpp"
#include "search/nearest_zero.hpp"
#include "search/zero_watch.hpp"
#include "support/shipped_problem.hpp"

namespace stillbase {
namespace {

nlp::OptimizeOptions solve() {
  nlp::OptimizeOptions out;
  out.max_evaluations = 1000;
  return out;
}

/// Half the squared distance from the start posture, joints alone.
double way(const CaptureProblem& problem, const Formulation& formulation,
           const Eigen::VectorXd& x) {
  return (formulation.configuration(x).phi - problem.start).squaredNorm() / 2;
}

}  // namespace

TEST_CASE("no zero next to the nearest one is nearer to the start posture") {
  const CaptureProblem problem = test::without_path("matched_light");
  const Formulation formulation(problem);
  const auto optimizer = nlp::make_optimizer("nlopt-slsqp");
  int moved = 0, minima = 0;
  for (int i = 0; i < 48; ++i) {
    const Eigen::VectorXd start =
        formulation.start_point(low_discrepancy_point(i, formulation.num_variables(), 7));
    const Eigen::VectorXd end =
        minimize_to_zero(*optimizer, formulation,
                         project_onto_constraints(formulation, start, false, 15).x, solve());
    const ProjectionResult zero = project_onto_constraints(formulation, end, true, 20);
    if (!(zero.violation <= 1e-9)) continue;
    const auto x = nearest_zero(problem, formulation, zero.x, *optimizer, solve());
    REQUIRE(x);
    const Eigen::MatrixXd open = open_directions(formulation, *x, true);
    if (!(project_onto_constraints(formulation, *x, true, 0).violation <= 1e-9)) continue;
    ++moved;
    const double least = way(problem, formulation, *x);
    CAPTURE(i, least);
    CHECK(least <= way(problem, formulation, zero.x) + 1e-9);
    CHECK(open.cols() >= 1);
    bool is_least = true;
    for (Eigen::Index k = 0; k < open.cols(); ++k) {
      for (const double step : {-1e-3, 1e-3}) {
        const ProjectionResult beside =
            project_onto_constraints(formulation, *x + step * open.col(k), true, 20);
        // The base's rotation and the time count for a thousandth.
        if (beside.violation <= 1e-12 && way(problem, formulation, beside.x) < least - 1e-5)
          is_least = false;
      }
    }
    if (is_least) ++minima;
  }
  CAPTURE(moved);
  CHECK(minima >= 5);
  CHECK(3 * minima >= 2 * moved);  // along a strongly bent surface the solver creeps
}

TEST_CASE("a zero that is alone is left as it is") {
  const CaptureProblem problem = test::without_path("planar_two_link_c2_a");
  const Formulation formulation(problem);
  const auto optimizer = nlp::make_optimizer("nlopt-slsqp");
  const Eigen::VectorXd u = Eigen::VectorXd::Constant(formulation.num_variables(), 0.3);
  const ProjectionResult zero =
      project_onto_constraints(formulation, formulation.start_point(u), true, 60);
  CHECK_FALSE(nearest_zero(problem, formulation, zero.x, *optimizer, solve()));
}

}  // namespace stillbase
