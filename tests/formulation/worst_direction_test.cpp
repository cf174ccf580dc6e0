// The maxima over a cone of directions, and the derivatives by which they are found.
#include <catch2/catch.hpp>

#include <cmath>
#include <thread>

#include <stillbase/formulation/measures/robust.hpp>

#include "formulation/measures/direction_model.hpp"
#include "impact/batch_kernels.hpp"
#include "support/capture_problems.hpp"

namespace stillbase {

namespace {

/// In the basis (n, u, v) of a cone.
Eigen::RowVector3d coordinates_of(const DirectionModel& model, const Vector3d& d) {
  return {d.dot(model.n), d.dot(model.u), d.dot(model.v)};
}

}  // namespace

TEST_CASE("many directions have the values that each has alone, in all registers") {
  Random random(39);
  for (int trial = 0; trial < 8; ++trial) {
    CaptureProblem problem =
        trial % 2 == 0 ? point_mass_problem(random_robot(random, 6, false), random.unit_vector())
                       : tumbling_problem(random, random_robot(random, 7, false));
    if (trial % 4 == 2) problem.impulse.source = ImpulseSource::Given;
    problem.impulse.magnitude = 0.7;
    problem.uncertainty.cone_half_angle = 2;
    const Formulation formulation(problem);
    const DirectionModel model(problem, formulation,
                               formulation.configuration(formulation.start_point(
                                   low_discrepancy_point(trial, formulation.num_variables(), 9))));
    constexpr Eigen::Index kCount = 3 * DirectionSquares::kMostLanes;
    Eigen::MatrixX3d in_cone(kCount, 3), in_base(kCount, 3);
    std::vector<double> alone;
    for (Eigen::Index i = 0; i < kCount; ++i) {
      const Eigen::Vector2d c(random.uniform(-1.4, 1.4), random.uniform(-1.4, 1.4));
      const Vector3d d = model.direction(c);
      in_cone.row(i) = coordinates_of(model, d);
      in_base.row(i) = d.transpose();
      alone.push_back(model.value(c) * model.value(c));
    }
    std::vector<double> squares;
    model.squares(in_cone, squares);
    const bool is_given = model.model.magnitude_is_given();
    const bool is_followed = !is_given && model.model.follows_target();
    const double speed = std::max(model.encounter.closing_speed, 0.0);
    const double yield = (1 + problem.impulse.restitution) * (is_followed ? 1 : speed);
    for (const BatchKernel* kernel : batch_kernels()) {
      std::vector<double> other(squares.size());
      kernel->direction_squares(
          {.count = kCount,
           .d = {in_base.col(0).data(), in_base.col(1).data(), in_base.col(2).data()},
           .rows = model.Y.rows(),
           .Y = model.Y.data(),
           .p = is_given ? problem.impulse.magnitude : yield,
           .speed_of_d = is_followed ? model.velocity.data() : nullptr,
           .W = is_given ? nullptr : model.W.data(),
           .squares = other.data()});
      INFO("trial " << trial << ", " << kernel->lanes << " lanes");
      for (std::size_t i = 0; i < alone.size(); ++i) {
        CHECK(squares[i] == Approx(alone[i]).epsilon(1e-12).margin(1e-300));
        CHECK(other[i] == Approx(alone[i]).epsilon(1e-12).margin(1e-300));
      }
    }
  }
}

TEST_CASE("every maximum over a cone or a wedge is one, seen from all sides") {
  Random random(36);
  for (int trial = 0; trial < 24; ++trial) {
    CaptureProblem problem =
        trial % 3 == 0 ? point_mass_problem(random_robot(random, 6, false), random.unit_vector())
                       : tumbling_problem(random, random_robot(random, 7, false));
    problem.uncertainty.cone_half_angle = 0.02 + 0.06 * trial;
    if (trial % 3 == 0 && trial % 2 == 0) {
      problem.uncertainty.cone_plane_normal = problem.impulse.direction->unitOrthogonal();
    }
    const Formulation formulation(problem);
    const Configuration configuration = formulation.configuration(
        formulation.start_point(low_discrepancy_point(trial, formulation.num_variables(), 9)));
    const DirectionModel model(problem, formulation, configuration);
    const std::vector<ConeMaximum> maxima = cone_maxima(problem, formulation, configuration);
    REQUIRE_FALSE(maxima.empty());
    INFO("trial " << trial);
    for (const ConeMaximum& maximum : maxima) {
      const Vector3d d = model.encounter.contact.R_EB.transpose() * maximum.scenario.direction;
      const Eigen::Vector2d c = model.coordinates(d);
      CHECK(model.value(c) == Approx(maximum.value).epsilon(1e-12));
      for (const double step : {1e-2, 1e-3, 1e-4}) {
        for (int i = 0; i < 16; ++i) {
          const Eigen::Vector2d side(std::cos(M_PI / 8 * i), std::sin(M_PI / 8 * i));
          const double length = step * model.half_angle;
          CHECK(model.value(model.project(c + length * side)) <= maximum.value * (1 + 1e-13));
        }
      }
    }
  }
}

TEST_CASE("maxima over one cone do not depend on the cones before") {
  Random random(37);
  const RobotModel robot = random_robot(random, 7, false);
  CaptureProblem round = tumbling_problem(random, robot);
  CaptureProblem wedge = point_mass_problem(robot, random.unit_vector());
  wedge.uncertainty.cone_plane_normal = wedge.impulse.direction->unitOrthogonal();
  for (int trial = 0; trial < 30; ++trial) {
    CaptureProblem problem = trial % 3 == 2 ? wedge : round;
    problem.uncertainty.cone_half_angle = 0.05 * (1 + trial * 7 % 10);
    const Formulation formulation(problem);
    const Configuration at = formulation.configuration(
        formulation.start_point(low_discrepancy_point(trial, formulation.num_variables(), 9)));
    std::vector<ConeMaximum> alone;  // of a thread that knows of no other cone
    std::thread([&] { alone = cone_maxima(problem, formulation, at); }).join();
    const std::vector<ConeMaximum> maxima = cone_maxima(problem, formulation, at);
    INFO("trial " << trial);
    REQUIRE(maxima.size() == alone.size());
    for (std::size_t i = 0; i < maxima.size(); ++i) {
      CHECK(maxima[i].value == alone[i].value);
      CHECK(maxima[i].scenario.direction == alone[i].scenario.direction);
    }
  }
}

TEST_CASE("a worst direction is stationary to more digits than its value tells") {
  Random random(38);
  for (int trial = 0; trial < 12; ++trial) {
    CaptureProblem problem = tumbling_problem(random, random_robot(random, 7, false));
    problem.uncertainty.cone_half_angle = 0.05 + 0.05 * trial;
    const Formulation formulation(problem);
    const Configuration configuration = formulation.configuration(
        formulation.start_point(low_discrepancy_point(trial, formulation.num_variables(), 9)));
    const DirectionModel model(problem, formulation, configuration);
    const ConeMaximum maximum = cone_maxima(problem, formulation, configuration).front();
    const Vector3d d = model.encounter.contact.R_EB.transpose() * maximum.scenario.direction;
    Vector3d g;
    Matrix3d H;
    REQUIRE(model.log_derivatives(d, g, H));
    // Of a maximum on the rim, where the slope may point outward, the slope along it.
    const bool on_rim = model.coordinates(d).norm() > model.half_angle * (1 - 1e-9);
    const Vector3d along = g - g.dot(d) * d;
    const double slope = on_rim ? g.dot(model.n.cross(d).normalized()) : along.norm();
    INFO("trial " << trial << (on_rim ? ", on the rim" : ""));
    CHECK(std::abs(slope) <= 1e-10 * H.norm());
  }
}

TEST_CASE("the derivatives of ln |y|^2 over the direction are those of its differences") {
  Random random(37);
  for (int trial = 0; trial < 6; ++trial) {
    const CaptureProblem problem =
        trial % 2 == 0 ? point_mass_problem(random_robot(random, 6, false), random.unit_vector())
                       : tumbling_problem(random, random_robot(random, 7, false));
    const Formulation formulation(problem);
    const DirectionModel model(problem, formulation,
                               formulation.configuration(formulation.start_point(
                                   low_discrepancy_point(trial, formulation.num_variables(), 9))));
    Vector3d g, g_up, g_down;
    Matrix3d H, unused;
    REQUIRE(model.log_derivatives(model.n, g, H));
    constexpr double kStep = 1e-5;
    for (int i = 0; i < 3; ++i) {
      const Vector3d h = kStep * Vector3d::Unit(i);
      Eigen::MatrixX3d directions = Eigen::MatrixX3d::Ones(DirectionSquares::kMostLanes, 3);
      directions.row(0) = coordinates_of(model, model.n + h);
      directions.row(1) = coordinates_of(model, model.n - h);
      std::vector<double> squares;
      model.squares(directions, squares);
      CHECK(std::log(squares[0] / squares[1]) / (2 * kStep) ==
            Approx(g[i]).epsilon(1e-7).margin(1e-7));
      REQUIRE(model.log_derivatives(model.n + h, g_up, unused));
      REQUIRE(model.log_derivatives(model.n - h, g_down, unused));
      const Vector3d column = (g_up - g_down) / (2 * kStep);
      CHECK((column - H.col(i)).norm() <= 1e-6 * (1 + H.norm()));
    }
  }
}

}  // namespace stillbase
