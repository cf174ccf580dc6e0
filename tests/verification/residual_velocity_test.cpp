// The measures over the residual velocity: planner against reference, and plans that state them
// wrong.
#include <catch2/catch.hpp>

#include <stillbase/formulation/measures/robust.hpp>
#include <stillbase/planner/planner.hpp>

#include "formulation/measures/measure.hpp"
#include "support/random_capture.hpp"
#include "support/shipped_problem.hpp"
#include "verification/failed_claims.hpp"
#include "verification/objective.hpp"

namespace stillbase {
namespace {

Matrix6d random_covariance(Random& random, double linear, double angular) {
  Matrix6d root;
  for (double& x : root.reshaped()) x = random.normal();
  root.topRows<3>() *= linear;
  root.bottomRows<3>() *= angular;
  return root * root.transpose();
}

/// A latch, planned over its residual velocity.
Plan latch_plan(const std::string& name, RiskMeasure measure) {
  CaptureProblem problem = test::without_path(name);
  Random random(91);
  problem.uncertainty = {};
  problem.uncertainty.residual_velocity.emplace();
  problem.uncertainty.residual_velocity->covariance = random_covariance(random, 1e-3, 2e-3);
  problem.measure = {};
  problem.measure.kind = measure;
  problem.search.starts = 8;
  return make_plan(problem);
}

}  // namespace

TEST_CASE("planner and reference agree on the measures over the residual velocity") {
  using Case = std::pair<ContactLaw, HandVelocity>;
  const auto [law, hand] = GENERATE(Case(ContactLaw::Frictionless, HandVelocity::Rest),
                                    Case(ContactLaw::Sticking, HandVelocity::Rest),
                                    Case(ContactLaw::Latch, HandVelocity::Rest),
                                    Case(ContactLaw::Latch, HandVelocity::MatchNormal),
                                    Case(ContactLaw::Latch, HandVelocity::MatchLinear),
                                    Case(ContactLaw::Latch, HandVelocity::MatchAll),
                                    Case(ContactLaw::Latch, HandVelocity::Stated),
                                    Case(ContactLaw::Sticking, HandVelocity::Stated));
  Random random(92);
  for (int source = 0; source < 3; ++source) {
    const bool moves = hand != HandVelocity::Rest;
    CaptureProblem problem = tumbling_problem(
        random, moves ? random_arm(random, 7) : random_robot(random, 6, source == 1));
    problem.variables.base_position = PositionFreedom::Free;
    problem.impulse.contact = law;
    problem.hand_motion.velocity = hand;
    if (hand == HandVelocity::Stated) problem.hand_motion.linear = Vector3d(0.02, 0.01, 0);
    if (source == 1) problem.hand_motion.rates = ArrivalRates::LeastBaseRate;
    if (law != ContactLaw::Frictionless) problem.impulse.restitution = 0;
    problem.objective = {
        {ObjectiveQuantity::BaseAngularMomentum, 0.7}, {ObjectiveQuantity::TotalAngularMomentum, 2},
        {ObjectiveQuantity::BaseMomentum, 3, 0.5},     {ObjectiveQuantity::ImpulseMagnitude, 5},
        {ObjectiveQuantity::BaseEnergy, 0.1},          {ObjectiveQuantity::JointRateNorm, 0.2}};
    ResidualVelocity& residual = problem.uncertainty.residual_velocity.emplace();
    residual.deviations = 2;
    if (source < 2) {
      residual.covariance = random_covariance(random, 5e-3, 0.01);
      residual.frame = source == 0 ? ResidualFrame::Target : ResidualFrame::Inertial;
    } else {
      problem.target_deviations.emplace();
      problem.target_deviations->orientation = {0.02, 0.03, 0.01};
      problem.target_deviations->linear_velocity.setConstant(2e-3);
      problem.target_deviations->angular_velocity = {4e-3, 6e-3, 2e-3};
      problem.target_deviations->moments = {0.01, 0.02, 0.01};
      residual.linear_tracking = 1e-3;
      residual.angular_tracking = 2e-3;
    }
    const Formulation formulation(problem);
    const Eigen::VectorXd x =
        formulation.start_point(low_discrepancy_point(source, formulation.num_variables(), 3));
    const Configuration at = formulation.configuration(x);
    const verification::Situation situation(problem, at);
    const verification::ResidualCase found = verification::residual_case(situation);
    const ResidualSummary stated = summarize_residual(problem, formulation, at);
    INFO("contact law " << static_cast<int>(law) << ", hand " << static_cast<int>(hand)
                        << ", source " << source);
    const double speed = situation.event.velocity->norm();
    CHECK((stated.velocity - found.velocity).norm() < 1e-9 * speed);
    CHECK((stated.covariance - found.covariance).norm() < 1e-8 * found.covariance.norm());
    CHECK(stated.separating == Approx(found.separating).epsilon(0).margin(1e-9));
    CHECK(found.distance(stated.worst_velocity) == Approx(1).epsilon(1e-6));
    const double tolerance = verification::objective_tolerance(problem, 1e-9);
    for (const RiskMeasure kind : {RiskMeasure::Expectation, RiskMeasure::WorstCase}) {
      problem.measure.kind = kind;
      CHECK(verification::measure_value(situation, 0) ==
            Approx(Measure(problem, formulation).reported(x)).epsilon(tolerance));
    }
    const auto largest = verification::largest_square(found);
    CHECK(largest.bound >= largest.value);
    CHECK(largest.bound == Approx(largest.value).epsilon(1e-9));
  }
}

TEST_CASE("the largest square over an ellipsoid and its bound are one, in the hard case too") {
  Random random(93);
  for (int trial = 0; trial < 50; ++trial) {
    verification::ResidualCase residual;
    residual.form = random_covariance(random, 1, 1);
    residual.covariance = random_covariance(random, 1e-3, 2e-3);
    residual.deviations = 3;
    if (trial % 2 == 1) residual.velocity = 0.01 * Vector6d::Unit(trial % 6);
    residual.nominal = residual.velocity.dot(residual.form * residual.velocity);
    const auto largest = verification::largest_square(residual);
    CHECK(largest.bound == Approx(largest.value).epsilon(1e-8));
    CHECK(residual.distance(largest.velocity) == Approx(1));
    if (trial % 2 == 1) continue;
    // Vbar = 0: k^2 times the largest eigenvalue of form Sigma.
    const double eigenvalue = (residual.form * residual.covariance).eigenvalues().real().maxCoeff();
    CHECK(largest.value == Approx(9 * eigenvalue).epsilon(1e-8));
  }
}

TEST_CASE("equally bad velocities are isolated unless they form a curve") {
  verification::ResidualCase residual;
  residual.form = Matrix6d::Identity();
  residual.deviations = 2;
  residual.covariance.diagonal() << 4, 1, 1, 1, 1, 0;
  const auto ends = verification::local_maxima(residual);
  CHECK(residual.square(residual.at(ends[0])) == Approx(16));
  CHECK(residual.square(residual.at(ends[1])) == Approx(16));
  CHECK((ends[0] + ends[1]).norm() < 1e-9);
  CHECK(verification::is_isolated(residual, ends[0]));
  // Off the middle one end is worse, the other stays a local maximum.
  residual.velocity[0] = 0.1;
  residual.nominal = 0.01;
  const auto apart = verification::local_maxima(residual);
  CHECK(residual.square(residual.at(apart[0])) == Approx(4.1 * 4.1));
  CHECK(residual.square(residual.at(apart[1])) == Approx(3.9 * 3.9));
  residual.velocity.setZero();
  residual.nominal = 0;
  residual.covariance(1, 1) = 4;
  CHECK_FALSE(verification::is_isolated(residual, verification::local_maxima(residual).front()));
}

TEST_CASE("a plan says that its relative velocity is stated better than its target is known") {
  CaptureProblem problem = test::without_path("servicer_latch");
  problem.uncertainty = {};
  problem.search.starts = 4;
  problem.target_deviations.emplace().linear_velocity.setConstant(3e-4);
  ResidualVelocity& residual = problem.uncertainty.residual_velocity.emplace();
  residual.covariance = 1e-4 * Matrix6d::Identity();
  CHECK(make_plan(problem).warnings.empty());
  residual.covariance = 9e-9 * Matrix6d::Identity();
  Plan plan = make_plan(problem);
  REQUIRE(plan.warnings.size() == 1);
  CHECK(plan.warnings.front().code == "narrow-residual");
  CHECK_THAT(plan.warnings.front().message,
             Catch::StartsWith("uncertainty.residual_velocity: in some direction"));
  // sqrt(9e-9) / 3e-4: the velocity alone is not known, and it does not change until the contact.
  CHECK_THAT(plan.warnings.front().message, Catch::Contains("standard deviation is 0.316 of"));
  CHECK(failures(plan) == "");
  plan.warnings.clear();
  CHECK(failures(plan) == "residual_warning ");
}

TEST_CASE("the rounding of a covariance without rank is no smaller deviation") {
  CaptureProblem problem = test::without_path("servicer_latch");
  problem.uncertainty = {};
  problem.search.starts = 4;
  auto& target = problem.target_deviations.emplace();
  target.linear_velocity.setConstant(5e-7);
  target.angular_velocity.setConstant(3e-7);
  Random random(93);
  Matrix6d root;
  for (double& x : root.reshaped()) x = random.normal();
  root.col(5).setZero();
  problem.uncertainty.residual_velocity.emplace().covariance = root * root.transpose();
  const Plan plan = make_plan(problem);
  CHECK(plan.warnings.empty());
  CHECK(failures(plan) == "");
}

TEST_CASE("a zero of wide residual velocities has the rounding of the widest") {
  CaptureProblem problem = test::without_path("iiwa_client_50");
  problem.uncertainty = {};
  problem.measure = {};
  problem.search.starts = 8;
  Random random(94);
  for (int draw = 0; draw < 3; ++draw) {
    problem.uncertainty.residual_velocity.emplace().covariance =
        random_covariance(random, 3e2, 3e2);
    const Plan plan = make_plan(problem);
    REQUIRE(plan.objective.nominal < 1e-9);
    CHECK(failures(plan) == "");
  }
}

TEST_CASE("a plan says what of its stated uncertainty the measure does not count") {
  CaptureProblem problem = test::without_path("servicer_latch");
  problem.uncertainty = {};
  problem.search.starts = 4;
  problem.target_deviations.emplace().linear_velocity.setConstant(3e-4);
  const auto codes = [](const Plan& plan) {
    std::string out;
    for (const PlanWarning& warning : plan.warnings) {
      out += warning.code + " " + warning.message.substr(0, warning.message.find(':')) + "\n";
    }
    return out;
  };
  const Plan unused = make_plan(problem);
  CHECK(codes(unused) == "unused-covariance target.state.covariance\n");
  CHECK(failures(unused) == "");

  problem.uncertainty.residual_velocity.emplace().angular_tracking = 1e-3;
  problem.uncertainty.target_mass = 0.1;
  problem.uncertainty.joint_position = JointVectord::Constant(problem.robot.n(), 0.01);
  CHECK(codes(make_plan(problem)).empty());  // the measure is the nominal one
  problem.measure.kind = RiskMeasure::Expectation;
  problem.measure.samples = 100;
  const Plan mean = make_plan(problem);
  CHECK(codes(mean) ==
        "not-in-measure uncertainty.target_mass\nnot-in-measure uncertainty.joint_position\n"
        "not-in-measure objective.samples\n");
  CHECK(failures(mean) == "");

  for (Plan silent : {unused, mean}) {
    silent.warnings.erase(silent.warnings.begin());
    CHECK(failures(silent) == "unused_uncertainty ");
  }
  Plan loud = mean;
  loud.warnings.push_back(unused.warnings.front());
  CHECK(failures(loud) == "unused_uncertainty ");
}

TEST_CASE("a measure that vanishes where nothing is uncertain passes") {
  CaptureProblem problem = test::without_path("servicer_latch");
  problem.uncertainty = {};
  problem.uncertainty.residual_velocity.emplace().covariance = Matrix6d::Zero();
  problem.measure.kind = RiskMeasure::Expectation;
  problem.search.starts = 8;
  const Plan plan = make_plan(problem);
  CHECK(plan.objective.value < 1e-9);
  CHECK(failures(plan) == "");
}

TEST_CASE("a plan that states its residual velocity or its measure wrong fails") {
  const RiskMeasure measure = GENERATE(RiskMeasure::Expectation, RiskMeasure::WorstCase);
  const std::string name = GENERATE("servicer_latch", "matched_light");
  const Plan plan = latch_plan(name, measure);
  REQUIRE(plan.objective.residual);
  CHECK(plan.objective.value > plan.objective.nominal);
  CHECK(plan.certificate.proof.status == ProofStatus::NotApplicable);
  REQUIRE(failures(plan) == "");

  const auto failing = [&plan](auto&& change) {
    Plan other = plan;
    change(other, *other.objective.residual);
    return failures(other);
  };
  using Catch::Contains;
  CHECK_THAT(failing([](Plan&, ResidualSummary& r) { r.covariance *= 1.001; }),
             Contains("residual_covariance"));
  CHECK_THAT(failing([](Plan&, ResidualSummary& r) { r.velocity[0] += 1e-5; }),
             Contains("residual_mean"));
  CHECK_THAT(failing([](Plan&, ResidualSummary& r) { r.deviations = 2; }),
             Contains("residual_deviations"));
  CHECK_THAT(failing([](Plan&, ResidualSummary& r) { r.separating += 1e-3; }),
             Contains("residual_separating"));
  CHECK_THAT(failing([](Plan&, ResidualSummary& r) { r.worst_velocity *= 1.1; }),
             Contains("worst_velocity") && Contains("objective_worst_case"));
  CHECK_THAT(failing([](Plan& p, ResidualSummary& r) {
               r.worst_velocity = r.velocity;
               p.objective.worst_case = p.objective.nominal;
             }),
             Contains("worst_case_bound"));
  CHECK_THAT(failing([](Plan& p, ResidualSummary&) { p.objective.residual.reset(); }),
             Contains("residual_velocity"));
  CHECK_THAT(failing([](Plan& p, ResidualSummary&) { p.objective.value *= 1 - 1e-5; }),
             Contains("objective_value"));
  CHECK_THAT(failing([](Plan& p, ResidualSummary&) {
               for (Candidate& candidate : p.candidates) candidate.value *= 1 - 1e-4;
             }),
             Contains("candidates_value"));
}

}  // namespace stillbase
