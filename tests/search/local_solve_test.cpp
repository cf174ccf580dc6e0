// One evaluation and one local solve of the nominal problem.
#include <catch2/catch.hpp>

#include <stillbase/io/problem_file.hpp>
#include <stillbase/nlp/optimizer.hpp>

#include "formulation/projection.hpp"
#include "support/capture_problems.hpp"

namespace stillbase {

TEST_CASE("the nominal encounter is evaluated like one scenario of several") {
  Random random(38);
  const CaptureProblem problem = tumbling_problem(random, random_robot(random, 7, false));
  const Formulation formulation(problem);
  const Eigen::VectorXd x =
      formulation.start_point(low_discrepancy_point(3, formulation.num_variables(), 9));
  nlp::Evaluation alone;
  formulation.evaluate(x, alone);
  ScenarioEvaluation given;
  formulation.evaluate_scenarios(x, {formulation.nominal_scenario()}, true, given);
  CHECK(alone.objective == given.values[0]);
  CHECK(alone.gradient.transpose() == given.gradients.row(0));
  CHECK(alone.constraints == given.constraints);
  CHECK(alone.jacobian == given.jacobian);
}

TEST_CASE("the local solver ends at a minimum from every start, also from one that is too steep") {
  CaptureProblem problem =
      read_problem(std::string(STILLBASE_SOURCE_DIR) + "/problems/iiwa_cone.yaml");
  const Formulation formulation(problem);
  const auto solver = nlp::make_optimizer("nlopt-slsqp");
  int starts = 0, again = 0;
  for (int draw = 0; draw < 256; ++draw) {
    const ProjectionResult start = project_onto_constraints(
        formulation,
        formulation.start_point(low_discrepancy_point(draw, formulation.num_variables(), 1)), false,
        15);
    if (start.violation > 1e-3) continue;
    ++starts;
    const nlp::OptimizeResult found = solver->minimize(formulation, start.x);
    INFO("draw " << draw << ", " << found.evaluations << " evaluations");
    CHECK(found.status == nlp::Status::Optimal);
    CHECK(found.evaluations <= 150);
    again += found.message.find("started again") != std::string::npos ? 1 : 0;
  }
  CHECK(starts > 40);
  CHECK(again >= 1);
}

TEST_CASE("a solve that ends at a violated point is made again with a short first step") {
  const CaptureProblem problem =
      read_problem(std::string(STILLBASE_SOURCE_DIR) + "/problems/deos_latch.yaml");
  const Formulation formulation(problem);
  const auto solver = nlp::make_optimizer("nlopt-slsqp");
  int starts = 0, again = 0;
  for (int draw = 0; draw < 64; ++draw) {
    const ProjectionResult start = project_onto_constraints(
        formulation,
        formulation.start_point(low_discrepancy_point(draw, formulation.num_variables(), 3)), false,
        15);
    if (start.violation > 1e-9) continue;
    ++starts;
    const nlp::OptimizeResult found = solver->minimize(formulation, start.x);
    INFO("draw " << draw << ", " << found.evaluations << " evaluations");
    CHECK(found.feasible);
    CHECK(found.certificate.kkt_residual < 0.01);
    again += found.message.find("started again") != std::string::npos ? 1 : 0;
  }
  CHECK(starts > 10);
  CHECK(again >= 1);
}

}  // namespace stillbase
