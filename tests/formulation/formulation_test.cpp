#include <catch2/catch.hpp>

#include <stillbase/core/error.hpp>
#include <stillbase/formulation/formulation.hpp>

#include "formulation/projection.hpp"
#include "formulation/some_point.hpp"
#include "support/capture_problems.hpp"
#include "support/shipped_problem.hpp"

namespace stillbase {
namespace {

/// Fourth-order central differences of objective and constraints.
void check_derivatives(const Formulation& formulation, const Eigen::VectorXd& x) {
  nlp::Evaluation at_x;
  formulation.evaluate(x, at_x);
  const double h = 1e-3;
  for (int i = 0; i < x.size(); ++i) {
    nlp::Evaluation e[4];
    const double steps[4] = {-2 * h, -h, h, 2 * h};
    for (int k = 0; k < 4; ++k) {
      formulation.evaluate_value(x + steps[k] * Eigen::VectorXd::Unit(x.size(), i), e[k]);
    }
    const auto difference = [h](double a, double b, double c, double d) {
      return (a - 8 * b + 8 * c - d) / (12 * h);
    };
    const double df = difference(e[0].objective, e[1].objective, e[2].objective, e[3].objective);
    const double size = 1 + at_x.gradient.cwiseAbs().maxCoeff();
    CHECK(std::abs(at_x.gradient[i] - df) / size < 1e-7);
    for (int j = 0; j < at_x.constraints.size(); ++j) {
      const double dg = difference(e[0].constraints[j], e[1].constraints[j], e[2].constraints[j],
                                   e[3].constraints[j]);
      const double row = 1 + at_x.jacobian.row(j).cwiseAbs().maxCoeff();
      INFO("constraint " << j << ", variable " << i);
      CHECK(std::abs(at_x.jacobian(j, i) - dg) / row < 1e-7);
    }
  }
}

}  // namespace

TEST_CASE("objective and constraints with joints, attitude and contact time have exact gradients") {
  Random random(21);
  const ObjectiveQuantity quantities[] = {ObjectiveQuantity::BaseAngularMomentum,
                                          ObjectiveQuantity::BaseAngularVelocity,
                                          ObjectiveQuantity::TotalAngularMomentum};
  const CaseConstraint cases[] = {CaseConstraint::None, CaseConstraint::C, CaseConstraint::C2,
                                  CaseConstraint::G2, CaseConstraint::G3};
  for (int trial = 0; trial < 12; ++trial) {
    CaptureProblem problem = tumbling_problem(random, random_robot(random, 6, trial % 2 == 0));
    problem.objective = {{quantities[trial % 3]}};
    problem.constraints.impact_case = cases[trial % 5];
    if (trial % 4 == 1) problem.hand.constraint = HandConstraint::Pose;
    if (trial % 4 == 2) {
      problem.variables.base_attitude = AttitudeFreedom::Axis;
      problem.variables.base_attitude_axis = random.unit_vector();
    }
    if (trial % 4 == 3) problem.variables.base_position = PositionFreedom::Free;
    if (trial % 3 == 1) problem.variables.base_attitude_max = 2;
    const Formulation formulation(problem);
    check_derivatives(formulation, some_point(formulation, trial));
  }
}

TEST_CASE("a rank-deficient coupling matrix gives as many case rows as its rank") {
  // Axes z, x, x as in the SPART arm: rank 2 in every posture.
  Random random(5);
  RobotModel robot = random_robot(random, 3, false);
  const Matrix3d z_to_x = rotation_exp(Vector3d(0, M_PI / 2, 0)).toRotationMatrix();
  for (int k = 0; k < 3; ++k) {
    robot.joints[k].type = JointType::Continuous;
    robot.joints[k].R = k == 1 ? z_to_x : Matrix3d(Matrix3d::Identity());
    robot.joints[k].p = k < 2 ? Vector3d(0, 0, 0.5) : Vector3d(-0.5, 0, 0);
    robot.bodies[k].centroid = k == 0 ? Vector3d(0, 0, 0.1) : Vector3d(-0.3, 0, 0);
    robot.bodies[k].inertia = Vector3d(0.1, 0.1, 0.1).asDiagonal();
  }
  robot.base.inertia = 9 * Matrix3d::Identity();
  CaptureProblem problem = point_mass_problem(robot, Vector3d(0.6, 0, 0.8));
  problem.constraints.impact_case = CaseConstraint::G3;
  const Formulation formulation(problem);
  CHECK(formulation.num_equations() == 2);
  check_derivatives(formulation, some_point(formulation, 1));
}

TEST_CASE("cases impose the stated number of independent equations") {
  Random random(11);
  const auto equations = [](CaptureProblem problem, CaseConstraint wanted) {
    problem.constraints.impact_case = wanted;
    return Formulation(problem).num_equations();
  };
  RobotModel spatial = random_robot(random, 7, false);
  for (Joint& joint : spatial.joints) joint.type = JointType::Continuous;
  const CaptureProblem in_space = point_mass_problem(spatial, Vector3d(0.48, 0.6, 0.64));
  CHECK(equations(in_space, CaseConstraint::G2) == 3);
  CHECK(equations(in_space, CaseConstraint::G3) == 3);
  CHECK(equations(in_space, CaseConstraint::C) == 2);
  CHECK(equations(in_space, CaseConstraint::C1) == 2);
  CHECK(equations(in_space, CaseConstraint::C2) == 5);
  const CaptureProblem in_plane =
      point_mass_problem(random_planar_robot(random, 3), Vector3d(0.6, 0.8, 0));
  CHECK(equations(in_plane, CaseConstraint::G2) == 1);
  CHECK(equations(in_plane, CaseConstraint::G3) == 1);
  CHECK(equations(in_plane, CaseConstraint::C) == 1);
  CHECK(equations(in_plane, CaseConstraint::C2) == 2);
}

TEST_CASE("more equations than free variables are refused with the count") {
  Random random(12);
  CaptureProblem problem =
      point_mass_problem(random_planar_robot(random, 2), Vector3d(0.6, 0.8, 0));
  problem.constraints.impact_case = CaseConstraint::C2;
  problem.variables.joints[0] = false;
  try {
    const Formulation formulation(problem);
    FAIL("was accepted");
  } catch (const InputError& error) {
    REQUIRE(error.findings().size() == 1);
    CHECK(error.findings()[0].rule == "too-few-variables");
    CHECK(error.findings()[0].message.find("2 independent equations") != std::string::npos);
    CHECK(error.findings()[0].message.find("only 1 variables") != std::string::npos);
  }
}

TEST_CASE("objective with gradient and all constraints costs one evaluation of the model") {
  Random random(13);
  CaptureProblem problem = tumbling_problem(random, random_robot(random, 6, false));
  problem.constraints.impact_case = CaseConstraint::G2;
  const Formulation formulation(problem);
  const long before = formulation.evaluations();
  nlp::Evaluation out;
  formulation.evaluate(some_point(formulation, 2), out);
  CHECK(formulation.evaluations() == before + 1);
}

TEST_CASE("objective and gradient come from the objective vector and its Jacobian") {
  Random random(14);
  CaptureProblem problem = tumbling_problem(random, random_robot(random, 6, false));
  const Formulation formulation(problem);
  const Eigen::VectorXd x = some_point(formulation, 4);
  nlp::Evaluation at_x;
  formulation.evaluate(x, at_x);
  Eigen::VectorXd y;
  Eigen::MatrixXd J;
  formulation.objective_vector(x, y, J);
  CHECK(at_x.objective == Approx(y.squaredNorm() / 2).epsilon(1e-12));
  CHECK((J.transpose() * y - at_x.gradient).norm() < 1e-10 * (1 + at_x.gradient.norm()));
}

TEST_CASE("constraints and the objective vector together are what each is alone") {
  Random random(15);
  CaptureProblem problem = tumbling_problem(random, random_robot(random, 6, false));
  problem.constraints.closing_speed_min = 1e3;  // holds nowhere
  const Formulation formulation(problem);
  const Eigen::VectorXd x = some_point(formulation, 4);
  nlp::Evaluation alone, both;
  formulation.evaluate(x, alone);
  Eigen::VectorXd y, y_too, violation, violation_and_y;
  Eigen::MatrixXd J_y, J_y_too, J, J_and_y;
  formulation.objective_vector(x, y, J_y);
  formulation.evaluate_vector(x, both, y_too, J_y_too);
  CHECK(y_too == y);
  CHECK(J_y_too == J_y);
  CHECK(both.constraints == alone.constraints);
  CHECK(both.jacobian == alone.jacobian);
  CHECK(both.objective == Approx(alone.objective).epsilon(1e-12));
  CHECK((both.gradient - alone.gradient).norm() < 1e-10 * (1 + alone.gradient.norm()));
  for (const bool equations_alone : {true, false}) {
    formulation.evaluate_violated(x, equations_alone, false, violation, J);
    formulation.evaluate_violated(x, equations_alone, true, violation_and_y, J_and_y);
    REQUIRE(violation_and_y.size() == violation.size() + y.size());
    CHECK(violation_and_y.head(violation.size()) == violation);
    CHECK(violation_and_y.tail(y.size()) == y);
    CHECK(J_and_y.topRows(J.rows()) == J);
    CHECK(J_and_y.bottomRows(y.size()) == J_y);
    CHECK((equations_alone || violation.size() > 0));
  }
}

TEST_CASE("a limit on the rotation of the base bounds its angle, not each component") {
  Random random(16);
  CaptureProblem problem = tumbling_problem(random, random_robot(random, 6, false));
  problem.variables.base_attitude_max = 0.5;
  const Formulation formulation(problem);
  Eigen::VectorXd x = some_point(formulation, 3);
  const auto worst = [&] {
    double violation = 0;
    for (const ConstraintValue& value : formulation.report(x)) {
      if (value.name == "base_attitude_squared") violation = value.violation;
    }
    return violation;
  };
  CHECK(worst() == 0);
  x.segment<3>(6).setConstant(0.49);
  CHECK(worst() > 0.1);
}

TEST_CASE("a cone keeps one axis of the base near its direction and leaves the roll free") {
  Random random(17);
  CaptureProblem problem = tumbling_problem(random, random_robot(random, 6, false));
  problem.base.orientation = rotation_exp({0.4, -0.2, 0.9});
  problem.variables.base_attitude = AttitudeFreedom::Cone;
  problem.variables.base_attitude_axis = Vector3d(2, -1, 2) / 3;
  problem.variables.base_attitude_max = 0.3;
  const Vector3d& axis = problem.variables.base_attitude_axis;
  const Vector3d in_base = problem.base.orientation.conjugate() * axis;
  const Formulation formulation(problem);
  double largest_tilt = 0, largest_turn = 0;
  for (int i = 0; i < 200; ++i) {
    const Eigen::VectorXd x = some_point(formulation, i);
    const Eigen::Quaterniond attitude = formulation.configuration(x).base.orientation;
    const double tilt = std::acos(std::min(1.0, axis.dot(attitude * in_base)));
    largest_tilt = std::max(largest_tilt, tilt);
    largest_turn = std::max(largest_turn, attitude.angularDistance(problem.base.orientation));
    CHECK(tilt <= 0.3 + 1e-12);
    for (const ConstraintValue& value : formulation.report(x)) {
      if (value.name != "base_attitude_cone") continue;
      CHECK(value.value == Approx(std::cos(tilt)).epsilon(1e-12));
      CHECK(value.lower == std::cos(0.3));
      CHECK(value.violation <= 1e-12);
    }
  }
  CHECK(largest_tilt > 0.28);
  CHECK(largest_turn > 3);
}

TEST_CASE("no shortest rotation is at the bounds of an attitude without a limit") {
  Random random(18);
  CaptureProblem problem = tumbling_problem(random, random_robot(random, 6, false));
  VariableSpec& variables = problem.variables;
  variables.base_attitude_axis = Vector3d::UnitX();
  variables.base_attitude_max = kPi;
  SECTION("any attitude") { variables.base_attitude = AttitudeFreedom::Free; }
  SECTION("about an axis") { variables.base_attitude = AttitudeFreedom::Axis; }
  SECTION("a cone") {
    variables.base_attitude = AttitudeFreedom::Cone;
    variables.base_attitude_max = 0.3;
  }
  const Formulation formulation(problem);
  const Eigen::VectorXd lower = formulation.lower(), upper = formulation.upper();
  for (int i = 0; i < 50; ++i) {
    const Eigen::VectorXd x = some_point(formulation, i);
    CHECK(in_shortest_turns(formulation, x) == x);
  }
  // Half a turn about the axis, and a longer one: the same attitude within the bounds.
  Eigen::VectorXd x = some_point(formulation, 0);
  x.segment(6, x.size() - 7).setZero();
  for (const double turn : {kPi, -kPi, 3.5}) {
    x[6] = turn;
    CHECK(x[6] < upper[6] - 0.05);
    CHECK(x[6] > lower[6] + 0.05);
    const Eigen::VectorXd shortest = in_shortest_turns(formulation, x);
    CHECK(std::abs(shortest[6]) < kPi + 1e-12);
    CHECK(formulation.distance(shortest, x) < 1e-12);
  }
  CHECK(in_shortest_turns(formulation, x) != x);
}

TEST_CASE(
    "the largest violation is that of the report, and near points are those of the distance") {
  for (const char* name : {"iiwa_cone", "deos_client_224", "ets7_envisat", "iiwa_case_c"}) {
    const Formulation formulation(test::shipped(name));
    INFO(name);
    std::vector<Eigen::VectorXd> points;
    for (int i = 0; i < 60; ++i) {
      points.push_back(
          formulation.start_point(low_discrepancy_point(i, formulation.num_variables(), 5)));
      double worst = 0;
      for (const ConstraintValue& row : formulation.report(points.back()))
        worst = std::max(worst, row.violation);
      CHECK(formulation.largest_violation(points.back()) == worst);
    }
    for (const Eigen::VectorXd& other : points) {
      const double apart = formulation.distance(points[0], other);
      for (const double part : {0.5, 0.999999, 1.000001, 2.0}) {
        CHECK(formulation.are_within(points[0], other, part * apart) == (part > 1 || apart == 0));
      }
    }
  }
}

TEST_CASE("a free station puts the hand on the contact feature") {
  Random random(15);
  CaptureProblem problem = tumbling_problem(random, random_robot(random, 6, false));
  problem.variables.base_position = PositionFreedom::Free;
  const Formulation formulation(problem);
  const Configuration configuration = formulation.configuration(some_point(formulation, 5));
  const auto kinematics = compute_kinematics<double>(problem.robot, configuration.phi);
  const TargetMotion motion(*problem.target, problem.target_state, 10);
  const ContactState contact =
      motion.contact(problem.target->features[0], configuration.contact_time);
  CHECK((configuration.base * kinematics.r_bh - contact.point).norm() < 1e-12);
}

}  // namespace stillbase
