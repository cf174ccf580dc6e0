#include <catch2/catch.hpp>

#include <algorithm>

#include <stillbase/formulation/measures/robust.hpp>
#include <stillbase/search/search.hpp>

#include "formulation/measures/measure.hpp"
#include "formulation/measures/scenario_program.hpp"
#include "support/capture_problems.hpp"
#include "support/shipped_problem.hpp"

namespace stillbase {
namespace {

/// The postures of a planar three-joint arm that hold the hand's point, by the absolute angle of
/// its last link and the side of its elbow.
struct SelfMotion {
  const CaptureProblem& problem;
  const Formulation& formulation;
  double lengths[3];

  /// Worst case at a posture; nothing where the arm does not reach.
  std::optional<double> worst(double angle, int elbow) const {
    const Vector3d shoulder = problem.robot.joints[0].p;
    const Vector3d last(lengths[2] * std::cos(angle), lengths[2] * std::sin(angle), 0);
    const Vector3d wrist = *problem.hand.position - shoulder - last;
    const double d = wrist.norm(), a = lengths[0], b = lengths[1];
    const double c = (d * d - a * a - b * b) / (2 * a * b);
    if (std::abs(c) > 1) return std::nullopt;
    const double second = elbow * std::acos(c);
    const double first = std::atan2(wrist.y(), wrist.x()) -
                         std::atan2(b * std::sin(second), a + b * std::cos(second));
    Configuration configuration;
    configuration.phi.resize(3);
    configuration.phi << first, second, angle - first - second;
    const auto kinematics = compute_kinematics<double>(problem.robot, configuration.phi);
    REQUIRE((kinematics.r_bh - *problem.hand.position).norm() < 1e-9);
    return worst_case(problem, formulation, configuration).value;
  }

  /// The smallest worst case of both curves: a scan, then finer and finer ones about its best
  /// places.
  double smallest() const {
    double best = kInfinity;
    constexpr int kScan = 1500;
    for (const int elbow : {-1, 1}) {
      std::vector<std::pair<double, double>> scan;  // worst, angle
      for (int i = 0; i < kScan; ++i) {
        const double angle = 2 * M_PI * i / kScan;
        if (const auto value = worst(angle, elbow)) scan.emplace_back(*value, angle);
      }
      std::sort(scan.begin(), scan.end());
      for (std::size_t k = 0; k < std::min<std::size_t>(scan.size(), 8); ++k) {
        double centre = scan[k].second, value = scan[k].first;
        for (double step = 2 * M_PI / kScan / 4; step > 1e-9; step /= 3) {
          for (const double side : {-3, -2, -1, 1, 2, 3}) {
            const auto trial = worst(centre + side * step, elbow);
            if (trial && *trial < value) {
              value = *trial;
              centre += side * step;
            }
          }
        }
        best = std::min(best, value);
      }
    }
    return best;
  }
};

}  // namespace

TEST_CASE("the planar three-link arm's global robust optimum is found for every cone") {
  CaptureProblem problem = test::shipped("planar_three_link_null");
  problem.measure.kind = RiskMeasure::WorstCase;
  problem.search.starts = 32;
  double nominal_postures_worst = 0;
  for (const double cone : {5., 20., 45., 70., 90.}) {
    problem.uncertainty.cone_half_angle = cone * M_PI / 180;
    const Formulation formulation(problem);
    SearchOptions options;
    options.starts = problem.search.starts;
    const SearchResult found = search(problem, formulation, options);
    REQUIRE_FALSE(found.candidates.empty());
    INFO("cone " << cone << " deg");
    const SelfMotion motion{problem, formulation, {0.9, 0.7, 0.4}};
    const double brute = motion.smallest();
    const Candidate& best = found.candidates.front();
    CHECK(best.worst_case <= brute * (1 + 1e-6));
    CHECK(best.worst_case >= brute * (1 - 1e-6));
    CHECK(best.value == Approx(best.worst_case).epsilon(1e-12));
    CHECK(status_of(found.certificates.front()) == PlanStatus::Optimal);
    REQUIRE(found.nominal_optimum);
    CHECK(found.nominal_optimum->worst_case >= best.worst_case * (1 - 1e-9));
    nominal_postures_worst =
        std::max(nominal_postures_worst, found.nominal_optimum->worst_case / best.worst_case);
  }
  // For some cone the nominal optimum is clearly worse.
  CHECK(nominal_postures_worst > 1.05);
}

TEST_CASE("mean and tail mean of samples are what sorting them gives") {
  Random random(61);
  Eigen::VectorXd values(10), weights = Eigen::VectorXd::Constant(10, 0.1);
  for (double& v : values) v = random.uniform();
  Eigen::VectorXd sorted = values;
  std::sort(sorted.begin(), sorted.end());
  CHECK(tail_mean(values, weights, 0).mean == Approx(values.mean()).epsilon(1e-14));
  CHECK(tail_mean(values, weights, 0.9).mean == Approx(sorted[9]).epsilon(1e-14));
  CHECK(tail_mean(values, weights, 0.7).mean == Approx(sorted.tail(3).mean()).epsilon(1e-14));
  // A share between samples counts the last one in part.
  CHECK(tail_mean(values, weights, 0.75).mean ==
        Approx((sorted[9] + sorted[8] + sorted[7] / 2) / 2.5).epsilon(1e-14));
}

TEST_CASE("expectation and CVaR are minimised, and the robust optimum is no nominal one") {
  Random random(62);
  CaptureProblem problem = tumbling_problem(random, random_robot(random, 6, false));
  problem.variables.base_position = PositionFreedom::Free;
  problem.variables.base_attitude = AttitudeFreedom::Fixed;
  problem.uncertainty.cone_half_angle = 0.2;
  problem.uncertainty.closing_speed = 0.01;
  problem.uncertainty.restitution = 0.2;
  problem.uncertainty.target_mass = 0.1;
  problem.uncertainty.contact_point = 0.02;
  problem.uncertainty.contact_time = 1;
  problem.measure.samples = 24;
  problem.measure.cvar_level = 0.8;
  for (const RiskMeasure kind : {RiskMeasure::Expectation, RiskMeasure::Cvar}) {
    problem.measure.kind = kind;
    const Formulation formulation(problem);
    SearchOptions options;
    options.starts = 6;
    const SearchResult found = search(problem, formulation, options);
    REQUIRE_FALSE(found.candidates.empty());
    Measure measure(problem, formulation);
    const Eigen::VectorXd& x = found.points.front();
    CHECK(found.candidates.front().value == Approx(measure.reported(x)).epsilon(1e-12));
    CHECK(found.certificates.front().kkt_residual < 1e-6);
    REQUIRE(found.nominal_optimum);
    CHECK(found.candidates.front().value < found.nominal_optimum->value);
    // Nothing nearby is better.
    for (int trial = 0; trial < 50; ++trial) {
      Eigen::VectorXd near = x;
      for (double& v : near) v += 1e-3 * random.normal();
      near = near.cwiseMax(formulation.lower()).cwiseMin(formulation.upper());
      nlp::Evaluation at;
      formulation.evaluate_value(near, at);
      const Eigen::VectorXd violation = nlp::signed_violation(
          at.constraints, formulation.constraint_lower(), formulation.constraint_upper());
      if (violation.cwiseAbs().maxCoeff() > 1e-12) continue;
      CHECK(measure.value(near) >= measure.value(x) * (1 - 1e-9));
    }
  }
}

TEST_CASE("samples depend on seed and index alone, and stay inside their ranges") {
  Random random(63);
  CaptureProblem problem = tumbling_problem(random, random_robot(random, 6, false));
  problem.uncertainty.cone_half_angle = 0.3;
  problem.uncertainty.target_mass = 0.2;
  problem.uncertainty.contact_point = 0.05;
  problem.measure.samples = 200;
  const std::vector<Scenario> many = draw_scenarios(problem);
  problem.measure.samples = 7;
  const std::vector<Scenario> few = draw_scenarios(problem);
  for (std::size_t k = 0; k < few.size(); ++k) CHECK(few[k].direction == many[k].direction);
  const Vector3d n = problem.target->features[0].normal;
  Vector3d mean = Vector3d::Zero();
  for (const Scenario& scenario : many) {
    CHECK(std::acos(std::min(1.0, scenario.direction.dot(n))) <= 0.3 + 1e-12);
    CHECK(std::abs(scenario.target_mass_factor - 1) <= 0.2);
    CHECK(scenario.contact_offset.norm() <= 0.05);
    CHECK(std::abs(scenario.contact_offset.dot(n)) < 1e-15);
    CHECK(scenario.restitution == problem.impulse.restitution);
    mean += scenario.direction / 200;
  }
  CHECK(std::acos(mean.normalized().dot(n)) < 0.05);
}

}  // namespace stillbase
