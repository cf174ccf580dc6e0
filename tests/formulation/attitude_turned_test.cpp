#include "formulation/objectives/attitude_turned.hpp"

#include <catch2/catch.hpp>

#include <stillbase/core/error.hpp>
#include <stillbase/formulation/measures/robust.hpp>
#include <stillbase/search/trade_off.hpp>
#include <stillbase/simulation/simulate.hpp>

#include "formulation/measures/scenario_program.hpp"
#include "formulation/projection.hpp"
#include "formulation/some_point.hpp"
#include "support/capture_problems.hpp"
#include "support/shipped_problem.hpp"

namespace stillbase {
namespace {

constexpr std::uint64_t kSequence = 11;  // of some_point()

/// A random arm captures a tumbling box; the rotation within half a second is minimised.
CaptureProblem turning_problem(Random& random, int joints, const std::string& controller) {
  CaptureProblem problem = tumbling_problem(random, random_robot(random, joints, false));
  problem.variables.base_position = PositionFreedom::Free;
  problem.objective = {{ObjectiveQuantity::AttitudeTurned}};
  problem.objective[0].after = 0.5;
  problem.post_impact.controllers = {controller};
  return problem;
}

/// The paper's arm of two links, both joints free.
CaptureProblem planar_problem() {
  CaptureProblem problem = test::shipped("planar_two_link_c2_a");
  problem.constraints.impact_case = CaseConstraint::None;
  problem.objective = {{ObjectiveQuantity::AttitudeTurned}};
  problem.objective[0].after = 0.5;
  problem.post_impact.controllers = {"joint_damping"};
  problem.uncertainty.cone_half_angle = 0;
  return problem;
}

}  // namespace

TEST_CASE("the attitude change in an objective is that of another integrator from the same jump") {
  Random random(301);
  for (const char* controller : {"none", "joint_damping", "rns_damped"}) {
    const CaptureProblem problem = turning_problem(random, 5, controller);
    const Formulation formulation(problem);
    SimulationOptions options = plant_options_of(problem.post_impact, problem.robot);
    options.integrator = IntegratorKind::Fehlberg78;
    options.relative_tolerance = 1e-12;
    options.absolute_tolerance = 1e-14;
    options.horizon = 0.5;
    for (int i = 0; i < 4; ++i) {
      const Configuration at = formulation.configuration(some_point(formulation, i, kSequence));
      const EncounterModel& model = formulation.encounter_model();
      const Encounter<double> encounter = encounter_at(model, at);
      const auto posture = evaluate_posture<double>(
          problem.robot, prepare_resistance(problem.resistance, problem.robot.n()), at.phi);
      const auto response = respond<double>(posture, encounter.F);
      const double p = impulse_magnitude(model, encounter, response.hand_inverse_mass);
      const PlantState after = state_after_impact(problem.robot, problem.resistance,
                                                  state_at_rest(at.base, at.phi), p * encounter.F);
      const SimulationResult run =
          simulate_post_impact(problem.robot, problem.resistance, after,
                               chosen_controller(problem.post_impact).value(), options);
      REQUIRE(run.status == SimulationStatus::Finished);
      const double turned = nominal_value(problem, formulation, at);
      INFO(controller << " " << i << ": " << turned);
      CHECK(turned > 1e-6);
      CHECK(turned == Approx(run.summary.attitude_turned_end).epsilon(1e-7));
      nlp::Evaluation here;
      formulation.evaluate_value(formulation.variables(at), here);
      CHECK(formulation.objective_unit() * std::sqrt(2 * here.objective) ==
            Approx(turned).epsilon(1e-9));
      CHECK(objective_terms(problem, formulation, at).at("attitude_turned") == turned);
    }
  }
}

TEST_CASE("the gradient of a simulated objective is that of Richardson's differences") {
  Random random(302);
  for (const char* controller : {"joint_damping", "rns_damped"}) {
    CaptureProblem problem = turning_problem(random, 4, controller);
    problem.objective.push_back({ObjectiveQuantity::JointRateNorm, 0.2});
    const Formulation formulation(problem);
    CHECK_FALSE(formulation.has_hessian());
    for (int i = 0; i < 3; ++i) {
      const Eigen::VectorXd x = some_point(formulation, 3 * i + 1, kSequence);
      nlp::Evaluation at_x, a, b;
      formulation.evaluate(x, at_x);
      Eigen::VectorXd y;
      Eigen::MatrixXd J;
      formulation.objective_vector(x, y, J);
      CHECK(y.squaredNorm() / 2 == Approx(at_x.objective).epsilon(1e-12));
      CHECK((J.transpose() * y - at_x.gradient).norm() < 1e-9 * at_x.gradient.norm());
      for (int k = 0; k < x.size(); ++k) {
        const auto slope = [&](double h) {
          formulation.evaluate_value(x + h * Eigen::VectorXd::Unit(x.size(), k), a);
          formulation.evaluate_value(x - h * Eigen::VectorXd::Unit(x.size(), k), b);
          return (a.objective - b.objective) / (2 * h);
        };
        const double wanted = (4 * slope(1e-3) - slope(2e-3)) / 3;
        INFO(controller << " point " << i << " variable " << k);
        CHECK(at_x.gradient[k] == Approx(wanted).epsilon(1e-6).margin(1e-7 * at_x.gradient.norm()));
      }
    }
  }
}

TEST_CASE("scenarios one by one, in a list and of many points have the same simulated values") {
  Random random(303);
  CaptureProblem problem = turning_problem(random, 4, "joint_damping");
  problem.objective.push_back({ObjectiveQuantity::BaseAngularMomentum, 0.5});
  problem.uncertainty.restitution = 0.1;
  problem.uncertainty.target_mass = 0.3;
  problem.uncertainty.contact_point = 0.05;
  problem.uncertainty.joint_position = JointVectord::Constant(4, 0.05);
  problem.measure.samples = 6;
  const std::vector<Scenario> scenarios = draw_scenarios(problem);
  const Formulation formulation(problem);
  const Eigen::VectorXd x = some_point(formulation, 5, kSequence);
  ScenarioEvaluation all, one;
  formulation.evaluate_scenarios(x, scenarios, true, all);
  const Eigen::MatrixXd values = formulation.evaluate_points({x}, scenarios);
  double least = kInfinity, most = 0;
  for (std::size_t k = 0; k < scenarios.size(); ++k) {
    const auto row = static_cast<Eigen::Index>(k);
    formulation.evaluate_scenarios(x, {scenarios[k]}, false, one);
    CHECK(all.values[row] == one.values[0]);
    CHECK(values(0, row) == Approx(one.values[0]).epsilon(1e-10));
    least = std::min(least, one.values[0]);
    most = std::max(most, one.values[0]);
  }
  CHECK(most > 1.05 * least);
  // Their programs have no second derivatives of what is simulated.
  CHECK_FALSE(ScenarioProgram(formulation, scenarios, std::nullopt, 1).has_hessian());
  CHECK_FALSE(ScenarioProgram(formulation, scenarios, 1).has_hessian());
}

TEST_CASE("the worst case over a cone counts what is simulated") {
  CaptureProblem problem = planar_problem();
  problem.uncertainty.cone_half_angle = 0.1;
  const Formulation formulation(problem);
  for (int i = 0; i < 3; ++i) {
    const Eigen::VectorXd x = some_point(formulation, i, kSequence);
    const Configuration at = formulation.configuration(x);
    const double nominal = nominal_value(problem, formulation, at);
    const double worst = worst_case(problem, formulation, at).value;
    CHECK(worst > nominal * (1 + 1e-3));
    double largest = 0;
    for (int k = -10; k <= 10; ++k) {
      Scenario scenario = formulation.nominal_scenario();
      scenario.direction = rotation_exp(0.01 * k * Vector3d::UnitZ()) * scenario.direction;
      ScenarioEvaluation here;
      formulation.evaluate_scenarios(x, {scenario}, false, here);
      const double value = formulation.objective_unit() * std::sqrt(2 * here.values[0]);
      if (k == 0) CHECK(value == Approx(nominal).epsilon(1e-9));
      largest = std::max(largest, value);
    }
    CHECK(worst >= largest * (1 - 1e-9));
    CHECK(worst <= largest * 1.05);
  }
}

TEST_CASE("a joint at its bound has a gradient from the inside") {
  CaptureProblem problem = planar_problem();
  for (Joint& joint : problem.robot.joints) {
    joint.type = JointType::Revolute;
    joint.lower = -1.5;
    joint.upper = 1.5;
  }
  problem.start = JointVectord::Zero(2);
  const Formulation formulation(problem);
  for (const double side : {-1.5, 1.5}) {
    const Eigen::Vector2d x(0.4, side);
    nlp::Evaluation at_x, inside;
    formulation.evaluate(x, at_x);
    const double h = 1e-4;
    formulation.evaluate_value(x - Eigen::Vector2d(0, std::copysign(h, side)), inside);
    const double slope = (at_x.objective - inside.objective) / std::copysign(h, side);
    INFO("at " << side << ": " << slope);
    CHECK(at_x.gradient[1] == Approx(slope).epsilon(0.02).margin(1e-4));
  }
}

TEST_CASE("an objective that takes a simulation is refused without controller or time") {
  CaptureProblem problem = planar_problem();
  CHECK_NOTHROW(Formulation(problem));
  CaptureProblem without = problem;
  without.post_impact.controllers.clear();
  CHECK_THROWS_AS(Formulation(without), InputError);
  without = problem;
  without.objective[0].after = 0;
  CHECK_THROWS_AS(Formulation(without), InputError);
  without.objective.insert(without.objective.begin(), {ObjectiveQuantity::JointRateNorm});
  CHECK_THROWS_AS(Formulation(without), InputError);
}

TEST_CASE("a simulation that breaks off counts as a rotation by pi") {
  const CaptureProblem problem = planar_problem();
  ObjectiveTerm term = problem.objective[0];
  term.size = 2;
  const AttitudeTurned turn(problem, term);
  const JointVectord phi = JointVectord::Zero(2), rates = JointVectord::Constant(2, 1e20);
  CHECK(turn(phi, Vector6d::Zero(), rates, {}).norm() == Approx(M_PI / 2).epsilon(1e-14));
  CHECK(turn(phi, Vector6d::Zero(), JointVectord::Constant(2, std::nan("")), {}).norm() ==
        Approx(M_PI / 2).epsilon(1e-14));
  CHECK(turn(phi, Vector6d::Zero(), JointVectord::Zero(2), {}).norm() == 0);
}

TEST_CASE("the attitude change of the base can be one quantity of a front") {
  CaptureProblem problem = test::shipped("planar_three_link_null");
  problem.measure = {};
  problem.uncertainty.cone_half_angle = 0;
  problem.objective = {{ObjectiveQuantity::JointRateNorm},
                       {ObjectiveQuantity::AttitudeTurned, 0.01}};
  problem.objective[1].after = 0.2;
  problem.post_impact.controllers = {"joint_damping"};
  TradeOffOptions options;
  options.starts = 8;
  options.levels = 4;
  const TradeOff front = trade_off(problem, ObjectiveQuantity::AttitudeTurned,
                                   ObjectiveQuantity::JointRateNorm, options);
  REQUIRE(front.points.size() >= 3);
  CaptureProblem alone = problem;
  alone.objective.erase(alone.objective.begin());
  alone.objective[0].size = 1;
  const Formulation formulation(alone);
  for (std::size_t i = 0; i < front.points.size(); ++i) {
    const TradeOffPoint& point = front.points[i];
    CHECK(point.max_violation <= 1e-9);
    CHECK(point.first == nominal_value(alone, formulation, point.configuration));
    if (i == 0) continue;
    CHECK(point.first > front.points[i - 1].first);
    CHECK(point.second < front.points[i - 1].second);
  }
}

}  // namespace stillbase
