// The encounter against formulas of the target room, differences, and the formulation.
#include <catch2/catch.hpp>

#include <cmath>

#include <stillbase/core/error.hpp>
#include <stillbase/dynamics/kinematics.hpp>
#include <stillbase/encounter/encounter.hpp>
#include <stillbase/encounter/target_motion.hpp>
#include <stillbase/formulation/measures/robust.hpp>
#include <stillbase/plan/feature.hpp>

#include "encounter/encounter_kernel.hpp"
#include "support/capture_problems.hpp"
#include "support/dense.hpp"

namespace stillbase {
namespace {

CaptureProblem some_tumbling_problem(unsigned seed) {
  Random random(seed);
  return tumbling_problem(random, random_robot(random, 5, false));
}

Configuration some_configuration(const CaptureProblem& problem, Random& random) {
  Configuration out{problem.start, problem.base, random.uniform(0, 5)};
  for (Eigen::Index k = 0; k < out.phi.size(); ++k) out.phi[k] = random.uniform(-3, 3);
  out.base.orientation = rotation_exp(3 * random.uniform() * random.unit_vector());
  out.base.position = random.unit_vector();
  return out;
}

Matrix3d attitude(const Configuration& at) { return at.base.orientation.toRotationMatrix(); }

/// Velocity of the contact point along n after a unit impulse along n, from the balance of
/// momentum and of angular momentum about the centroid.
double point_speed_per_impulse(const TargetBody& body, const Vector3d& r, const Vector3d& n) {
  const Vector3d omega = test::solve(body.inertia, r.cross(n));
  return n.dot(n / body.mass + omega.cross(r));
}

}  // namespace

TEST_CASE("a stated direction and moment are those of the problem, seen from the base") {
  Random random(1);
  CaptureProblem problem = some_tumbling_problem(1);
  problem.impulse.source = ImpulseSource::Given;
  problem.impulse.magnitude = 2.5;
  problem.impulse.direction = random.unit_vector();
  problem.impulse.moment = random.unit_vector();
  const Configuration at = some_configuration(problem, random);
  for (const Frame frame : {Frame::Base, Frame::Inertial}) {
    problem.impulse.direction_frame = frame;
    const Matrix3d R_B =
        frame == Frame::Base ? Matrix3d(Matrix3d::Identity()) : Matrix3d(attitude(at).transpose());
    const Encounter<double> found = encounter_at(encounter_model(problem), at);
    CHECK(found.F.head<3>().isApprox(R_B * *problem.impulse.direction, 1e-14));
    CHECK(found.F.tail<3>().isApprox(R_B * problem.impulse.moment / 2.5, 1e-14));
    const ImpactSummary impact = impact_at(problem, at);
    CHECK(impact.Fbar.isApprox(2.5 * found.F, 1e-14));
  }
}

TEST_CASE("direction, closing speed and contact point are those of the tumbling feature") {
  Random random(2);
  for (int i = 0; i < 20; ++i) {
    const CaptureProblem problem = some_tumbling_problem(10 + static_cast<unsigned>(i));
    const Configuration at = some_configuration(problem, random);
    const ContactState exact = TargetMotion(*problem.target, problem.target_state, 10)
                                   .contact(chosen_feature(problem), at.contact_time);
    const EncounterModel model = encounter_model(problem);
    const Encounter<double> found = encounter_at(model, at);
    const Matrix3d R_BN = attitude(at).transpose();
    CHECK(found.F.head<3>().isApprox(R_BN * exact.normal, 1e-12));
    CHECK(found.F.tail<3>().isZero(0));
    CHECK(found.contact.point.isApprox(exact.point, 1e-12));
    CHECK(found.closing_speed == Approx(exact.normal.dot(exact.velocity)).epsilon(1e-10));
    const Vector3d velocity = found.contact.R_EB.transpose() * found.contact.velocity_at(model.r);
    CHECK(velocity.isApprox(R_BN * exact.velocity, 1e-11));
  }
}

TEST_CASE("the target's inverse mass along the impulse is its answer to a unit impulse") {
  Random random(3);
  for (int i = 0; i < 20; ++i) {
    CaptureProblem problem = some_tumbling_problem(40 + static_cast<unsigned>(i));
    TargetBody& body = *problem.target;
    const Matrix3d turn = rotation_exp(2 * random.unit_vector()).toRotationMatrix();
    body.inertia = turn * body.inertia * turn.transpose();
    const ContactFeature feature = body.features.front();
    const Configuration at = some_configuration(problem, random);
    const EncounterModel model = encounter_model(problem);
    const Encounter<double> rigid = encounter_at(model, at);
    const double exact = point_speed_per_impulse(body, feature.point, feature.normal);
    CHECK(rigid.target_inverse_mass == Approx(exact).epsilon(1e-12));
    CHECK(target_inverse_mass(body.mass, body.inverse_inertia(), feature.point, feature.normal) ==
          Approx(exact).epsilon(1e-12));
    // The same from the target's inverse inertia in B.
    Matrix3d W = Matrix3d::Zero();
    add_target_inverse_inertia(model, rigid.contact, W);
    const Vector3d n = rigid.F.head<3>();
    CHECK(n.dot(W * n) == Approx(exact).epsilon(1e-12));

    problem.impulse.source = ImpulseSource::PointMass;
    const Encounter<double> point = encounter_at(encounter_model(problem), at);
    CHECK(point.target_inverse_mass == Approx(1 / body.mass).epsilon(1e-15));
    CHECK(point.closing_speed == Approx(rigid.closing_speed).epsilon(1e-15));
  }
}

TEST_CASE("an encounter on Tangent has the derivatives that differences show") {
  constexpr double kStep = 1e-5;
  Random random(4);
  for (int i = 0; i < 10; ++i) {
    const CaptureProblem problem = some_tumbling_problem(70 + static_cast<unsigned>(i));
    const EncounterModel model = encounter_model(problem);
    Scenario scenario = nominal_scenario(model);
    scenario.contact_offset = 0.1 * random.unit_vector();
    const Configuration at = some_configuration(problem, random);
    const Matrix3d R_NB = attitude(at);
    const Vector3d turn = random.unit_vector();
    const double time_rate = random.uniform(-1, 1);
    const auto along = [&](double h) {
      const Matrix3d R = R_NB * rotation_exp(h * turn).toRotationMatrix();
      const double time = at.contact_time + h * time_rate;
      return encounter_along<double>(model, contact_kinematics<double>(model, R, time), scenario);
    };
    const Encounter<double> ahead = along(kStep), behind = along(-kStep);

    Matrix3<Tangent> R = R_NB.cast<Tangent>();
    const Matrix3d R_rate = R_NB * skew<double>(turn);
    for (Eigen::Index k = 0; k < 9; ++k) R.data()[k].set_derivative(R_rate.data()[k]);
    const Tangent time(at.contact_time, time_rate);
    const auto contact = contact_kinematics<Tangent>(model, R, time);
    const auto found = encounter_along<Tangent>(model, contact, scenario);
    const auto check = [&](const auto& value, const auto& a, const auto& b) {
      for (Eigen::Index k = 0; k < value.size(); ++k) {
        const double slope = (a.data()[k] - b.data()[k]) / (2 * kStep);
        CHECK(value.data()[k].v == Approx((a.data()[k] + b.data()[k]) / 2).epsilon(0).margin(1e-9));
        CHECK(value.data()[k].derivative() == Approx(slope).epsilon(1e-7).margin(1e-9));
      }
    };
    check(found.F, ahead.F, behind.F);
    check(found.contact.point, ahead.contact.point, behind.contact.point);
    check(found.contact.omega, ahead.contact.omega, behind.contact.omega);
    CHECK(found.closing_speed.derivative() ==
          Approx((ahead.closing_speed - behind.closing_speed) / (2 * kStep))
              .epsilon(1e-7)
              .margin(1e-9));
  }
}

TEST_CASE("rates of an encounter are its derivatives with respect to the contact time") {
  Random random(5);
  for (int i = 0; i < 10; ++i) {
    const CaptureProblem problem = some_tumbling_problem(90 + static_cast<unsigned>(i));
    const EncounterModel model = encounter_model(problem);
    Scenario scenario = nominal_scenario(model);
    scenario.direction = (scenario.direction + 0.3 * random.unit_vector()).normalized();
    const Configuration at = some_configuration(problem, random);
    const auto target = target_kinematics<double>(model, at.contact_time);
    const auto contact = contact_kinematics<double>(model, attitude(at), target);
    const auto rates = contact_rates<double>(model, target, contact);
    const auto exact = contact_kinematics<Tangent>(
        model, Matrix3<Tangent>(attitude(at).cast<Tangent>()), Tangent(at.contact_time, 1));
    const auto encounter = encounter_along<Tangent>(model, exact, scenario);
    for (Eigen::Index k = 0; k < 3; ++k) {
      CHECK(rates.point[k] == Approx(exact.point[k].derivative()).epsilon(0).margin(1e-13));
      CHECK(rates.omega[k] == Approx(exact.omega[k].derivative()).epsilon(0).margin(1e-13));
    }
    // R_EB' = R_EB skew(omega_EB).
    const Matrix3d turn = contact.R_EB * skew<double>(rates.omega_EB);
    for (Eigen::Index k = 0; k < 9; ++k) {
      CHECK(turn.data()[k] == Approx(exact.R_EB.data()[k].derivative()).epsilon(0).margin(1e-13));
    }
    CHECK(closing_speed_rate<double>(model, contact, rates, scenario) ==
          Approx(encounter.closing_speed.derivative()).epsilon(0).margin(1e-13));
  }
}

TEST_CASE("a scenario is the nominal encounter of a problem with its errors put in") {
  Random random(6);
  const CaptureProblem problem = some_tumbling_problem(120);
  const EncounterModel model = encounter_model(problem);
  Configuration at = some_configuration(problem, random);
  at.contact_time = 2;
  Scenario scenario = nominal_scenario(model);
  scenario.closing_speed_offset = 0.01;
  scenario.target_mass_factor = 1.2;
  scenario.target_inertia_factor = 0.7;
  scenario.contact_offset = {0, 0.02, -0.01};
  const auto found = encounter_along<double>(
      model, contact_kinematics<double>(model, attitude(at), 2.5), scenario);

  CaptureProblem changed = problem;
  changed.target->mass *= 1.2;
  changed.target->inertia *= 0.7;
  changed.target->features.front().point += scenario.contact_offset;
  at.contact_time = 2.5;
  const Encounter<double> exact = encounter_at(encounter_model(changed), at);
  CHECK(found.target_inverse_mass == Approx(exact.target_inverse_mass).epsilon(1e-13));
  CHECK(found.closing_speed == Approx(exact.closing_speed + 0.01).epsilon(1e-10));
  CHECK(found.F.head<3>().isApprox(exact.F.head<3>(), 1e-12));
  // The impulse acts beside the hand's origin.
  const Vector3d offset = found.contact.R_EB.transpose() * scenario.contact_offset;
  CHECK(found.F.tail<3>().isApprox(offset.cross(Vector3d(found.F.head<3>())), 1e-12));
}

TEST_CASE("the impact at a configuration is the one that the formulation minimises") {
  Random random(7);
  for (int i = 0; i < 6; ++i) {
    CaptureProblem problem = some_tumbling_problem(140 + static_cast<unsigned>(i));
    problem.impulse.source = i % 2 == 0 ? ImpulseSource::RigidBody : ImpulseSource::PointMass;
    problem.resistance.model = ResistanceModel::RotorInertia;
    problem.resistance.rotor_inertia = JointVectord::Constant(problem.robot.n(), 0.3);
    const Formulation formulation(problem);
    const Configuration at =
        formulation.configuration(formulation.start_point(Eigen::VectorXd::NullaryExpr(
            formulation.num_variables(), [&] { return random.uniform(); })));
    const ImpactSummary impact = impact_at(problem, at);
    nlp::Evaluation here;
    formulation.evaluate_value(formulation.variables(at), here);
    const double size = formulation.objective_unit() * std::sqrt(2 * here.objective);
    CHECK(impact.base.norm() == Approx(size).epsilon(1e-10));
    CHECK(impact.base.norm() == Approx(nominal_value(problem, formulation, at)).epsilon(1e-10));
    for (const ConstraintValue& value : formulation.report(formulation.variables(at))) {
      if (value.name != "closing_speed") continue;
      CHECK(impact.closing_speed == Approx(value.value).epsilon(1e-10));
    }
  }
}

TEST_CASE("another feature of a configuration is the one that touches") {
  Random random(8);
  CaptureProblem problem = some_tumbling_problem(160);
  problem.target->features.push_back({"minus_y", {0, -0.2, 0.1}, -Vector3d::UnitY()});
  Configuration at = some_configuration(problem, random);
  at.feature = "minus_y";
  const ImpactSummary impact = impact_at(problem, at);
  problem.variables.feature = "minus_y";
  at.feature.clear();
  const ImpactSummary same = impact_at(problem, at);
  CHECK(impact.closing_speed == same.closing_speed);
  CHECK(impact.Fbar == same.Fbar);
}

TEST_CASE("the wanted approach axis points against the impulse, at the stated roll") {
  Random random(9);
  CaptureProblem problem = some_tumbling_problem(170);
  problem.hand.approach_axis = random.unit_vector();
  const Configuration at = some_configuration(problem, random);
  const auto axes = [&] {
    const EncounterModel model = encounter_model(problem);
    return wanted_hand_axes<double>(model, attitude(at), encounter_at(model, at).contact.R_EB);
  };
  const Vector3d n = encounter_at(encounter_model(problem), at).F.head<3>();
  const Matrix3d without_roll = axes();
  CHECK((without_roll * problem.hand.approach_axis).isApprox(-n, 1e-12));
  problem.hand.roll = 0.7;
  const Matrix3d roll = rotation_exp(0.7 * n).toRotationMatrix();
  CHECK(axes().isApprox(roll * without_roll, 1e-12));

  problem.hand.orientation = rotation_exp(random.unit_vector());
  const Matrix3d stated = problem.hand.orientation->toRotationMatrix();
  CHECK(axes().isApprox(attitude(at).transpose() * stated, 1e-12));
  problem.hand.frame = Frame::Base;
  CHECK(axes().isApprox(stated, 1e-12));
}

TEST_CASE("a target with a stated direction reaches the hand along it at the contact time") {
  Random random(10);
  CaptureProblem problem = some_tumbling_problem(180);
  problem.impulse.source = ImpulseSource::PointMass;
  problem.impulse.direction = random.unit_vector();
  problem.impulse.closing_speed = 0.3;
  const Configuration at = some_configuration(problem, random);
  const Vector3d hand = random.unit_vector();
  const Vector3d n = at.base.orientation * *problem.impulse.direction;
  const auto motion = encounter_motion(problem, hand, at.base.orientation, 7);
  REQUIRE(motion);
  const ContactState contact = motion->contact(chosen_feature(problem), 7);
  CHECK(contact.point.isApprox(hand, 1e-12));
  CHECK(contact.normal.isApprox(n, 1e-12));
  CHECK(contact.velocity.isApprox(0.3 * n, 1e-12));

  // The same place, seen from the hand and constant in E.
  Configuration stated = at;
  stated.base = problem.base;
  const EncounterModel model = encounter_model(problem);
  const TargetPlacement placement = target_placement(problem, model);
  const auto at_stated = encounter_motion(problem, hand, problem.base.orientation, 7);
  const TargetState state = at_stated->state(7);
  const Matrix3d R_NE = attitude(stated) * encounter_at(model, stated).contact.R_EB.transpose();
  const Matrix3d R_NT = state.pose.orientation.toRotationMatrix();
  CHECK((R_NE * placement.R_ET).isApprox(R_NT, 1e-12));
  CHECK((state.pose.position + R_NT * placement.r).isApprox(hand, 1e-12));
}

TEST_CASE("at the contact the feature is at the hand, wherever the hand is") {
  Random random(11);
  const CaptureProblem problem = some_tumbling_problem(185);
  const Configuration at = some_configuration(problem, random);
  const auto state = target_at_contact(problem, at);
  REQUIRE(state);
  const auto kinematics = compute_kinematics<double>(problem.robot, at.phi);
  CHECK((state->pose * chosen_feature(problem).point)
            .isApprox(at.base * Vector3d(kinematics.r_bh), 1e-12));
  const TargetState nominal = encounter_motion(problem, at)->state(at.contact_time);
  CHECK(state->pose.orientation.coeffs() == nominal.pose.orientation.coeffs());
  CHECK(state->angular_velocity == nominal.angular_velocity);
}

TEST_CASE("encounters without a direction of their own are refused") {
  CaptureProblem problem = some_tumbling_problem(190);
  problem.impulse.direction = Vector3d::UnitX();
  CHECK_THROWS_AS(encounter_model(problem), InputError);  // a rigid body has its own
  problem.impulse.direction.reset();
  problem.variables.feature.clear();
  CHECK_THROWS_AS(encounter_model(problem), InputError);
}

}  // namespace stillbase
