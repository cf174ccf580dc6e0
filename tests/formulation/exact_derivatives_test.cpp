#include <catch2/catch.hpp>

#include "formulation/formulation_parts.hpp"
#include "formulation/objectives/jump_objective_kernel.hpp"
#include "formulation/some_point.hpp"
#include "support/capture_problems.hpp"

namespace stillbase {
namespace {

double relative(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  return (a - b).cwiseAbs().maxCoeff() / (1 + b.cwiseAbs().maxCoeff());
}

/// A box or capsule, at random, on base and target, alternating ones on the bodies.
void add_shapes(Random& random, CaptureProblem& problem) {
  const auto pose = [&random] {
    const Vector3d position = 0.3 * random.unit_vector();
    return Pose{position, rotation_exp(random.unit_vector())};
  };
  problem.robot.shapes = {{kBase, "base", pose(), Box{{0.8, 0.7, 0.5}}}};
  for (int k = 0; k < problem.robot.n(); ++k) {
    const Geometry geometry = k % 3 == 0   ? Geometry(Capsule{0.05, 0.4})
                              : k % 3 == 1 ? Geometry(Sphere{0.1})
                                           : Geometry(Box{{0.1, 0.2, 0.3}});
    problem.robot.shapes.push_back({k, "link_" + std::to_string(k), pose(), geometry});
  }
  problem.target->shapes = {{pose(), Box{{0.6, 0.5, 0.4}}}, {pose(), Cylinder{0.1, 0.5}}};
}

/// A problem that has every kind of row and of term somewhere among the trials.
CaptureProblem rich_problem(Random& random, int trial, ContactLaw law) {
  CaptureProblem problem = tumbling_problem(random, random_robot(random, 6, trial % 2 == 0));
  problem.impulse.contact = law;
  const CaseConstraint cases[] = {CaseConstraint::C2, CaseConstraint::G2, CaseConstraint::None};
  problem.constraints.impact_case = cases[trial % 3];
  if (trial % 4 == 1) problem.hand.constraint = HandConstraint::Pose;
  if (trial % 4 == 2) {
    problem.variables.base_attitude = AttitudeFreedom::Axis;
    problem.variables.base_attitude_axis = random.unit_vector();
  }
  if (trial % 3 == 1) problem.variables.base_attitude_max = 2;
  if (trial % 5 == 4) {
    problem.variables.base_attitude = AttitudeFreedom::Cone;
    problem.variables.base_attitude_axis = random.unit_vector();
    problem.variables.base_attitude_max = 0.4;
    problem.base.orientation = rotation_exp(random.unit_vector());
  }
  if (trial % 4 == 3) {
    problem.variables.base_position = PositionFreedom::Fixed;
    // A latch gives a moment: C2 takes six equations, too many beside those of the hand.
    const bool is_too_much =
        law == ContactLaw::Latch && problem.constraints.impact_case == CaseConstraint::C2;
    if (is_too_much) problem.constraints.impact_case = CaseConstraint::G3;
  }
  add_shapes(random, problem);
  problem.constraints.joint_rate_max = JointVectord::Constant(problem.robot.n(), 0.01);
  problem.constraints.coupling_singular_value_min = 0.1;
  problem.constraints.jacobian_singular_value_min = 0.1;
  problem.constraints.jacobian_length = 0.7;
  // Distances know no contact law; with other random robots they have corners in the differences.
  if (law == ContactLaw::Frictionless) problem.constraints.clearance = 0.02;
  problem.objective = {
      {ObjectiveQuantity::BaseAngularMomentum, 0.7}, {ObjectiveQuantity::BaseAngularVelocity, 0.3},
      {ObjectiveQuantity::TotalAngularMomentum, 2},  {ObjectiveQuantity::BaseMomentum, 3, 0.5},
      {ObjectiveQuantity::ImpulseMagnitude, 5},      {ObjectiveQuantity::JointRateNorm, 0.2}};
  problem.uncertainty.cone_half_angle = 0.3;
  problem.uncertainty.closing_speed = 0.01;
  problem.uncertainty.restitution = 0.1;
  problem.uncertainty.target_mass = 0.2;
  problem.uncertainty.target_inertia = 0.2;
  problem.uncertainty.contact_point = 0.05;
  problem.uncertainty.contact_time = 2;
  if (trial % 2 == 1) problem.uncertainty.joint_position = JointVectord::Constant(6, 0.1);
  problem.measure.samples = 5;
  return problem;
}

/// By contact law; a sticking contact may be with a point mass.
CaptureProblem point_mass_or_rich_problem(Random& random, int trial, ContactLaw law) {
  CaptureProblem problem = rich_problem(random, trial, law);
  if (law == ContactLaw::Sticking && trial % 2 == 1) {
    problem.impulse.source = ImpulseSource::PointMass;
  }
  return problem;
}

ContactLaw a_contact_law() {
  return GENERATE(ContactLaw::Frictionless, ContactLaw::Sticking, ContactLaw::Latch);
}

}  // namespace

TEST_CASE("gradients of every row, term and scenario agree with automatic differentiation") {
  const ContactLaw law = a_contact_law();
  Random random(51);
  for (int trial = 0; trial < 12; ++trial) {
    const CaptureProblem problem = point_mass_or_rich_problem(random, trial, law);
    const Formulation formulation(problem);
    const Formulation::Parts& parts = formulation.parts();
    const CaptureModel& model = parts.model;
    const Eigen::VectorXd x = some_point(formulation, trial);
    const std::vector<Scenario> scenarios = draw_scenarios(problem);
    ScenarioEvaluation here;
    formulation.evaluate_scenarios(x, scenarios, true, here);

    CHECK(formulation.evaluate_points({x}, scenarios)
              .row(0)
              .transpose()
              .isApprox(here.values, 1e-14));
    ScenarioEvaluation alone;
    formulation.evaluate_scenarios(x, {scenarios[0]}, true, alone);  // too few for packs
    CHECK(alone.values[0] == Approx(here.values[0]).epsilon(1e-12));
    CHECK(relative(alone.gradients.row(0), here.gradients.row(0)) < 1e-11);

    const auto& rows = parts.rows.kept;
    REQUIRE(here.constraints.size() == static_cast<int>(rows.size()));
    Eigen::VectorXd values(here.values.size()), constraints(here.constraints.size());
    Eigen::MatrixXd gradients(values.size(), x.size()), jacobian(constraints.size(), x.size());
    VectorX<Tangent> along = x.cast<Tangent>();
    for (Eigen::Index i = 0; i < x.size(); ++i) {
      along[i].set_derivative(1);
      const auto at = model.place<Tangent>(along);
      for (std::size_t k = 0; k < scenarios.size(); ++k) {
        const auto posture = model.posture(at, scenarios[k]);
        const Tangent f = parts.jump.objective(posture, model.impact(at, posture, scenarios[k]),
                                               parts.objective_unit);
        values[static_cast<Eigen::Index>(k)] = f.v;
        gradients(static_cast<Eigen::Index>(k), i) = f.derivative();
      }
      const auto posture = model.posture(at);
      const auto impact = model.impact(at, posture, model.nominal);
      for (std::size_t k = 0; k < rows.size(); ++k) {
        const Tangent g = rows[k]->value({model, at, posture, impact});
        constraints[static_cast<Eigen::Index>(k)] = g.v;
        jacobian(static_cast<Eigen::Index>(k), i) = g.derivative();
      }
      along[i].set_derivative(0);
    }
    for (Eigen::Index k = 0; k < values.size(); ++k) {
      INFO("contact law " << static_cast<int>(law) << ", trial " << trial << ", scenario " << k);
      CHECK(here.values[k] == Approx(values[k]).epsilon(1e-12));
      CHECK(relative(here.gradients.row(k), gradients.row(k)) < 1e-11);
    }
    for (Eigen::Index k = 0; k < constraints.size(); ++k) {
      INFO("contact law " << static_cast<int>(law) << ", trial " << trial << ", row "
                          << rows[static_cast<std::size_t>(k)]->name);
      CHECK(here.constraints[k] == Approx(constraints[k]).epsilon(0).margin(1e-12));
      CHECK(relative(here.jacobian.row(k), jacobian.row(k)) < 1e-11);
    }
  }
}

TEST_CASE("the Hessian over scenarios and rows is the change of their gradients") {
  const ContactLaw law = a_contact_law();
  Random random(52);
  for (int trial = 0; trial < 8; ++trial) {
    const CaptureProblem problem = point_mass_or_rich_problem(random, trial, law);
    const Formulation formulation(problem);
    const Eigen::VectorXd x = some_point(formulation, trial);
    const std::vector<Scenario> scenarios = draw_scenarios(problem);
    const auto count = static_cast<Eigen::Index>(scenarios.size());
    const Eigen::Index rows = formulation.num_constraints();
    // Change of the gradients (scenarios, then rows) with each variable: central differences of
    // sixth order, in plain numbers.
    std::vector<Eigen::MatrixXd> changes;
    // Curvatures of a corner's distance from a box jump where another face or edge is nearest: such
    // a jump between the points shows as a difference between two steps.
    Eigen::VectorXd jumps = Eigen::VectorXd::Zero(count + rows);
    const auto change = [&](Eigen::Index i, double step_size) {
      const auto difference = [&](double steps) {
        const Eigen::VectorXd step = steps * step_size * Eigen::VectorXd::Unit(x.size(), i);
        ScenarioEvaluation ahead, behind;
        formulation.evaluate_scenarios(x + step, scenarios, true, ahead);
        formulation.evaluate_scenarios(x - step, scenarios, true, behind);
        Eigen::MatrixXd out(count + rows, x.size());
        out << ahead.gradients - behind.gradients, ahead.jacobian - behind.jacobian;
        return out;
      };
      return Eigen::MatrixXd((45 * difference(1) - 9 * difference(2) + difference(3)) /
                             (60 * step_size));
    };
    for (Eigen::Index i = 0; i < x.size(); ++i) {
      // Rounding and truncation below 1e-11, no corner in between: those of distances ask for the
      // shorter step.
      const double step_size = law == ContactLaw::Frictionless ? 6e-4 : 2e-3;
      changes.push_back(change(i, step_size));
      const Eigen::MatrixXd apart = changes.back() - change(i, 0.7 * step_size);
      jumps = jumps.cwiseMax(apart.cwiseAbs().rowwise().maxCoeff());
    }
    const auto& kept = formulation.parts().rows.kept;
    const auto has_jump = [&](Eigen::Index row) {
      return kept[static_cast<std::size_t>(row)]->name.rfind("clearance_", 0) == 0 &&
             jumps[count + row] > 1e-10;
    };
    // Error of the Hessian of one combination, over one and the largest entry.
    const auto error = [&](const Eigen::VectorXd& weights, const Eigen::VectorXd& multipliers) {
      Eigen::MatrixXd hessian, expected(x.size(), x.size());
      formulation.scenario_hessian(x, scenarios, weights, multipliers, hessian);
      Eigen::VectorXd factors(count + rows);
      factors << weights, multipliers;
      for (Eigen::Index i = 0; i < x.size(); ++i) {
        expected.col(i) = changes[static_cast<std::size_t>(i)].transpose() * factors;
      }
      return (hessian - expected).cwiseAbs().maxCoeff() / (1 + expected.cwiseAbs().maxCoeff());
    };
    Eigen::VectorXd weights(count), multipliers(rows);
    for (double& w : weights) w = random.normal();
    Eigen::Index left_out = 0;
    Random of_corners(64, static_cast<std::uint64_t>(trial));
    for (Eigen::Index row = 0; row < rows; ++row) {
      const bool is_corner = kept[static_cast<std::size_t>(row)]->is_part;
      const double multiplier = (is_corner ? of_corners : random).normal();
      multipliers[row] = has_jump(row) ? 0 : multiplier;
      left_out += has_jump(row) ? 1 : 0;
    }
    INFO("contact law " << static_cast<int>(law) << ", trial " << trial);
    CHECK(20 * left_out <= rows);
    CHECK(error(weights, multipliers) < 1e-11);
    CHECK(error(weights, Eigen::VectorXd::Zero(rows)) < 1e-11);
    for (Eigen::Index row = 0; row < rows; ++row) {
      INFO("row " << row);
      if (has_jump(row)) continue;
      // Singular values cost their Hessians a digit.
      CHECK(error(Eigen::VectorXd::Zero(count), Eigen::VectorXd::Unit(rows, row)) < 3e-11);
    }
  }
}

TEST_CASE("the Hessian is the change of the gradient") {
  const ContactLaw law = a_contact_law();
  Random random(53);
  for (int trial = 0; trial < 4; ++trial) {
    const CaptureProblem problem = point_mass_or_rich_problem(random, trial, law);
    const Formulation formulation(problem);
    const Eigen::VectorXd x = some_point(formulation, trial);
    const Eigen::VectorXd multipliers = Eigen::VectorXd::Ones(formulation.num_constraints());
    Eigen::MatrixXd hessian;
    formulation.lagrangian_hessian(x, 1, multipliers, hessian);
    const auto gradient = [&](const Eigen::VectorXd& at) -> Eigen::VectorXd {
      nlp::Evaluation e;
      formulation.evaluate(at, e);
      return e.gradient + e.jacobian.transpose() * multipliers;
    };
    const double h = 1e-5, size = 1 + hessian.cwiseAbs().maxCoeff();
    for (int i = 0; i < x.size(); ++i) {
      const Eigen::VectorXd step = h * Eigen::VectorXd::Unit(x.size(), i);
      const Eigen::VectorXd column = (gradient(x + step) - gradient(x - step)) / (2 * h);
      CHECK((hessian.col(i) - column).cwiseAbs().maxCoeff() / size < 1e-7);
    }
  }
}

}  // namespace stillbase
