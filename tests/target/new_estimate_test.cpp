// Estimates that follow each other: tables of motion and predictions that take them in place.
#include <catch2/catch.hpp>

#include <stillbase/core/random.hpp>

#include "target/contact_predictor.hpp"

namespace stillbase {
namespace {

TargetBody brick() {
  TargetBody body;
  body.name = "brick";
  body.mass = 120;
  body.inertia = Vector3d(45, 40, 22).asDiagonal();
  return body;
}

TargetState some_state(Random& random) {
  TargetState state;
  state.time = random.uniform(-5, 20);
  state.pose.position = 3 * random.unit_vector();
  state.pose.orientation = rotation_exp(2 * random.unit_vector());
  state.linear_velocity = 0.05 * random.unit_vector();
  state.angular_velocity = random.uniform(0, 0.1) * random.unit_vector();
  return state;
}

const ContactFeature kPlace{"place", {0.5, 0.1, 0.3}, {1, 0, 0}};

}  // namespace

TEST_CASE("a table of motion that takes a new estimate is the motion of that estimate") {
  Random random(5);
  MotionTable table;
  table.body = brick();
  for (int trial = 0; trial < 20; ++trial) {
    TargetState estimate = some_state(random);
    if (trial % 5 == 0) estimate.angular_velocity.setZero();
    const double horizon = random.uniform(1, 80);
    table.restart(estimate, horizon);
    table.expand();
    const TargetMotion motion(brick(), estimate, horizon);
    for (const double part : {-1.0, -0.3, 0.0, 0.7, 1.0}) {
      const double time = estimate.time + part * horizon;
      const TargetState a = table.state(time), b = motion.state(time);
      CHECK(a.pose.orientation.coeffs() == b.pose.orientation.coeffs());
      CHECK(a.pose.position == b.pose.position);
      CHECK(a.angular_velocity == b.angular_velocity);
      CHECK(table.contact(kPlace, time).velocity == motion.contact(kPlace, time).velocity);
      CHECK(a.angular_velocity.norm() <= table.largest_rate(estimate) * (1 + 1e-9));
    }
  }
}

// Steps of the integrator, of order 8, know nothing of the series.
TEST_CASE("series of the attitude end where steps of the integrator do") {
  Random random(6);
  for (int trial = 0; trial < 20; ++trial) {
    MotionTable table;
    table.body = brick();
    const double widest = random.uniform(0.5, 1);  // I_3 <= I_1 + I_2; near it poles are near
    table.body.inertia = Vector3d(1, 1 + widest, 1 + 2 * widest).asDiagonal();
    const TargetState estimate = some_state(random);
    const double horizon = random.uniform(1, 80);
    table.restart(estimate, horizon);
    REQUIRE(table.nodes.size() > 1);
    std::vector<double> times;
    for (int k = 0; k < 20; ++k) times.push_back(estimate.time + random.uniform(-1, 1) * horizon);
    std::vector<TargetState> by_steps;
    for (const double time : times) by_steps.push_back(table.state(time));
    table.expand();
    REQUIRE(table.series.size() == table.nodes.size());
    for (std::size_t k = 0; k < times.size(); ++k) {
      const TargetState by_series = table.state(times[k]);
      CHECK((by_series.pose.orientation.coeffs() - by_steps[k].pose.orientation.coeffs()).norm() <
            1e-15);
      CHECK((by_series.angular_velocity - by_steps[k].angular_velocity).norm() < 1e-15);
    }
  }
}

TEST_CASE("predictions in place are those of predict_contact") {
  Random random(6);
  EstimateDeviations of_body;
  of_body.mass = 0.05;
  of_body.moments << 0.02, 0.04, 0.01;
  ContactPredictor predictor(brick(), kPlace, 60, of_body);
  for (const bool is_diagonal : {true, false}) {
    const TargetState state = some_state(random);
    StateCovariance root = StateCovariance::Zero();
    root.diagonal() << 0.02, 0.01, 0.03, 0.01, 0.02, 0.01, 1e-3, 2e-3, 1e-3, 5e-4, 8e-4, 2e-4;
    if (!is_diagonal) {
      for (int i = 0; i < 12; ++i) {
        for (int j = 0; j < i; ++j) root(i, j) = 0.3 * random.uniform(-1, 1) * root(i, i);
      }
    }
    const StateCovariance covariance = root * root.transpose();
    EstimateCovariance all = covariance_of(of_body);
    all.topLeftCorner<12, 12>() = covariance;
    const std::vector<double> times{state.time + 5, state.time + 60};
    const auto wanted = predict_contact({brick(), state}, all, kPlace, times);
    std::vector<ContactPrediction> found(2);
    for (std::size_t i = 0; i < 2; ++i) found[i].time = times[i];
    REQUIRE(predictor.predict(state, covariance, found));
    for (std::size_t i = 0; i < 2; ++i) {
      const Eigen::VectorXd sigma = wanted[i].spread.diagonal().cwiseSqrt();
      const Eigen::MatrixXd scale = sigma * sigma.transpose();
      const Eigen::MatrixXd apart = found[i].spread - wanted[i].spread;
      for (int a = 0; a < kNumContactQuantities; ++a) {
        for (int b = 0; b < kNumContactQuantities; ++b) {
          CHECK(std::abs(apart(a, b)) <= 1e-6 * scale(a, b) + 1e-15);
        }
      }
      CHECK((found[i].value - wanted[i].value).norm() < 1e-9);
    }
  }
}

TEST_CASE("a predictor refuses what is no covariance and rotations that it has no room for") {
  Random random(7);
  std::vector<ContactPrediction> out(1);
  TargetState state = some_state(random);
  state.angular_velocity = Vector3d(0.1, 0, 0.1);
  out[0].time = state.time + 100;
  ContactPredictor predictor(brick(), kPlace, 60);
  StateCovariance covariance = 1e-8 * StateCovariance::Identity();
  CHECK(predictor.predict(state, covariance, out));
  covariance(0, 0) = -1;
  CHECK_FALSE(predictor.predict(state, covariance, out));
  covariance(0, 0) = std::nan("");
  CHECK_FALSE(predictor.predict(state, covariance, out));
  covariance = 1e-8 * StateCovariance::Identity();
  covariance(0, 1) = covariance(1, 0) = 1e-4;
  CHECK_FALSE(predictor.predict(state, covariance, out));
  covariance.setIdentity();  // rates off by 1 rad/s
  CHECK_FALSE(predictor.predict(state, covariance, out));
}

}  // namespace stillbase
