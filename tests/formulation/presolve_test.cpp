// Which constraints the optimizers get, and that threads may share a formulation.
#include <algorithm>
#include <thread>

#include <catch2/catch.hpp>

#include "formulation/formulation_parts.hpp"
#include "support/capture_problems.hpp"

namespace stillbase {

TEST_CASE("presolve names every row that the optimizers do not get, and why") {
  Random random(81);
  CaptureProblem problem = point_mass_problem(random_planar_robot(random, 3), {0.6, 0.8, 0});
  problem.constraints.impact_case = CaseConstraint::C1;
  const Formulation formulation(problem);
  const SelectedRows& rows = formulation.parts().rows;
  const std::size_t all = formulation.parts().constraints.rows.size();
  // In a plane, angular momentum has one component.
  CHECK(formulation.num_equations() == 1);
  CHECK(rows.kept.size() + rows.redundant.size() == all);
  REQUIRE(rows.redundant.size() == 1);
  const std::string text = to_string(formulation.redundant_rows());
  CHECK_THAT(text, Catch::Contains("case_total_") && Catch::Contains("\n"));
}

TEST_CASE("threads share one formulation and find what one thread finds") {
  Random random(82);
  CaptureProblem problem = tumbling_problem(random, random_robot(random, 5, false));
  problem.variables.base_position = PositionFreedom::Free;
  const Formulation formulation(problem);
  constexpr int kPoints = 64;
  const auto evaluate = [&](int index, nlp::Evaluation& out) {
    formulation.evaluate(
        formulation.start_point(low_discrepancy_point(index, formulation.num_variables(), 7)), out);
  };
  std::vector<nlp::Evaluation> expected(kPoints), found(kPoints);
  for (int i = 0; i < kPoints; ++i) evaluate(i, expected[static_cast<std::size_t>(i)]);
  const long before = formulation.evaluations();
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([&, t] {
      for (int i = t; i < kPoints; i += 4) evaluate(i, found[static_cast<std::size_t>(i)]);
    });
  }
  for (std::thread& thread : threads) thread.join();
  CHECK(formulation.evaluations() == before + kPoints);
  for (std::size_t i = 0; i < found.size(); ++i) {
    CHECK(found[i].objective == expected[i].objective);
    CHECK(found[i].gradient == expected[i].gradient);
    CHECK(found[i].constraints == expected[i].constraints);
    CHECK(found[i].jacobian == expected[i].jacobian);
  }
}

}  // namespace stillbase
