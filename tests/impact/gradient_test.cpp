#include <catch2/catch.hpp>

#include <stillbase/core/random.hpp>
#include <stillbase/impact/gradient.hpp>

#include "impact/random_resistance.hpp"
#include "support/autodiff_kernel.hpp"
#include "support/coupled_robot.hpp"
#include "support/random_robot.hpp"

namespace stillbase {
namespace {

JointVectord random_joints(Random& random, int n, double range) {
  JointVectord phi(n);
  for (int k = 0; k < n; ++k) phi[k] = random.uniform(-range, range);
  return phi;
}

Vector6d random_wrench(Random& random) {
  Vector6d F;
  F << random.unit_vector(), 0.3 * random.unit_vector();
  return F;
}

template <class S>
S weighted_sum(const ImpactResponse<S>& response, const ResponseWeights<double>& weights) {
  return response.omega().dot(weights.omega.template cast<S>()) +
         response.base.dot(weights.base.template cast<S>()) +
         response.total.dot(weights.total.template cast<S>()) +
         response.hand_inverse_mass * S(weights.hand_inverse_mass);
}

template <class S>
S weighted_momentum_and_rates(const PostureImpact<S>& posture, const ImpactResponse<S>& response,
                              const ResponseWeights<double>& weights) {
  const Vector6<S> momentum = posture.inertia.H_b * response.d.Delta_Omega;
  const JointVector<S> u = weights.phidot.template cast<S>();
  return momentum.dot(weights.momentum.template cast<S>()) + response.d.Delta_phidot.dot(u);
}

ResponseWeights<double> random_weights(Random& random) {
  ResponseWeights<double> weights;
  weights.omega = random.unit_vector();
  weights.base = random.unit_vector();
  weights.total = random.unit_vector();
  weights.hand_inverse_mass = random.uniform(-1, 1);
  return weights;
}

}  // namespace

TEST_CASE("the adjoint gradient of a robot with coupled joints agrees, too") {
  Random random(17);
  for (int trial = 0; trial < 60; ++trial) {
    const RobotModel robot =
        with_couplings(random_robot(random, 2 + random.index(9), trial % 2 == 0), random);
    const int n = robot.n();
    const JointVectord phi = random_joints(random, n, 1);
    const Vector6d F = random_wrench(random);
    const ImpactResistance resistance = random_resistance(random, n);
    ResponseWeights<double> weights = random_weights(random);
    const auto posture = evaluate_posture<double>(robot, resistance, phi);
    const auto response = respond<double>(posture, F);
    const auto gradient = response_gradient<double>(robot, posture, response, weights);
    const auto dual_posture = evaluate_posture<Dual>(robot, resistance, independent(phi));
    const Dual psi = weighted_sum(respond<Dual>(dual_posture, F.cast<Dual>()), weights);
    CHECK(weighted_sum(response, weights) == Approx(psi.value()).epsilon(1e-12));
    const double scale = 1 + psi.derivatives().cwiseAbs().maxCoeff();
    CHECK((gradient.phi - psi.derivatives()).cwiseAbs().maxCoeff() < 1e-10 * scale);
  }
}

TEST_CASE("the adjoint gradient over joints agrees with automatic differentiation") {
  Random random(7);
  for (int trial = 0; trial < 60; ++trial) {
    const int n = 2 + random.index(9);
    const RobotModel robot = random_robot(random, n, trial % 2 == 0);
    const JointVectord phi = random_joints(random, n, 2);
    const Vector6d F = random_wrench(random);
    const ImpactResistance resistance = random_resistance(random, n);
    const ResponseWeights<double> weights = random_weights(random);

    const auto posture = evaluate_posture<double>(robot, resistance, phi);
    const auto response = respond<double>(posture, F);
    const auto gradient = response_gradient<double>(robot, posture, response, weights);

    const auto dual_posture = evaluate_posture<Dual>(robot, resistance, independent(phi));
    const Dual psi = weighted_sum(respond<Dual>(dual_posture, F.cast<Dual>()), weights);

    CHECK(weighted_sum(response, weights) == Approx(psi.value()).epsilon(1e-12));
    const double scale = 1 + psi.derivatives().cwiseAbs().maxCoeff();
    CHECK((gradient.phi - psi.derivatives()).cwiseAbs().maxCoeff() / scale < 1e-11);
  }
}

TEST_CASE("base momentum and joint rates have exact adjoint gradients") {
  Random random(17);
  for (int trial = 0; trial < 30; ++trial) {
    const int n = 2 + random.index(9);
    const RobotModel robot = random_robot(random, n, trial % 2 == 0);
    const JointVectord phi = random_joints(random, n, 2);
    const Vector6d F = random_wrench(random);
    const ImpactResistance resistance = random_resistance(random, n);
    ResponseWeights<double> weights;
    weights.momentum << random.unit_vector(), random.unit_vector();
    weights.phidot = random_joints(random, n, 1);

    const auto posture = evaluate_posture<double>(robot, resistance, phi);
    const auto response = respond<double>(posture, F);
    const auto gradient = response_gradient<double>(robot, posture, response, weights);
    const auto dual_posture = evaluate_posture<Dual>(robot, resistance, independent(phi));
    const Dual psi = weighted_momentum_and_rates(
        dual_posture, respond<Dual>(dual_posture, F.cast<Dual>()), weights);
    const double scale = 1 + psi.derivatives().cwiseAbs().maxCoeff();
    CHECK((gradient.phi - psi.derivatives()).cwiseAbs().maxCoeff() / scale < 1e-11);
    // Linear in the wrench: the gradient over it gives the value back.
    CHECK(gradient.F.dot(F) ==
          Approx(weighted_momentum_and_rates(posture, response, weights)).epsilon(0).margin(1e-12));
  }
}

TEST_CASE("the gradient over the wrench is exact for linear and quadratic parts") {
  Random random(8);
  for (int trial = 0; trial < 40; ++trial) {
    const int n = 2 + random.index(7);
    const RobotModel robot = random_robot(random, n, trial % 2 == 0);
    const ImpactResistance resistance = random_resistance(random, n);
    const ResponseWeights<double> weights = random_weights(random);
    const Vector6d F = random_wrench(random);
    const auto posture = evaluate_posture<double>(robot, resistance, random_joints(random, n, 2));
    const auto gradient =
        response_gradient<double>(robot, posture, respond<double>(posture, F), weights);
    for (int i = 0; i < 6; ++i) {
      // psi is quadratic in F: a central difference of any step is exact.
      const Vector6d step = Vector6d::Unit(i);
      const double difference = (weighted_sum(respond<double>(posture, F + step), weights) -
                                 weighted_sum(respond<double>(posture, F - step), weights)) /
                                2;
      CHECK(gradient.F[i] == Approx(difference).epsilon(1e-10).margin(1e-11));
    }
  }
}

}  // namespace stillbase
