// Rows and values beside many scenarios: posture and encounter are evaluated as far as rows need.
#include <catch2/catch.hpp>

#include <stillbase/formulation/formulation.hpp>

#include "support/capture_problems.hpp"

namespace stillbase {
namespace {

/// Problems in which one row alone needs more than the place of the hand.
std::vector<CaptureProblem> problems_of_one_row() {
  Random random(38);
  const CaptureProblem plain = tumbling_problem(random, random_robot(random, 7, false));
  std::vector<CaptureProblem> out(4, plain);
  out[0].constraints.coupling_singular_value_min = 0.1;
  out[1].constraints.jacobian_singular_value_min = 0.1;
  out[1].constraints.jacobian_length = 0.7;
  out[2].constraints.joint_rate_max = JointVectord::Constant(plain.robot.n(), 0.01);
  return out;  // the last one: the closing speed, which all of them have
}

}  // namespace

TEST_CASE("rows beside many scenarios, and violated ones alone, are those of the nominal point") {
  for (const CaptureProblem& problem : problems_of_one_row()) {
    const Formulation formulation(problem);
    const std::vector<Scenario> many(5, formulation.nominal_scenario());
    for (int i = 1; i <= 8; ++i) {
      const Eigen::VectorXd x =
          formulation.start_point(low_discrepancy_point(i, formulation.num_variables(), 9));
      nlp::Evaluation alone;
      formulation.evaluate(x, alone);
      ScenarioEvaluation beside;
      formulation.evaluate_scenarios(x, many, true, beside);
      CHECK(beside.constraints == alone.constraints);
      CHECK(beside.jacobian == alone.jacobian);

      Eigen::VectorXd violation;
      Eigen::MatrixXd jacobian;
      formulation.evaluate_violated(x, false, false, violation, jacobian);
      const Eigen::VectorXd lower = formulation.constraint_lower();
      const Eigen::VectorXd upper = formulation.constraint_upper();
      const Eigen::VectorXd all = nlp::signed_violation(alone.constraints, lower, upper);
      Eigen::Index next = 0;
      for (Eigen::Index row = 0; row < all.size(); ++row) {
        if (lower[row] != upper[row] && all[row] == 0) continue;
        REQUIRE(next < violation.size());
        CHECK(violation[next] == all[row]);
        CHECK(jacobian.row(next) == alone.jacobian.row(row));
        ++next;
      }
      CHECK(next == violation.size());
    }
  }
}

TEST_CASE("scenarios with errors of the joints have postures of their own") {
  const CaptureProblem problem = problems_of_one_row().back();
  const Formulation formulation(problem);
  std::vector<Scenario> scenarios(11, formulation.nominal_scenario());
  Random random(5);
  for (std::size_t k = 1; k < scenarios.size(); k += 2) {
    scenarios[k].joint_offset = Eigen::VectorXd::NullaryExpr(
        problem.robot.n(), [&](Eigen::Index) { return 0.1 * random.normal(); });
  }
  const Eigen::VectorXd x =
      formulation.start_point(low_discrepancy_point(3, formulation.num_variables(), 9));
  ScenarioEvaluation together, alone;
  formulation.evaluate_scenarios(x, scenarios, true, together);
  for (std::size_t k = 0; k < scenarios.size(); ++k) {
    const auto row = static_cast<Eigen::Index>(k);
    formulation.evaluate_scenarios(x, {scenarios[k]}, true, alone);
    CHECK(together.values[row] == Approx(alone.values[0]).epsilon(1e-10));
    CHECK((together.gradients.row(row) - alone.gradients.row(0)).norm() <=
          1e-10 * (1 + alone.gradients.norm()));
  }
}

}  // namespace stillbase
