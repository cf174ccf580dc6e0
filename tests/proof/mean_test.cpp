#include <catch2/catch.hpp>

#include <algorithm>

#include <stillbase/core/random.hpp>
#include <stillbase/plan/scenario.hpp>

#include "minimum_values.hpp"
#include "proof/response_gram.hpp"

namespace stillbase {
namespace {

using proof::Bound;
using proof::bound_minimum;
using proof::MinimumProblem;

/// Downhill by random steps, within limits.
double descended(const MinimumProblem& problem, Eigen::VectorXd at, const Eigen::VectorXd& lower,
                 const Eigen::VectorXd& upper) {
  Random random(5);
  double least = value_at(problem, at), step = 0.05;
  for (int i = 0; i < 1500 && step > 1e-8; ++i) {
    Eigen::VectorXd next = at;
    for (double& entry : next) entry += step * random.uniform(-1, 1);
    next = next.cwiseMax(lower).cwiseMin(upper);
    const double value = value_at(problem, next);
    step *= value < least ? 1.6 : 0.93;
    if (!(value < least)) continue;
    least = value;
    at = next;
  }
  return least;
}

}  // namespace

TEST_CASE("means over samples: no bound is above the least one, and all are near it") {
  // Three free joints within limits, two within none, and a spatial arm with moments and inertia.
  const int kind = GENERATE(0, 1, 2);
  CaptureProblem problem =
      test::shipped(kind == 1 ? "planar_two_link_c2_a" : "planar_three_link_null");
  if (kind == 2) {
    problem = test::shipped("spart_3dof_point");
    problem.variables.base_attitude = AttitudeFreedom::Fixed;
    problem.variables.base_position = PositionFreedom::Fixed;
  }
  problem.hand.constraint = HandConstraint::None;
  problem.constraints = {};
  problem.measure.kind = GENERATE(RiskMeasure::Expectation, RiskMeasure::Cvar);
  problem.measure.cvar_level = 0.7;  // not a whole number of samples
  problem.measure.samples = 16;
  problem.uncertainty.cone_half_angle = 0.3;
  problem.uncertainty.restitution = 0.1;
  problem.uncertainty.target_mass = 0.3;
  problem.uncertainty.contact_point = 0.05;
  problem.objective = {{ObjectiveQuantity::BaseAngularMomentum, 1e-3},
                       {ObjectiveQuantity::JointRateNorm, 0.1},
                       {ObjectiveQuantity::ImpulseMagnitude, 0.01}};
  MinimumProblem minimum = proof::minimum_problem(problem, draw_scenarios(problem));
  proof::VariableEncounter& encounter = minimum.where.encounter;
  const int n = encounter.num_variables();
  REQUIRE(encounter.is_fixed());
  REQUIRE(n == (kind == 1 ? 2 : 3));
  Eigen::VectorXd lower = encounter.start, upper = encounter.start;
  for (int i = 0; i < n; ++i) {
    proof::Variable& variable = encounter.variables[static_cast<std::size_t>(i)];
    if (kind != 1)
      variable = {proof::VariableKind::Joint, 0.4 + 0.3 * i, 0.9 + 0.3 * i, false, variable.joint};
    lower[variable.joint] = kind == 1 ? -M_PI : variable.lower;
    upper[variable.joint] = kind == 1 ? M_PI : variable.upper;
  }
  std::vector<std::pair<double, Eigen::VectorXd>> grid;
  for (int i = 0; i < 4000; ++i) {
    const Eigen::VectorXd u = low_discrepancy_point(i, static_cast<int>(lower.size()), 2);
    const Eigen::VectorXd phi = lower + u.cwiseProduct(upper - lower);
    grid.emplace_back(value_at(minimum, phi), phi);
  }
  std::sort(grid.begin(), grid.end(),
            [](const auto& a, const auto& b) { return a.first < b.first; });
  double least = grid.front().first;
  for (int i = 0; i < 4; ++i) {
    least = std::min(least, descended(minimum, grid[i].second, lower, upper));
  }
  // Told a larger best value it has to stop below the least one by itself.
  const Bound loose = bound_minimum(minimum, 1.2 * least, {.max_boxes = 3000});
  CAPTURE(kind, least, loose.lower, loose.boxes);
  CHECK_FALSE(loose.nothing_below_cut);
  CHECK(loose.lower <= least);
  const Bound found = bound_minimum(minimum, least, {.relative_gap = 2e-3});
  CAPTURE(found.lower, found.boxes);
  CHECK_FALSE(found.limit_reached);
  CHECK_FALSE(found.nothing_below_cut);
  CHECK(found.lower <= least);
  CHECK(found.lower >= least * (1 - 2e-3));
}

TEST_CASE("products of an impulse's coefficients give its wrench, rounding enclosed") {
  CaptureProblem problem = test::shipped("spart_3dof_point");
  problem.measure.kind = RiskMeasure::Expectation;
  problem.uncertainty.cone_half_angle = 0.4;
  problem.uncertainty.contact_point = 0.1;
  const MinimumProblem minimum = proof::minimum_problem(problem, draw_scenarios(problem));
  const proof::RoundUpward upward;
  const proof::WrenchBasis basis(minimum.impulses);
  REQUIRE(basis.wrenches.size() == 6);
  for (std::size_t k = 0; k < minimum.impulses.size(); ++k) {
    const Vector6d& F = minimum.impulses[k].F;
    for (int a = 0; a < 6; ++a) {
      for (int b = 0; b < 6; ++b) {
        proof::Interval sum(0.0);
        std::size_t pair = 0;
        for (std::size_t i = 0; i < 6; ++i) {
          for (std::size_t j = i; j < 6; ++j) {
            const Vector6d &w = basis.wrenches[i], &v = basis.wrenches[j];
            const proof::Interval both =
                proof::Interval(w[a]) * v[b] + proof::Interval(w[b]) * v[a];
            sum += basis.weights[k][pair++] * both / 2.0;
          }
        }
        CHECK_FALSE(proof::is_disjoint(sum, proof::Interval(F[a]) * F[b]));
        CHECK(proof::width_of(sum) < 1e-13);
      }
    }
  }
}

}  // namespace stillbase
