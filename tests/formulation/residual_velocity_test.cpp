// The measures over the residual velocity: closed forms against samples of the full contact law,
// derivatives against automatic differentiation.
#include <catch2/catch.hpp>

#include <cmath>

#include <stillbase/formulation/measures/robust.hpp>
#include <stillbase/impact/contact_impulse.hpp>
#include <stillbase/impact/indices.hpp>

#include "formulation/formulation_parts.hpp"
#include "formulation/measures/ball_maximum.hpp"
#include "formulation/measures/measure.hpp"
#include "formulation/measures/residual.hpp"
#include "formulation/measures/scenario_program.hpp"
#include "formulation/objectives/jump_objective_kernel.hpp"
#include "formulation/some_point.hpp"
#include "support/random_capture.hpp"

namespace stillbase {
namespace {

/// A covariance of full rank with these deviations of linear and angular components.
Matrix6d random_covariance(Random& random, double linear, double angular) {
  Matrix6d root;
  for (double& x : root.reshaped()) x = random.normal();
  root.topRows<3>() *= linear / std::sqrt(6.0);
  root.bottomRows<3>() *= angular / std::sqrt(6.0);
  return root * root.transpose();
}

EstimateDeviations some_deviations() {
  EstimateDeviations out;
  out.orientation = {0.02, 0.03, 0.01};
  out.linear_velocity.setConstant(2e-3);
  out.angular_velocity = {4e-3, 6e-3, 2e-3};
  out.moments = {0.01, 0.02, 0.01};
  return out;
}

CaptureProblem residual_problem(Random& random, ContactLaw law, double linear = 4e-3,
                                double angular = 0.02) {
  CaptureProblem problem = tumbling_problem(random, random_robot(random, 6, true));
  problem.impulse.contact = law;
  if (law != ContactLaw::Frictionless) problem.impulse.restitution = 0;
  problem.objective = {{ObjectiveQuantity::BaseAngularVelocity}};
  problem.uncertainty.residual_velocity.emplace();
  problem.uncertainty.residual_velocity->covariance = random_covariance(random, linear, angular);
  return problem;
}

/// How the hand moves before a contact.
struct Moving {
  HandVelocity velocity;
  ArrivalRates rates;
  ContactLaw law;
};

constexpr Moving kMoving[] = {
    {HandVelocity::MatchNormal, ArrivalRates::LeastBaseRate, ContactLaw::Latch},
    {HandVelocity::MatchLinear, ArrivalRates::LeastJointRate, ContactLaw::Latch},
    {HandVelocity::MatchAll, ArrivalRates::LeastJointRate, ContactLaw::Latch},
    {HandVelocity::MatchAll, ArrivalRates::LeastBaseRate, ContactLaw::Latch},
    {HandVelocity::Stated, ArrivalRates::LeastBaseRate, ContactLaw::Latch},
    {HandVelocity::Stated, ArrivalRates::LeastJointRate, ContactLaw::Sticking}};

CaptureProblem moving_problem(Random& random, const Moving& moving, double linear = 4e-3,
                              double angular = 0.02) {
  CaptureProblem problem = tumbling_problem(random, random_arm(random, 7));
  problem.impulse.contact = moving.law;
  problem.impulse.restitution = 0;
  problem.hand_motion.velocity = moving.velocity;
  problem.hand_motion.rates = moving.rates;
  if (moving.velocity == HandVelocity::Stated) {
    problem.hand_motion.linear = Vector3d(0.03, -0.01, 0.005);
    problem.hand_motion.angular = Vector3d(0.003, 0.002, -0.004);
  }
  problem.objective = {{ObjectiveQuantity::BaseAngularVelocity}};
  problem.uncertainty.residual_velocity.emplace();
  problem.uncertainty.residual_velocity->covariance = random_covariance(random, linear, angular);
  return problem;
}

/// The base's angular velocity right after a contact, as the contact law has it.
class FullLaw {
 public:
  FullLaw(const CaptureProblem& problem, const Formulation& formulation, const Eigen::VectorXd& x) {
    const CaptureModel& model = formulation.parts().model;
    const auto at = model.place<double>(x);
    posture_ = model.posture(at);
    W_h_ = extended_inverse_inertia(posture_.factor, posture_.jacobian);
    const Matrix3d R_BE = at.contact.R_EB.transpose();
    contact_.law = problem.impulse.contact;
    contact_.restitution = problem.impulse.restitution;
    contact_.n = R_BE * model.encounter.n;
    target_.mass = problem.target->mass;
    target_.inertia = R_BE * problem.target->inertia * R_BE.transpose();
    target_.r = R_BE * model.encounter.r;
    mean_ << R_BE * at.contact.velocity_at(model.encounter.r), R_BE * at.contact.omega;
    Matrix6d turn = Matrix6d::Zero();
    turn.topLeftCorner<3, 3>() = turn.bottomRightCorner<3, 3>() = R_BE;
    root_ = turn * model.residual->at(at.time);
    if (!problem.hand_motion.moves()) return;
    // As the nominal target asks, whatever the errors are.
    const HandMotion<double> before = model.impact(at, posture_, model.nominal).rigid.before;
    hand_ = before.V;
    rate_before_ = before.Omega.tail<3>();
    contact_.is_grasped = contact_.law == ContactLaw::Latch;
  }

  /// Of the target.
  Vector6d velocity(const Vector6d& s) const { return mean_ + root_ * s; }
  const Vector6d& hand() const { return hand_; }
  bool closes(const Vector6d& V) const { return contact_.n.dot(V.head<3>()) > 0; }
  double closing_deviations() const {
    const Vector3d across = root_.topRows<3>().rowwise().squaredNorm().cwiseSqrt();
    return contact_.n.dot(mean_.head<3>()) / across.maxCoeff();
  }
  /// Zero where the contact points separate, or a sticking contact would pull.
  double square(const Vector6d& V) const {
    ContactTarget target = target_;
    target.angular_velocity = V.tail<3>();
    target.velocity = V.head<3>() - target.angular_velocity.cross(target.r);
    const ContactImpulse impulse = contact_impulse(contact_, W_h_, hand(), target);
    const Vector6d jump =
        compute_jump<double>(posture_.factor, posture_.jacobian, impulse.Fbar).Delta_Omega;
    return (rate_before_ + jump.tail<3>()).squaredNorm();
  }
  /// The same as if the contact could pull.
  double linear_square(const Vector6d& V) const { return square(closes(V) ? V : Vector6d(-V)); }

 private:
  PostureImpact<double> posture_;
  Matrix6d W_h_, root_;
  Contact contact_;
  ContactTarget target_;
  Vector6d mean_;
  Vector6d hand_ = Vector6d::Zero();         ///< before the contact
  Vector3d rate_before_ = Vector3d::Zero();  ///< of the base
};

Vector6d normal_vector(Random& random) {
  Vector6d s;
  for (double& x : s) x = random.normal();
  return s;
}

/// Mean of squares over samples, and its standard error.
struct MeanOfSamples {
  double sum = 0, squares = 0;
  int count = 0;

  void add(double x) {
    sum += x;
    squares += x * x;
    ++count;
  }
  double mean() const { return sum / count; }
  double error() const { return std::sqrt((squares / count - mean() * mean()) / count); }
};

constexpr int kSamples = 100'000;

}  // namespace

TEST_CASE("the expectation over the residual velocity is the mean of samples of the contact law") {
  const ContactLaw law =
      GENERATE(ContactLaw::Frictionless, ContactLaw::Sticking, ContactLaw::Latch);
  Random random(61);
  CaptureProblem problem = residual_problem(random, law);
  problem.measure.kind = RiskMeasure::Expectation;
  const Formulation formulation(problem);
  const Eigen::VectorXd x = some_point(formulation, 1);
  const FullLaw full(problem, formulation, x);
  REQUIRE(full.closing_deviations() > 5);  // no sample separates

  MeanOfSamples samples;
  for (int i = 0; i < kSamples; ++i) samples.add(full.square(full.velocity(normal_vector(random))));
  const double value = Measure(problem, formulation).reported(x);
  INFO("contact law " << static_cast<int>(law));
  const double nominal = nominal_value(problem, formulation, formulation.configuration(x));
  if (law == ContactLaw::Sticking) {
    // Some pull: the closed form counts them, and is an upper bound.
    CHECK(value * value > samples.mean() - 5 * samples.error());
    CHECK(value * value == Approx(samples.mean()).epsilon(0.2));
  } else {
    CHECK(std::abs(value * value - samples.mean()) < 5 * samples.error());
  }
  CHECK(value > nominal);
}

TEST_CASE("where many velocities separate the expectation is that of a contact that pulls") {
  const ContactLaw law = GENERATE(ContactLaw::Frictionless, ContactLaw::Latch);
  Random random(62);
  CaptureProblem problem = residual_problem(random, law, 0.2, 0.3);
  problem.measure.kind = RiskMeasure::Expectation;
  const Formulation formulation(problem);
  const Eigen::VectorXd x = some_point(formulation, 2);
  const FullLaw full(problem, formulation, x);
  MeanOfSamples samples, linear;
  int separating = 0;
  for (int i = 0; i < kSamples; ++i) {
    const Vector6d V = full.velocity(normal_vector(random));
    samples.add(full.square(V));
    linear.add(full.linear_square(V));
    separating += !full.closes(V);
  }
  const double value = Measure(problem, formulation).reported(x);
  INFO("contact law " << static_cast<int>(law));
  CHECK(std::abs(value * value - linear.mean()) < 5 * linear.error());
  CHECK(value * value > samples.mean() + 5 * samples.error());
  const ResidualSummary summary =
      summarize_residual(problem, formulation, formulation.configuration(x));
  CHECK(separating > 0.1 * kSamples);
  CHECK(summary.separating == Approx(separating / double{kSamples}).epsilon(0).margin(0.008));
}

TEST_CASE("no sample of the ellipsoid exceeds the worst case, and some come near") {
  const ContactLaw law =
      GENERATE(ContactLaw::Frictionless, ContactLaw::Sticking, ContactLaw::Latch);
  Random random(63);
  CaptureProblem problem = residual_problem(random, law);
  problem.measure.kind = RiskMeasure::WorstCase;
  problem.uncertainty.residual_velocity->deviations = 2.5;
  const Formulation formulation(problem);
  const Eigen::VectorXd x = some_point(formulation, 3);
  const Configuration at = formulation.configuration(x);
  const FullLaw full(problem, formulation, x);
  const double worst = worst_case(problem, formulation, at).value;
  double largest = 0;
  for (int i = 0; i < kSamples; ++i) {
    const Vector6d V = full.velocity(2.5 * normal_vector(random).normalized());
    largest = std::max(largest, std::sqrt(full.square(V)));
  }
  INFO("contact law " << static_cast<int>(law));
  CHECK(largest <= worst * (1 + 1e-12));
  CHECK(largest > 0.95 * worst);
  const ResidualSummary summary = summarize_residual(problem, formulation, at);
  CHECK(std::sqrt(full.square(summary.worst_velocity)) == Approx(worst).epsilon(1e-10));
  CHECK(Measure(problem, formulation).reported(x) == Approx(worst).epsilon(1e-12));
}

/// Where a test's covariance comes from.
enum class Source { InTarget, InN, Estimate };

/// Relative: two evaluations of one value, a gradient and its largest component, a Hessian and
/// differences of gradients.
struct Agreement {
  double value, gradient, hessian;
};
constexpr Agreement kRestingHand{1e-12, 1e-11, 1e-7};
/// The rates before the contact come from equations that square the Jacobian's condition.
constexpr Agreement kMovingHand{1e-9, 1e-9, 1e-5};

/// Of a hand that moves the slowest of some points: joints that race are next to a singular
/// posture.
Eigen::VectorXd slow_point(const Formulation& formulation, int index) {
  constexpr int kPoints = 50;
  const CaptureModel& model = formulation.parts().model;
  if (!model.encounter.hand_moves()) return some_point(formulation, index);
  Eigen::VectorXd out;
  double slowest = nlp::kInfinity;
  for (int i = kPoints * index; i < kPoints * (index + 1); ++i) {
    const Eigen::VectorXd x = some_point(formulation, i);
    const auto at = model.place<double>(x);
    const double speed =
        model.impact(at, model.posture(at), model.nominal).rigid.before.phidot.norm();
    if (speed >= slowest) continue;
    slowest = speed;
    out = x;
  }
  return out;
}

/// Gradients and Hessian of several terms at a point.
void check_derivatives(CaptureProblem problem, Source source, int point, const Agreement& same) {
  ResidualVelocity& residual = *problem.uncertainty.residual_velocity;
  if (source == Source::InN) residual.frame = ResidualFrame::Inertial;
  if (source == Source::Estimate) {
    residual.covariance.reset();
    problem.target_deviations = some_deviations();
    residual.linear_tracking = 1e-3;
  }
  problem.objective = {{ObjectiveQuantity::BaseAngularMomentum, 0.7},
                       {ObjectiveQuantity::TotalAngularMomentum, 2},
                       {ObjectiveQuantity::BaseMomentum, 3, 0.5},
                       {ObjectiveQuantity::JointRateNorm, 0.2}};
  const Formulation formulation(problem);
  const Formulation::Parts& parts = formulation.parts();
  const CaptureModel& model = parts.model;
  const Eigen::VectorXd x = slow_point(formulation, point);
  const std::vector<Scenario> scenarios = mean_scenarios(problem);
  REQUIRE(scenarios.size() == 7);
  ScenarioEvaluation here;
  formulation.evaluate_scenarios(x, scenarios, true, here);
  for (Eigen::Index k = 0; k < 7; ++k) {  // in packs above where the hand is at rest, here alone
    ScenarioEvaluation alone;
    formulation.evaluate_scenarios(x, {scenarios[static_cast<std::size_t>(k)]}, true, alone);
    CHECK(alone.values[0] == Approx(here.values[k]).epsilon(1e-12));
    CHECK((alone.gradients.row(0) - here.gradients.row(k)).cwiseAbs().maxCoeff() <
          1e-11 * (1 + here.gradients.row(k).norm()));
  }
  const Eigen::VectorXd weights = Eigen::VectorXd::Constant(7, 1. / 7);
  const auto mean_gradient = [&](const Eigen::VectorXd& at) {
    ScenarioEvaluation there;
    formulation.evaluate_scenarios(at, scenarios, true, there);
    return Eigen::VectorXd(there.gradients.transpose() * weights);
  };
  Eigen::MatrixXd hessian;
  formulation.scenario_hessian(x, scenarios, weights,
                               Eigen::VectorXd::Zero(formulation.num_constraints()), hessian);
  VectorX<Tangent> along = x.cast<Tangent>();
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    along[i].set_derivative(1);
    const auto at = model.place<Tangent>(along);
    const auto posture = model.posture(at);
    for (std::size_t k = 0; k < scenarios.size(); ++k) {
      const Tangent f = parts.jump.objective(posture, model.impact(at, posture, scenarios[k]),
                                             parts.objective_unit);
      const auto row = static_cast<Eigen::Index>(k);
      INFO("source " << static_cast<int>(source) << ", point " << point << ", scenario " << k
                     << ", variable " << i);
      CHECK(here.values[row] == Approx(f.v).epsilon(same.value));
      CHECK(std::abs(here.gradients(row, i) - f.derivative()) <
            same.gradient * (1 + here.gradients.row(row).cwiseAbs().maxCoeff()));
    }
    along[i].set_derivative(0);
    const double h = 1e-5;
    const Eigen::VectorXd step = h * Eigen::VectorXd::Unit(x.size(), i);
    const Eigen::VectorXd column = (mean_gradient(x + step) - mean_gradient(x - step)) / (2 * h);
    CHECK((hessian.col(i) - column).cwiseAbs().maxCoeff() <
          same.hessian * (1 + hessian.cwiseAbs().maxCoeff()));
  }
}

TEST_CASE("gradients and Hessians over velocity errors agree with automatic differentiation") {
  const Source source = GENERATE(Source::InTarget, Source::InN, Source::Estimate);
  SECTION("a hand at rest") {
    const ContactLaw law =
        GENERATE(ContactLaw::Frictionless, ContactLaw::Sticking, ContactLaw::Latch);
    INFO("law " << static_cast<int>(law));
    Random random(64);
    for (int trial = 0; trial < 3; ++trial) {
      check_derivatives(residual_problem(random, law, 0.1, 0.1), source, trial, kRestingHand);
    }
  }
  SECTION("a hand that moves") {
    const Moving moving = GENERATE(from_range(std::begin(kMoving), std::end(kMoving)));
    INFO("velocity " << static_cast<int>(moving.velocity));
    Random random(70);
    for (int trial = 0; trial < 3; ++trial) {
      check_derivatives(moving_problem(random, moving, 0.1, 0.1), source, trial, kMovingHand);
    }
  }
}

TEST_CASE("with a hand that moves both measures are those of samples of the contact law") {
  const Moving moving = GENERATE(from_range(std::begin(kMoving), std::end(kMoving)));
  if (moving.law == ContactLaw::Sticking) return;  // some of its samples pull
  INFO("velocity " << static_cast<int>(moving.velocity));
  Random random(71);
  CaptureProblem problem = moving_problem(random, moving);
  problem.uncertainty.residual_velocity->deviations = 2.5;
  const Formulation formulation(problem);
  const Eigen::VectorXd x = some_point(formulation, 5);
  const Configuration at = formulation.configuration(x);
  const FullLaw full(problem, formulation, x);
  MeanOfSamples samples;
  double largest = 0;
  for (int i = 0; i < kSamples; ++i) {
    const Vector6d s = normal_vector(random);
    samples.add(full.square(full.velocity(s)));
    largest = std::max(largest, full.square(full.velocity(2.5 * s.normalized())));
  }
  problem.measure.kind = RiskMeasure::Expectation;
  const double mean = Measure(problem, formulation).reported(x);
  CHECK(std::abs(mean * mean - samples.mean()) < 5 * samples.error());
  CHECK(mean > nominal_value(problem, formulation, at));
  problem.measure.kind = RiskMeasure::WorstCase;
  const double worst = Measure(problem, formulation).reported(x);
  CHECK(std::sqrt(largest) <= worst * (1 + 1e-12));
  CHECK(std::sqrt(largest) > 0.9 * worst);

  const ResidualSummary summary = summarize_residual(problem, formulation, at);
  const Vector6d nominal = full.velocity(Vector6d::Zero()) - full.hand();
  CHECK((summary.velocity - nominal).norm() < 1e-12);
  if (moving.velocity == HandVelocity::MatchAll) CHECK(summary.velocity.norm() < 1e-12);
  CHECK(std::sqrt(full.square(summary.worst_velocity + full.hand())) ==
        Approx(worst).epsilon(1e-10));
  CHECK(summary.separating == 0);  // it has hold of the target
}

TEST_CASE("points of a contact without slip separate by their relative velocity") {
  Random random(72);
  const Moving& sticking = kMoving[5];
  const CaptureProblem problem = moving_problem(random, sticking, 0.04);
  const Formulation formulation(problem);
  const Eigen::VectorXd x = some_point(formulation, 5);
  const FullLaw full(problem, formulation, x);
  int separating = 0;
  for (int i = 0; i < kSamples; ++i) {
    separating += !full.closes(full.velocity(normal_vector(random)) - full.hand());
  }
  const double stated =
      summarize_residual(problem, formulation, formulation.configuration(x)).separating;
  CHECK(separating > 0.02 * kSamples);
  CHECK(stated == Approx(separating / double{kSamples}).epsilon(0).margin(0.008));
}

TEST_CASE("the worst case changes as the scenario at which it is taken") {
  enum class Hand { Frictionless, Latch, Matched };
  const Hand hand = GENERATE(Hand::Frictionless, Hand::Latch, Hand::Matched);
  Random random(65);
  CaptureProblem problem =
      hand == Hand::Matched
          ? moving_problem(random, kMoving[3], 0.02, 0.05)
          : residual_problem(random,
                             hand == Hand::Latch ? ContactLaw::Latch : ContactLaw::Frictionless,
                             0.02, 0.05);
  problem.uncertainty.residual_velocity->frame = ResidualFrame::Inertial;
  problem.measure.kind = RiskMeasure::WorstCase;
  const Formulation formulation(problem);
  const Eigen::VectorXd x = some_point(formulation, 4);
  const auto half_square = [&](const Eigen::VectorXd& at) {
    const double ratio = worst_case(problem, formulation, formulation.configuration(at)).value /
                         formulation.objective_unit();
    return ratio * ratio / 2;
  };
  const auto maxima = cone_maxima(problem, formulation, formulation.configuration(x));
  ScenarioEvaluation here;
  formulation.evaluate_scenarios(x, {maxima.front().scenario}, true, here);
  CHECK(here.values[0] == Approx(half_square(x)).epsilon(1e-12));
  const double h = 1e-4;
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    const Eigen::VectorXd step = h * Eigen::VectorXd::Unit(x.size(), i);
    const double slope = (8 * (half_square(x + step) - half_square(x - step)) -
                          (half_square(x + 2 * step) - half_square(x - 2 * step))) /
                         (12 * h);
    CHECK(here.gradients(0, i) ==
          Approx(slope).epsilon(0).margin(1e-7 * (1 + here.gradients.norm())));
  }
}

TEST_CASE("a carried covariance is that of drawn estimates, and its root follows the time") {
  Random random(66);
  CaptureProblem problem = residual_problem(random, ContactLaw::Latch);
  problem.target_deviations = some_deviations();
  problem.uncertainty.residual_velocity->covariance.reset();
  problem.uncertainty.residual_velocity->linear_tracking = 1e-3;
  problem.uncertainty.residual_velocity->angular_tracking = 2e-3;
  const ResidualRoot root(problem);
  const ContactFeature& feature = problem.target->features[0];
  for (const double time : {0.0, 1.7, 5.0}) {
    const TargetMotion nominal(*problem.target, problem.target_state, 10);
    const Matrix3d R_TN = nominal.state(time).pose.orientation.conjugate().toRotationMatrix();
    Matrix6d sampled = Matrix6d::Zero();
    constexpr int kDraws = 20'000;
    for (int i = 0; i < kDraws; ++i) {
      EstimateVector error = covariance_of(*problem.target_deviations).diagonal().cwiseSqrt();
      for (double& e : error) e *= random.normal();
      const TargetEstimate drawn = with_error({*problem.target, problem.target_state}, error);
      const TargetMotion motion(drawn.body, drawn.state, 10);
      Vector6d d;
      d << R_TN *
               (motion.contact(feature, time).velocity - nominal.contact(feature, time).velocity),
          R_TN * (motion.state(time).angular_velocity - nominal.state(time).angular_velocity);
      sampled += d * d.transpose() / kDraws;
    }
    sampled.diagonal().head<3>().array() += 1e-6;
    sampled.diagonal().tail<3>().array() += 4e-6;
    const Matrix6d covariance = root.covariance(time);
    for (int i = 0; i < 6; ++i) {
      for (int j = 0; j < 6; ++j) {
        const double size = std::sqrt(covariance(i, i) * covariance(j, j));
        CHECK(covariance(i, j) == Approx(sampled(i, j)).epsilon(0).margin(0.05 * size));
      }
    }
    const double h = 1e-3;
    const double inside = std::min(std::max(time, 2 * h), 5 - 2 * h);
    const Matrix6d slope = (root.at(inside + h) - root.at(inside - h)) / (2 * h);
    CHECK((root.at(inside, 1) - slope).norm() < 1e-7);
    const Matrix6d bend = (root.at(inside + h, 1) - root.at(inside - h, 1)) / (2 * h);
    CHECK((root.at(inside, 2) - bend).norm() < 1e-7);
  }
}

TEST_CASE("an unchanging hand leaves no mean: seven velocity errors are standard normal") {
  Random random(67);
  const CaptureProblem problem = residual_problem(random, ContactLaw::Latch);
  Vector6d mean = Vector6d::Zero();
  Matrix6d covariance = Matrix6d::Zero();
  for (const Scenario& scenario : mean_scenarios(problem)) {
    mean += scenario.weight * scenario.velocity_error;
    covariance += scenario.weight * scenario.velocity_error * scenario.velocity_error.transpose();
  }
  CHECK(mean.norm() < 1e-14);
  CHECK((covariance - Matrix6d::Identity()).norm() < 1e-14);
}

TEST_CASE("maxima over a ball: all local ones, the hard case and the flat one") {
  const auto value = [](const Matrix6d& P, const Vector6d& q, const Vector6d& s) {
    return s.dot(P * s) / 2 + q.dot(s);
  };
  Random random(68);
  for (int trial = 0; trial < 200; ++trial) {
    Matrix6d root;
    for (double& x : root.reshaped()) x = random.normal();
    if (trial % 3 == 0) root.bottomRows<3>().setZero();  // of rank three, as of a base's rate
    const Matrix6d P = root.transpose() * root;
    const double size = trial % 5 == 0 ? 1e-9 : trial % 5 == 1 ? 30 : 1;
    const Vector6d q = size * normal_vector(random);
    const std::vector<Vector6d> maxima = maxima_over_ball(P, q);
    INFO("trial " << trial);
    double best = 0;
    for (int i = 0; i < 40; ++i) {
      Vector6d s = normal_vector(random).normalized();
      for (int k = 0; k < 20'000; ++k) s = (P * s + q).normalized();
      best = std::max(best, value(P, q, s));
      // Every end of a climb is one of the maxima.
      double nearest = 2;
      for (const Vector6d& m : maxima) nearest = std::min(nearest, (m - s).norm());
      CHECK(nearest < 1e-5);
    }
    CHECK(value(P, q, maxima.front()) == Approx(best).epsilon(1e-12));
    for (const Vector6d& m : maxima) {
      CHECK(m.norm() == Approx(1).epsilon(1e-12));
      const Vector6d force = P * m + q;
      CHECK((force - force.dot(m) * m).norm() < 1e-8 * force.norm());
    }
  }
  // The hard case: q normal to the largest axis, and short.
  const Matrix6d P = (Vector6d() << 1, 2, 3, 4, 5, 9).finished().asDiagonal();
  const Vector6d q = 2 * Vector6d::Unit(1);
  const std::vector<Vector6d> hard = maxima_over_ball(P, q);
  REQUIRE(hard.size() == 2);
  const double along = 2.0 / 7, rest = std::sqrt(1 - along * along);
  CHECK(std::abs(hard[0][5]) == Approx(rest));
  CHECK(hard[0][5] == Approx(-hard[1][5]));
  CHECK(hard[0][1] == Approx(along));
  CHECK(value(P, q, hard[0]) == Approx(4.5 + 2.0 / 7));  // mu/2 + q'(mu E - P)^+ q / 2
  // Vbar = 0: both ends of the largest axis.
  const std::vector<Vector6d> both = maxima_over_ball(P, Vector6d::Zero());
  REQUIRE(both.size() == 2);
  CHECK(std::abs(both[0][5]) == Approx(1));
  CHECK((both[0] + both[1]).norm() < 1e-14);
  // q normal to the largest axis, and long: one.
  const std::vector<Vector6d> one = maxima_over_ball(P, 40 * Vector6d::Unit(1));
  REQUIRE(one.size() == 1);
  CHECK(one[0][1] == Approx(1));
  CHECK(maxima_over_ball(Matrix6d::Zero(), Vector6d::Zero()).size() == 1);
  CHECK(maxima_over_ball(Matrix6d::Zero(), q).front()[1] == Approx(1));
}

TEST_CASE("objectives that are not linear in the impulse have no closed form, and are refused") {
  Random random(69);
  CaptureProblem problem = residual_problem(random, ContactLaw::Latch);
  problem.objective = {{ObjectiveQuantity::AttitudeTurned}};
  problem.objective[0].after = 1;
  problem.post_impact.controllers = {"joint_damping"};
  CHECK_THROWS_WITH(Formulation(problem), Catch::Contains("linear in the impulse"));
}

}  // namespace stillbase
