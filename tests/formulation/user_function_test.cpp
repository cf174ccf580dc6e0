#include <algorithm>
#include <limits>

#include <catch2/catch.hpp>

#include <stillbase/formulation/measures/robust.hpp>
#include <stillbase/search/search.hpp>

#include "support/capture_problems.hpp"

namespace stillbase {

TEST_CASE("a quantity from outside the library can be made small") {
  Random random(71);
  CaptureProblem problem = point_mass_problem(random_planar_robot(random, 3), {0.6, 0.8, 0});
  problem.objective = {{ObjectiveQuantity::TotalAngularMomentum, 1e6}};  // as good as nothing
  const UserTerm base_speed{"base_speed", "m/s", 0.5,
                            [](const Configuration&, const ImpactSummary& impact) {
                              return impact.Delta_Omega.head<3>().norm();
                            }};
  problem.user.terms = {base_speed};
  const Formulation formulation(problem);
  CHECK_FALSE(formulation.has_hessian());

  const Eigen::VectorXd x =
      formulation.start_point(low_discrepancy_point(3, formulation.num_variables(), 1));
  nlp::Evaluation at_x, a, b;
  formulation.evaluate(x, at_x);
  for (int i = 0; i < x.size(); ++i) {
    const double h = 1e-4;
    const Eigen::VectorXd step = h * Eigen::VectorXd::Unit(x.size(), i);
    formulation.evaluate_value(x + step, a);
    formulation.evaluate_value(x - step, b);
    CHECK(at_x.gradient[i] ==
          Approx((a.objective - b.objective) / (2 * h)).epsilon(0).margin(1e-6));
  }

  SearchOptions options;
  options.starts = 12;
  const SearchResult found = search(problem, formulation, options);
  REQUIRE_FALSE(found.candidates.empty());
  // No posture of a grid moves the base less.
  const double best = found.candidates.front().objective;
  for (int i = 0; i < 400; ++i) {
    Configuration at = formulation.configuration(
        formulation.start_point(low_discrepancy_point(i, formulation.num_variables(), 5)));
    CHECK(nominal_value(problem, formulation, at) >= best * (1 - 1e-6));
  }
}

TEST_CASE("a constraint from outside the library is kept, listed and differentiated") {
  Random random(72);
  CaptureProblem problem = point_mass_problem(random_planar_robot(random, 4), {0.6, 0.8, 0});
  const auto speed = [](const Configuration&, const ImpactSummary& impact) {
    return impact.Delta_Omega.head<3>().squaredNorm();
  };
  SearchOptions options;
  options.starts = 12;
  const SearchResult without = search(problem, Formulation(problem), options);
  REQUIRE_FALSE(without.points.empty());
  const auto speed_of = [&](const SearchResult& found) {
    const Configuration& at = found.candidates.front().configuration;
    return speed(at, impact_at(problem, at));
  };
  const double limit = 0.8 * speed_of(without);
  problem.user.constraints = {{"base_speed_squared", "m^2/s^2", 0, limit, speed}};
  const Formulation formulation(problem);
  CHECK_FALSE(formulation.has_hessian());

  const Eigen::VectorXd x =
      formulation.start_point(low_discrepancy_point(3, formulation.num_variables(), 1));
  nlp::Evaluation at_x, a, b;
  formulation.evaluate(x, at_x);
  const Eigen::Index row = at_x.constraints.size() - 1;
  for (int i = 0; i < x.size(); ++i) {
    const Eigen::VectorXd step = 1e-4 * Eigen::VectorXd::Unit(x.size(), i);
    formulation.evaluate_value(x + step, a);
    formulation.evaluate_value(x - step, b);
    CHECK(at_x.jacobian(row, i) ==
          Approx((a.constraints[row] - b.constraints[row]) / 2e-4).epsilon(0).margin(1e-7));
  }

  const SearchResult found = search(problem, formulation, options);
  REQUIRE_FALSE(found.points.empty());
  CHECK(speed_of(found) <= limit + 1e-9);
  const std::vector<ConstraintValue> listed = formulation.report(found.points.front());
  CHECK(std::count_if(listed.begin(), listed.end(), [&](const ConstraintValue& value) {
          return value.name == "base_speed_squared" && value.upper == limit;
        }) == 1);
}

TEST_CASE("a function from outside is kept away from where it is not defined") {
  Random random(74);
  CaptureProblem problem = point_mass_problem(random_planar_robot(random, 4), {0.6, 0.8, 0});
  SearchOptions options;
  options.starts = 12;
  const auto half = [](const Configuration& at, const ImpactSummary&) {
    return at.phi[0] > 0 ? std::numeric_limits<double>::quiet_NaN() : 1.0;
  };
  const auto nowhere = [](const Configuration&, const ImpactSummary&) {
    return std::numeric_limits<double>::quiet_NaN();
  };
  const auto found = [&] { return search(problem, Formulation(problem), options); };
  SECTION("a constraint") {
    problem.user.constraints = {{"half", "1", 0, 2, half}};
    const SearchResult result = found();
    REQUIRE(result.status == PlanStatus::Feasible);
    for (const Candidate& candidate : result.candidates) {
      CHECK(candidate.configuration.phi[0] <= 0);
    }
    problem.user.constraints = {{"nowhere", "1", -kInfinity, 2, nowhere}};
    CHECK_THROWS_WITH(found(), Catch::Contains("no finite value at any start of nowhere"));
  }
  SECTION("a term of the objective") {
    problem.user.terms = {{"half", "1", 1, half}};
    const SearchResult result = found();
    REQUIRE(result.status == PlanStatus::Feasible);
    for (const Candidate& candidate : result.candidates) {
      CHECK(candidate.configuration.phi[0] <= 0);
    }
    problem.user.terms = {{"nowhere", "1", 1, nowhere}};
    CHECK_THROWS_WITH(found(), Catch::Contains("no finite value at any start of the objective"));
  }
}

TEST_CASE("a gradient of the user's own takes the place of differences") {
  Random random(73);
  CaptureProblem problem = point_mass_problem(random_planar_robot(random, 4), {0.6, 0.8, 0});
  int calls = 0;
  const auto bend = [&calls](const Configuration& at, const ImpactSummary&) {
    ++calls;
    return at.phi.squaredNorm();
  };
  const auto gradient = [](const Configuration& at, const ImpactSummary&) {
    return Eigen::VectorXd(2 * at.phi);
  };
  problem.user.terms = {{"bend", "rad^2", 0.3, bend}};
  problem.user.constraints = {{"bent", "rad^2", 0, 4, bend}};
  const auto evaluate = [&problem, &calls](nlp::Evaluation& out) {
    const Formulation formulation(problem);
    REQUIRE(formulation.num_variables() == problem.robot.n());
    calls = 0;
    formulation.evaluate(formulation.start_point(low_discrepancy_point(3, 4, 1)), out);
  };
  nlp::Evaluation by_differences, by_gradient;
  evaluate(by_differences);
  problem.user.terms[0].gradient = gradient;
  problem.user.constraints[0].gradient = gradient;
  CHECK(calls >= 16);  // two for each of four joints, of term and constraint
  evaluate(by_gradient);
  CHECK(calls <= 2);
  CHECK((by_gradient.gradient - by_differences.gradient).norm() <=
        1e-7 * by_differences.gradient.norm());
  CHECK((by_gradient.jacobian - by_differences.jacobian).norm() <=
        1e-7 * by_differences.jacobian.norm());

  problem.user.terms[0].gradient = [](const Configuration&, const ImpactSummary&) {
    return Eigen::VectorXd(Eigen::VectorXd::Zero(3));
  };
  CHECK_THROWS_WITH(evaluate(by_gradient),
                    "gradient of bend: has 3 components, the search has 4 variables");
}

}  // namespace stillbase
