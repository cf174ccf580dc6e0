#include <catch2/catch.hpp>

#include <stillbase/formulation/measures/robust.hpp>

#include "formulation/measures/measure.hpp"
#include "search/screening.hpp"
#include "support/capture_problems.hpp"

namespace stillbase {
namespace {

CaptureProblem uncertain_problem(Random& random) {
  CaptureProblem problem = tumbling_problem(random, random_robot(random, 6, false));
  problem.uncertainty.cone_half_angle = 0.2;
  problem.uncertainty.joint_position = JointVectord::Constant(6, 0.02);
  problem.measure.samples = 20;
  return problem;
}

std::vector<Eigen::VectorXd> some_points(const Formulation& formulation, int count) {
  std::vector<Eigen::VectorXd> out;
  for (int i = 0; i < count; ++i) {
    out.push_back(
        formulation.start_point(low_discrepancy_point(i, formulation.num_variables(), 7)));
  }
  return out;
}

}  // namespace

TEST_CASE("screening gives the measure itself where few samples make it") {
  Random random(81);
  CaptureProblem problem = uncertain_problem(random);
  for (const RiskMeasure kind : {RiskMeasure::Expectation, RiskMeasure::Cvar}) {
    problem.measure.kind = kind;
    const Formulation formulation(problem);
    Measure measure(problem, formulation);
    const auto points = some_points(formulation, 11);
    const Eigen::VectorXd values = screen(problem, formulation, points);
    for (std::size_t i = 0; i < points.size(); ++i) {
      CHECK(values[static_cast<Eigen::Index>(i)] ==
            Approx(measure.value(points[i])).epsilon(1e-11));
    }
  }
}

TEST_CASE("screening never judges a posture worse than its worst case over the cone") {
  Random random(82);
  CaptureProblem problem = uncertain_problem(random);
  problem.measure.kind = RiskMeasure::WorstCase;
  const Formulation formulation(problem);
  Measure measure(problem, formulation);
  const auto points = some_points(formulation, 40);
  const Eigen::VectorXd values = screen(problem, formulation, points);
  double closest = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double part = values[static_cast<Eigen::Index>(i)] / measure.value(points[i]);
    CHECK(part <= 1 + 1e-11);
    CHECK(part > 0.5);
    closest = std::max(closest, part);
  }
  CHECK(closest > 0.98);
}

TEST_CASE("the best of a screening are sorted and apart from each other") {
  Random random(83);
  CaptureProblem problem = uncertain_problem(random);
  problem.measure.kind = RiskMeasure::WorstCase;
  const Formulation formulation(problem);
  auto points = some_points(formulation, 30);
  points.push_back(points[3]);
  const auto best = best_by_screening(problem, formulation, points, 12);
  REQUIRE(best.size() == 12);
  const Eigen::VectorXd of_all = screen(problem, formulation, points);
  const Eigen::VectorXd of_best = screen(problem, formulation, best);
  CHECK(of_best[0] == of_all.minCoeff());
  for (Eigen::Index i = 1; i < of_best.size(); ++i) CHECK(of_best[i] >= of_best[i - 1]);
  for (std::size_t i = 0; i < best.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) CHECK(formulation.distance(best[i], best[j]) >= 0.1);
  }
  CHECK(best_by_screening(problem, formulation, points, 100).size() <= 30);
  CHECK(best_by_screening(problem, formulation, {}, 5).empty());
}

}  // namespace stillbase
