// A formulation that takes another estimate of its target.
#include <catch2/catch.hpp>

#include <stillbase/formulation/measures/robust.hpp>

#include "support/capture_problems.hpp"

namespace stillbase {

TEST_CASE(
    "a formulation with a new estimate is the formulation of the problem with that estimate") {
  Random random(51);
  for (int trial = 0; trial < 6; ++trial) {
    CaptureProblem problem = tumbling_problem(random, random_robot(random, 7, trial % 2 == 0));
    problem.uncertainty.cone_half_angle = 0.1;
    Formulation updated(problem);
    updated.reserve_motion(100);
    for (int estimate = 0; estimate < 2; ++estimate) {
      problem.target_state.time += 0.5;
      problem.target_state.pose.position += 0.1 * random.unit_vector();
      problem.target_state.pose.orientation =
          (problem.target_state.pose.orientation * rotation_exp(0.2 * random.unit_vector()));
      problem.target_state.pose.orientation.normalize();
      problem.target_state.angular_velocity += 0.01 * random.unit_vector();
      problem.uncertainty.cone_half_angle += 0.05;
      updated.set_target_state(problem.target_state);
      updated.set_cone_half_angle(problem.uncertainty.cone_half_angle);
      const Formulation fresh(problem);
      const Eigen::VectorXd x =
          fresh.start_point(low_discrepancy_point(trial, fresh.num_variables(), 3));
      nlp::Evaluation a, b;
      updated.evaluate(x, a);
      fresh.evaluate(x, b);
      REQUIRE(a.constraints.size() == b.constraints.size());
      CHECK((a.constraints - b.constraints).lpNorm<Eigen::Infinity>() < 1e-12);
      CHECK((a.jacobian - b.jacobian).lpNorm<Eigen::Infinity>() < 1e-11);
      // The units are those of each formulation's own sample.
      const double units = std::pow(updated.objective_unit() / fresh.objective_unit(), 2);
      CHECK(a.objective * units == Approx(b.objective).epsilon(1e-10));
      CHECK((a.gradient * units - b.gradient).norm() <= 1e-9 * (1 + b.gradient.norm()));
      const Configuration at = updated.configuration(x), there = fresh.configuration(x);
      CHECK((at.base.position - there.base.position).norm() < 1e-12);
      CHECK(worst_case(problem, updated, at).value ==
            Approx(worst_case(problem, fresh, there).value).epsilon(1e-10));
    }
  }
}

}  // namespace stillbase
