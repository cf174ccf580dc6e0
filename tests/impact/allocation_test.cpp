// The hot path stays off the heap.
#include <catch2/catch.hpp>

#include <stillbase/core/random.hpp>
#include <stillbase/dynamics/bias.hpp>
#include <stillbase/dynamics/momentum.hpp>
#include <stillbase/impact/batch.hpp>
#include <stillbase/impact/contact_response.hpp>

#include "support/count_allocations.hpp"
#include "support/random_robot.hpp"

namespace stillbase {
namespace {

template <class F>
long allocations_in(const F& f) {
  const long before = allocation_count;
  f();
  return allocation_count - before;
}

}  // namespace

TEST_CASE("the allocation counter counts the heap of the standard library and of Eigen") {
  if (!kCountsAllocations) {
    WARN("allocations are not counted in this build");
    return;
  }
  CHECK(allocations_in([] {
          int* volatile escaped = new int(1);  // an unseen pair of new and delete may be left out
          delete escaped;
        }) == 1);
  CHECK(allocations_in([] {
          Eigen::VectorXd x = Eigen::VectorXd::Zero(7);
          double* volatile escaped = x.data();
          *escaped = 1;
        }) == 1);
}

TEST_CASE("a jump and its gradient do not allocate") {
  Random random(3);
  for (const int n : {1, 7, 12}) {
    const RobotModel robot = random_robot(random, n, n == 12);
    const JointVectord phi = JointVectord::Constant(n, 0.3);
    const Vector6d F = Vector6d::LinSpaced(-1, 1);
    ResponseWeights<double> weights;
    weights.omega = weights.base = weights.total = Vector3d::Ones();
    weights.hand_inverse_mass = 0.5;
    for (const bool locked : {false, true}) {
      ImpactResistance resistance{JointVectord::Zero(n), {}};
      if (locked) resistance.locked.assign(static_cast<std::size_t>(n), true);
      double sum = 0;
      const long count = allocations_in([&] {
        const auto posture = evaluate_posture<double>(robot, resistance, phi);
        const auto response = respond<double>(posture, F);
        const auto gradient = response_gradient<double>(robot, posture, response, weights);
        const auto column = coupling_column_gradient<double>(robot, posture, 0, weights.base);
        sum = gradient.phi.sum() + column.sum();
      });
      CHECK(count == 0);
      CHECK(std::isfinite(sum));
    }
  }
}

TEST_CASE("a sticking contact or a latch and its gradient do not allocate") {
  Random random(6);
  const RobotModel robot = random_robot(random, 7, true);
  const JointVectord phi = JointVectord::Constant(7, 0.3);
  const ImpactResistance resistance{JointVectord::Zero(7), {}};
  ResponseWeights<double> weights;
  weights.base = weights.total = Vector3d::Ones();
  weights.momentum.setOnes();
  for (const ContactLaw law : {ContactLaw::Sticking, ContactLaw::Latch}) {
    RigidContact<double> contact;
    contact.law = law;
    contact.target = {0.02,
                      Matrix3d::Identity(),
                      Matrix3d::Identity(),
                      Vector3d::UnitX(),
                      Vector3d::UnitY(),
                      Vector3d::UnitZ()};
    double sum = 0;
    const long count = allocations_in([&] {
      const auto posture = evaluate_posture<double>(robot, resistance, phi);
      const auto response = respond_to_contact<double>(posture, contact);
      const auto gradient = contact_gradient<double>(robot, posture, contact, response, weights);
      sum = gradient.phi.sum();
    });
    CHECK(count == 0);
    CHECK(std::isfinite(sum));
  }
}

TEST_CASE("inertia, Jacobian, bias and momentum do not allocate") {
  Random random(4);
  const RobotModel robot = random_robot(random, 7, true);
  const JointVectord phi = JointVectord::Constant(7, -0.4);
  const JointVectord phidot = JointVectord::LinSpaced(7, -1, 1);
  const Vector6d Omega = Vector6d::LinSpaced(-1, 1);
  double sum = 0;
  const long count = allocations_in([&] {
    const auto kinematics = compute_kinematics<double>(robot, phi);
    const auto inertia = compute_inertia(robot, kinematics);
    const auto tilde = compute_tilde_inertia(inertia);
    const auto jacobian = compute_hand_jacobian(robot, kinematics);
    const auto hat = compute_hat_inertia(inertia, jacobian);
    const auto bias = compute_bias<double>(robot, kinematics, inertia, Omega, phidot);
    const auto tilde_bias = compute_tilde_bias(inertia, bias);
    const auto momentum = compute_momentum<double>(inertia, tilde, Omega, phidot);
    sum = hat.Hhat_phi.sum() + compute_hat_bias(inertia, bias).sum() + momentum.L_g.sum() +
          tilde_bias.ctilde_phi.sum() + free_floating_base_velocity<double>(inertia, phidot).sum();
  });
  CHECK(count == 0);
  CHECK(std::isfinite(sum));
}

TEST_CASE("a posture weighs less than 28 kB") {
  STATIC_REQUIRE(sizeof(PostureImpact<double>) < 28 * 1024);
}

TEST_CASE("a batch does not allocate when its results have their size") {
  Random random(5);
  for (const int n : {7, 20}) {
    const RobotModel robot = random_robot(random, n, true);
    const ImpactResistance free_joints{JointVectord::Zero(n), {}};
    ImpactBatch batch;
    batch.phi.setConstant(11, n, 0.3);
    batch.F.setConstant(11, 6, 0.5);
    ImpactBatchValues values;
    BatchObjectiveValues objective;
    BatchObjective wanted;
    wanted.add(ResponsePart::BaseAngularMomentum, 1);
    const auto evaluate = [&] {
      evaluate_postures(robot, free_joints, batch, values);
      evaluate_objective(robot, free_joints, batch, wanted, true, objective);
    };
    evaluate();
    CHECK(allocations_in(evaluate) == 0);
    CHECK(std::isfinite(objective.gradient.sum()));
  }
}

}  // namespace stillbase
