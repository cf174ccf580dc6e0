#include <catch2/catch.hpp>

#include <stillbase/formulation/measures/robust.hpp>

#include "formulation/measures/measure.hpp"
#include "support/capture_problems.hpp"
#include "verification/objective.hpp"

namespace stillbase {

TEST_CASE("planner and reference agree on every term and on every measure over samples") {
  Random random(81);
  for (int trial = 0; trial < 6; ++trial) {
    CaptureProblem problem = tumbling_problem(random, random_robot(random, 6, trial % 2 == 0));
    problem.variables.base_position = PositionFreedom::Free;
    problem.objective = {{ObjectiveQuantity::BaseAngularMomentum, 0.7},
                         {ObjectiveQuantity::BaseAngularVelocity, 0.3},
                         {ObjectiveQuantity::TotalAngularMomentum, 2},
                         {ObjectiveQuantity::BaseMomentum, 3, 0.5},
                         {ObjectiveQuantity::ImpulseMagnitude, 5},
                         {ObjectiveQuantity::JointRateNorm, 0.2}};
    if (trial == 4) {
      problem.impulse.source = ImpulseSource::PointMass;
      problem.impulse.direction = random.unit_vector();
      problem.impulse.direction_frame = Frame::Inertial;
      problem.impulse.closing_speed = 0.2;
    }
    if (trial == 5) {
      problem.impulse.source = ImpulseSource::Given;
      problem.impulse.direction = random.unit_vector();
      problem.impulse.magnitude = 3;
      problem.impulse.moment = random.unit_vector();
    }
    problem.uncertainty = {.cone_half_angle = 0.3,
                           .cone_confidence = std::nullopt,
                           .cone_plane_normal = std::nullopt,
                           .closing_speed = 0.01,
                           .restitution = 0.1,
                           .target_mass = 0.2,
                           .target_inertia = 0.3,
                           .contact_point = 0.05,
                           .contact_time = 2,
                           .joint_position = {},
                           .residual_velocity = std::nullopt};
    if (trial % 2 == 1) {
      problem.uncertainty.joint_position = JointVectord::Constant(problem.robot.n(), 0.1);
    }
    problem.measure.samples = 20;
    problem.measure.cvar_level = 0.73;
    if (trial < 3) {
      problem.objective.push_back({ObjectiveQuantity::AttitudeTurned, 0.1});
      problem.objective.back().after = 0.3;
      problem.post_impact.controllers = {trial == 0 ? "rns_damped" : "joint_damping"};
    }
    const double tolerance =
        verification::objective_tolerance(problem, 1e-10);  // a simulation is less exact
    CHECK(tolerance == (trial < 3 ? 1e-5 : 1e-10));
    const Formulation formulation(problem);
    const Eigen::VectorXd x =
        formulation.start_point(low_discrepancy_point(trial, formulation.num_variables(), 3));
    const Configuration at = formulation.configuration(x);
    const auto response = verification::posture_response(problem, at.phi);
    const auto motion = verification::target_motion(
        problem, at, at.base * Vector3d(response.dynamics.hand_position), at.contact_time - 10);
    INFO("trial " << trial);
    for (const RiskMeasure kind : {RiskMeasure::Expectation, RiskMeasure::Cvar}) {
      problem.measure.kind = kind;
      const double stated = Measure(problem, formulation).reported(x);
      CHECK(stated > 0);
      CHECK(verification::sampled_measure(problem, motion ? &*motion : nullptr, at, response) ==
            Approx(stated).epsilon(tolerance));
    }
    const auto event = verification::contact_event(problem, motion ? &*motion : nullptr, at);
    const Vector6d Fbar = verification::impulse_along(problem, event, response, event.n);
    const auto terms = objective_terms(problem, formulation, at);
    for (const ObjectiveTerm& term : problem.objective) {
      INFO(to_string(term.quantity));
      CHECK(terms.at(to_string(term.quantity)) ==
            Approx(verification::term_value({problem, term, response, Fbar, nullptr}))
                .epsilon(tolerance));
    }
  }
}

}  // namespace stillbase
