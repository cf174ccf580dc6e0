#include <catch2/catch.hpp>

#include <stillbase/formulation/measures/robust.hpp>
#include <stillbase/reference/reference.hpp>
#include <stillbase/search/search.hpp>

#include "support/capture_problems.hpp"
#include "support/dense.hpp"

namespace stillbase {
namespace {

/// Total and coupling angular momentum (z) for a unit impulse, by the reference dynamics.
Eigen::Vector2d c2_residual(const RobotModel& robot, const Eigen::Vector2d& phi,
                            const Vector3d& direction) {
  reference::State state;
  state.phi = phi;
  state.phidot = Eigen::VectorXd::Zero(2);
  const auto dynamics = reference::compute(robot, state);
  Eigen::Matrix<double, 6, 1> F;
  F << direction, 0, 0, 0;
  const auto impact = reference::impact(dynamics, Eigen::VectorXd::Zero(2), {}, F);
  return {impact.total.z(), impact.coupling.z()};
}

/// All zeros by Newton steps from every node of a dense grid.
std::vector<Eigen::Vector2d> dense_newton(const RobotModel& robot, const Vector3d& direction) {
  std::vector<Eigen::Vector2d> zeros;
  constexpr int kGrid = 20;
  for (int i = 0; i < kGrid * kGrid; ++i) {
    Eigen::Vector2d phi(2 * M_PI * (i % kGrid) / kGrid - M_PI,
                        2 * M_PI * (i / kGrid) / kGrid - M_PI);
    Eigen::Vector2d r = c2_residual(robot, phi, direction);
    for (int iteration = 0; iteration < 30 && r.norm() > 1e-13; ++iteration) {
      Eigen::Matrix2d J;
      for (int k = 0; k < 2; ++k) {
        const Eigen::Vector2d h = 1e-6 * Eigen::Vector2d::Unit(k);
        J.col(k) =
            (c2_residual(robot, phi + h, direction) - c2_residual(robot, phi - h, direction)) /
            2e-6;
      }
      Eigen::Vector2d step = -test::solve(J, r);
      if (!step.allFinite()) break;
      if (step.norm() > 0.3) step *= 0.3 / step.norm();
      phi += step;
      r = c2_residual(robot, phi, direction);
    }
    if (r.norm() > 1e-10) continue;
    phi = {wrap_angle(phi[0]), wrap_angle(phi[1])};
    bool known = false;
    for (const Eigen::Vector2d& zero : zeros) {
      const Eigen::Vector2d d(wrap_angle(zero[0] - phi[0]), wrap_angle(zero[1] - phi[1]));
      known = known || d.norm() < 1e-5;
    }
    if (!known) zeros.push_back(phi);
  }
  return zeros;
}

}  // namespace

TEST_CASE(
    "all C2 postures of random planar robots are found, as a dense Newton search finds them") {
  Random random(31);
  std::size_t most = 0;
  for (int trial = 0; trial < 3; ++trial) {
    const RobotModel robot = random_planar_robot(random, 2);
    const double angle = random.uniform(-M_PI, M_PI);
    const Vector3d direction(std::cos(angle), std::sin(angle), 0);
    CaptureProblem problem = point_mass_problem(robot, direction);
    problem.constraints.impact_case = CaseConstraint::C2;
    const Formulation formulation(problem);
    const SearchResult found = search(problem, formulation, {});

    const std::vector<Eigen::Vector2d> zeros = dense_newton(robot, direction);
    CHECK(found.distinct_solutions == static_cast<int>(zeros.size()));
    most = std::max(most, zeros.size());
    for (const Eigen::Vector2d& zero : zeros) {
      double nearest = 10;
      for (const Candidate& candidate : found.candidates) {
        const JointVectord& phi = candidate.configuration.phi;
        nearest = std::min(
            nearest,
            Eigen::Vector2d(wrap_angle(zero[0] - phi[0]), wrap_angle(zero[1] - phi[1])).norm());
      }
      INFO("posture " << zero.transpose());
      CHECK(nearest < 1e-6);
    }
  }
  CHECK(most >= 4);
}

TEST_CASE("both local solvers find exact zeros of the base rate with the hand at a fixed point") {
  Random random(41);
  const RobotModel robot = random_planar_robot(random, 3);
  JointVectord reachable(3);
  reachable << 0.5, -0.9, 0.7;
  CaptureProblem problem = point_mass_problem(robot, Vector3d(-0.8, 0.6, 0));
  problem.objective = {{ObjectiveQuantity::BaseAngularVelocity}};
  problem.hand.constraint = HandConstraint::Position;
  problem.hand.frame = Frame::Base;
  problem.hand.position = compute_kinematics<double>(robot, reachable).r_bh;
  const Formulation formulation(problem);
  CHECK(formulation.num_equations() == 2);
  for (const char* optimizer : {"sqp", "nlopt-slsqp", "ipopt"}) {
    SearchOptions options;
    options.optimizer = optimizer;
    const SearchResult found = search(problem, formulation, options);
    INFO(optimizer);
    REQUIRE(found.status == PlanStatus::Feasible);
    CHECK(found.solver_calls.at(optimizer) >= 64);
    CHECK(found.candidates.front().max_violation <= 1e-9);
    CHECK(status_of(found.certificates.front()) == PlanStatus::Optimal);
    const auto kinematics =
        compute_kinematics<double>(robot, found.candidates.front().configuration.phi);
    CHECK((kinematics.r_bh - *problem.hand.position).norm() < 1e-9);
  }
}

TEST_CASE("a hand position out of reach is infeasible, and the nearest attempt is kept") {
  Random random(33);
  const RobotModel robot = random_planar_robot(random, 3);
  CaptureProblem problem = point_mass_problem(robot, Vector3d(-0.8, 0.6, 0));
  problem.hand.constraint = HandConstraint::Position;
  problem.hand.frame = Frame::Base;
  problem.hand.position = Vector3d(50, 0, 0);
  const Formulation formulation(problem);
  const SearchResult found = search(problem, formulation, {});
  CHECK(found.status == PlanStatus::Infeasible);
  REQUIRE(found.candidates.size() == 1);
  CHECK(found.candidates.front().max_violation > 10);
  CHECK(found.distinct_solutions == 0);
}

TEST_CASE("the same seed gives the same candidates to the last bit") {
  Random random(34);
  CaptureProblem problem = tumbling_problem(random, random_robot(random, 6, false));
  problem.variables.base_position = PositionFreedom::Free;
  const Formulation formulation(problem);
  SearchOptions options;
  options.starts = 8;
  const SearchResult a = search(problem, formulation, options);
  const SearchResult b = search(problem, formulation, options);
  REQUIRE(a.candidates.size() == b.candidates.size());
  for (std::size_t i = 0; i < a.candidates.size(); ++i) {
    CHECK(a.candidates[i].configuration.phi == b.candidates[i].configuration.phi);
    CHECK(a.candidates[i].worst_case == b.candidates[i].worst_case);
  }
}

TEST_CASE("the worst case over a cone is never below a dense scan") {
  Random random(35);
  for (int trial = 0; trial < 4; ++trial) {
    CaptureProblem problem = tumbling_problem(random, random_robot(random, 7, false));
    problem.variables.base_position = PositionFreedom::Free;
    problem.uncertainty.cone_half_angle = 0.1 + 0.2 * trial;
    const Formulation formulation(problem);
    const Configuration configuration = formulation.configuration(
        formulation.start_point(low_discrepancy_point(trial, formulation.num_variables(), 9)));
    const WorstCase worst = worst_case(problem, formulation, configuration);

    const EncounterModel& model = formulation.encounter_model();
    const Encounter<double> encounter = encounter_at(model, configuration);
    const Matrix3d& R_EB = encounter.contact.R_EB;
    const Vector3d velocity = R_EB.transpose() * encounter.contact.velocity_at(model.r);
    const auto posture = evaluate_posture<double>(
        problem.robot, prepare_resistance(problem.resistance, problem.robot.n()),
        configuration.phi);
    const Vector3d n = encounter.F.head<3>();
    const auto value = [&](const Vector3d& d) {
      Vector6d F;
      F << d, 0, 0, 0;
      const auto response = respond<double>(posture, F);
      Encounter<double> here = encounter;
      here.closing_speed = d.dot(velocity);
      here.target_inverse_mass = target_inverse_mass(
          problem.target->mass, problem.target->inertia.inverse(), model.r, R_EB * d);
      return impulse_magnitude(model, here, response.hand_inverse_mass) * response.base.norm();
    };
    double scan = value(n);
    const double alpha = problem.uncertainty.cone_half_angle;
    for (int i = 0; i < 100000; ++i) {
      const Eigen::VectorXd u = low_discrepancy_point(i, 2, 1);
      const double angle = std::acos(1 - u[0] * (1 - std::cos(alpha)));
      const Vector3d side = n.unitOrthogonal();
      const Vector3d t =
          std::cos(2 * M_PI * u[1]) * side + std::sin(2 * M_PI * u[1]) * n.cross(side);
      scan = std::max(scan, value(std::cos(angle) * n + std::sin(angle) * t));
    }
    CHECK(worst.value >= scan * (1 - 1e-12));
    CHECK(std::acos(std::min(1.0, worst.direction.dot(n))) <= alpha + 1e-9);
    CHECK(value(worst.direction) == Approx(worst.value).epsilon(1e-10));
  }
}

}  // namespace stillbase
