// A hand that moves at the contact, in the search: its rates, their limits, exact derivatives.
#include <catch2/catch.hpp>

#include <stillbase/core/error.hpp>
#include <stillbase/dynamics/inertia.hpp>

#include "collision/planar_robot.hpp"
#include "formulation/formulation_parts.hpp"
#include "formulation/objectives/jump_objective_kernel.hpp"
#include "formulation/some_point.hpp"
#include "support/random_capture.hpp"

namespace stillbase {
namespace {

struct Kind {
  HandVelocity velocity;
  ArrivalRates rates;
  ContactLaw law;
};

CaptureProblem moving_problem(Random& random, const Kind& kind, bool is_planar = false) {
  CaptureProblem problem =
      tumbling_problem(random, is_planar ? test::planar_robot(7) : random_arm(random, 7));
  problem.impulse.restitution = 0;
  problem.impulse.contact = kind.law;
  problem.hand_motion.velocity = kind.velocity;
  problem.hand_motion.rates = kind.rates;
  if (kind.velocity == HandVelocity::Stated) {
    problem.hand_motion.linear = Vector3d(0.01, -0.02, 0.005);
    problem.hand_motion.angular = Vector3d(0.003, 0.002, -0.004);
  }
  for (Joint& joint : problem.robot.joints) joint.max_velocity = 1;
  problem.constraints.joint_rate_max = JointVectord::Constant(7, 0.5);
  problem.objective = {{ObjectiveQuantity::BaseAngularMomentum, 0.7},
                       {ObjectiveQuantity::BaseAngularVelocity, 0.3},
                       {ObjectiveQuantity::TotalAngularMomentum, 2},
                       {ObjectiveQuantity::BaseMomentum, 3, 0.5},
                       {ObjectiveQuantity::JointRateNorm, 0.2}};
  return problem;
}

constexpr Kind kKinds[] = {
    {HandVelocity::MatchNormal, ArrivalRates::LeastJointRate, ContactLaw::Sticking},
    {HandVelocity::MatchNormal, ArrivalRates::LeastBaseRate, ContactLaw::Latch},
    {HandVelocity::MatchLinear, ArrivalRates::LeastBaseRate, ContactLaw::Latch},
    {HandVelocity::MatchAll, ArrivalRates::LeastJointRate, ContactLaw::Latch},
    {HandVelocity::MatchAll, ArrivalRates::LeastBaseRate, ContactLaw::Latch},
    {HandVelocity::Stated, ArrivalRates::LeastJointRate, ContactLaw::Latch},
    {HandVelocity::Stated, ArrivalRates::LeastBaseRate, ContactLaw::Sticking}};

double relative(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  return (a - b).cwiseAbs().maxCoeff() / (1 + b.cwiseAbs().maxCoeff());
}

}  // namespace

TEST_CASE("objective and rows of a moving hand have the gradient of automatic differentiation") {
  const Kind kind = GENERATE(from_range(std::begin(kKinds), std::end(kKinds)));
  Random random(61);
  for (int trial = 0; trial < 4; ++trial) {
    const CaptureProblem problem = moving_problem(random, kind);
    const Formulation formulation(problem);
    const Formulation::Parts& parts = formulation.parts();
    const CaptureModel& model = parts.model;
    const auto& rows = parts.rows.kept;
    const Eigen::VectorXd x = some_point(formulation, trial);
    nlp::Evaluation here;
    formulation.evaluate(x, here);
    Eigen::VectorXd gradient(x.size());
    Eigen::MatrixXd jacobian(static_cast<Eigen::Index>(rows.size()), x.size());
    VectorX<Tangent> along = x.cast<Tangent>();
    for (Eigen::Index i = 0; i < x.size(); ++i) {
      along[i].set_derivative(1);
      const auto at = model.place<Tangent>(along);
      const auto posture = model.posture(at);
      const auto impact = model.impact(at, posture, model.nominal);
      gradient[i] = parts.jump.objective(posture, impact, parts.objective_unit).derivative();
      for (std::size_t k = 0; k < rows.size(); ++k) {
        jacobian(static_cast<Eigen::Index>(k), i) =
            rows[k]->value({model, at, posture, impact}).derivative();
      }
      along[i].set_derivative(0);
    }
    CHECK(relative(here.gradient, gradient) < 1e-9);
    int rates = 0;
    for (std::size_t k = 0; k < rows.size(); ++k) {
      const auto row = static_cast<Eigen::Index>(k);
      INFO(rows[k]->name);
      rates += rows[k]->name.rfind("arrival_rate_", 0) == 0;
      CHECK(relative(here.jacobian.row(row), jacobian.row(row)) < 1e-9);
    }
    CHECK(rates == 7);
  }
}

TEST_CASE("the Hessian with a moving hand is the change of the gradient") {
  const Kind kind = GENERATE(from_range(std::begin(kKinds), std::end(kKinds)));
  Random random(62);
  const Formulation formulation(moving_problem(random, kind));
  const Eigen::VectorXd x = some_point(formulation, 1);
  const Eigen::VectorXd multipliers = Eigen::VectorXd::Ones(formulation.num_constraints());
  Eigen::MatrixXd hessian, expected(x.size(), x.size());
  formulation.lagrangian_hessian(x, 1, multipliers, hessian);
  const auto gradient = [&](const Eigen::VectorXd& at) -> Eigen::VectorXd {
    nlp::Evaluation out;
    formulation.evaluate(at, out);
    return out.gradient + out.jacobian.transpose() * multipliers;
  };
  constexpr double kStep = 1e-5;
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    const Eigen::VectorXd step = kStep * Eigen::VectorXd::Unit(x.size(), i);
    expected.col(i) = (gradient(x + step) - gradient(x - step)) / (2 * kStep);
  }
  CHECK((hessian - expected).cwiseAbs().maxCoeff() < 1e-5 * (1 + expected.cwiseAbs().maxCoeff()));
}

TEST_CASE("a matched hand moves with the target by the least rates, without momentum") {
  const ArrivalRates choice = GENERATE(ArrivalRates::LeastJointRate, ArrivalRates::LeastBaseRate);
  Random random(63);
  for (int trial = 0; trial < 6; ++trial) {
    const CaptureProblem problem =
        moving_problem(random, {HandVelocity::MatchAll, choice, ContactLaw::Latch});
    const Formulation formulation(problem);
    const CaptureModel& model = formulation.parts().model;
    const NominalPoint here(model, some_point(formulation, trial));
    const HandMotion<double>& motion = here.impact.rigid.before;
    const Vector6d V_t = here.impact.rigid.target.velocity_at_hand();
    CHECK((motion.V - V_t).norm() < 1e-9 * V_t.norm());
    CHECK(here.impact.response.F.norm() < 1e-6);
    const InertiaMatrices<double>& inertia = here.posture.inertia;
    const Vector6d momentum = inertia.H_b * motion.Omega + inertia.H_bphi * motion.phidot;
    CHECK(momentum.norm() < 1e-9 * (inertia.H_bphi * motion.phidot).norm());
    // Rates beside these, along the self-motion, are no better.
    const Eigen::MatrixXd Jhat =
        compute_hat_inertia<double>(inertia, here.posture.jacobian).Jhat_phi;
    const Eigen::MatrixXd B = -inertia.H_b.ldlt().solve(Eigen::MatrixXd(inertia.H_bphi));
    const auto cost = [&](const Eigen::VectorXd& phidot) {
      if (choice == ArrivalRates::LeastJointRate) return phidot.squaredNorm();
      return (B.bottomRows(3) * phidot).squaredNorm() + kJointRateWeight * phidot.squaredNorm();
    };
    const Eigen::VectorXd self_motion = Jhat.fullPivLu().kernel().col(0).normalized();
    const Eigen::VectorXd phidot = motion.phidot;
    const double size = phidot.norm();
    CHECK(cost(phidot) < cost(phidot + 0.01 * size * self_motion));
    CHECK(cost(phidot) < cost(phidot - 0.01 * size * self_motion));
  }
}

TEST_CASE("a hand that cannot move as wanted is refused with what it can do") {
  Random random(64);
  const CaptureProblem problem = moving_problem(
      random, {HandVelocity::MatchAll, ArrivalRates::LeastJointRate, ContactLaw::Latch}, true);
  CHECK_THROWS_WITH(Formulation(problem), Catch::Contains("moves the hand in 3 of them"));
}

}  // namespace stillbase
