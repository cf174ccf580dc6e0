// Postures that are whole turns of a joint apart, which a search lists once.
#include <catch2/catch.hpp>

#include <stillbase/core/constants.hpp>
#include <stillbase/core/rotation.hpp>
#include <stillbase/plan/free_roll.hpp>
#include <stillbase/plan/turns.hpp>
#include <stillbase/search/search.hpp>

#include "support/capture_problems.hpp"
#include "support/shipped_problem.hpp"

namespace stillbase {
namespace {

CaptureProblem with_limits(CaptureProblem problem, double lower, double upper) {
  for (Joint& joint : problem.robot.joints) {
    joint.type = JointType::Revolute;
    joint.lower = lower;
    joint.upper = upper;
  }
  return problem;
}

SearchResult searched(const CaptureProblem& problem) {
  SearchOptions options;
  options.starts = 32;
  options.max_candidates = 200;
  return search(problem, Formulation(problem), options);
}

double apart(const Configuration& a, const Configuration& b) {
  double sum = 0;
  for (int k = 0; k < a.phi.size(); ++k) sum += std::abs(wrap_angle(a.phi[k] - b.phi[k]));
  return sum;
}

/// Whether each candidate of one result is one of the other, modulo whole turns.
void check_same_solutions(const SearchResult& a, const SearchResult& b) {
  CHECK(a.distinct_solutions == b.distinct_solutions);
  for (const Candidate& one : a.candidates) {
    double nearest = kInfinity;
    for (const Candidate& other : b.candidates) {
      nearest = std::min(nearest, apart(one.configuration, other.configuration));
    }
    CHECK(nearest < 1e-4);
  }
}

void check_within_limits(const CaptureProblem& problem, const SearchResult& found) {
  for (const Candidate& candidate : found.candidates) {
    for (int k = 0; k < problem.robot.n(); ++k) {
      const Joint& joint = problem.robot.joints[static_cast<std::size_t>(k)];
      CHECK(candidate.configuration.phi[k] >= joint.lower);
      CHECK(candidate.configuration.phi[k] <= joint.upper);
    }
  }
}

}  // namespace

TEST_CASE("isolated solutions that are whole turns apart are one") {
  const CaptureProblem endless = test::without_path("planar_two_link_c2_a");
  const SearchResult expected = searched(endless);
  REQUIRE(expected.distinct_solutions >= 2);
  for (const auto& [lower, upper] : {std::pair(-6.1, 6.1), std::pair(-0.5, 12.5)}) {
    const CaptureProblem problem = with_limits(endless, lower, upper);
    const SearchResult found = searched(problem);
    check_same_solutions(found, expected);
    check_within_limits(problem, found);
  }
}

TEST_CASE("a limit that the same posture keeps a turn away makes no minimum") {
  Random random(5);
  for (int trial = 0; trial < 4; ++trial) {
    const CaptureProblem endless =
        point_mass_problem(random_planar_robot(random, 3), Vector3d::UnitX());
    CaptureProblem problem = endless;
    problem.objective = {{ObjectiveQuantity::JointRateNorm}};
    const SearchResult expected = searched(problem);
    // Limits at which the best posture is in the middle of the range, near its end and beyond it.
    for (const double lower : {-3.2, -1.6, -0.1}) {
      const CaptureProblem limited = with_limits(problem, lower, lower + 6.5);
      const SearchResult found = searched(limited);
      check_same_solutions(found, expected);
      check_within_limits(limited, found);
      CHECK(found.candidates.front().objective ==
            Approx(expected.candidates.front().objective).margin(1e-9));
    }
  }
}

TEST_CASE("the form nearest to the start posture goes first, however wide the limits are") {
  CaptureProblem problem = with_limits(test::without_path("planar_two_link_c2_a"), -9000, 9000);
  problem.start << 5000, -3000;
  Configuration at{Eigen::Vector2d(0.5, -0.25), problem.base};
  const std::vector<Configuration> forms = other_turns(problem, at, std::nullopt, 5);
  REQUIRE(forms.size() == 5);
  for (int k = 0; k < 2; ++k) {
    CHECK(std::abs(forms.front().phi[k] - problem.start[k]) <= kPi);
    CHECK(wrap_angle(forms.front().phi[k] - at.phi[k]) == Approx(0).margin(1e-9));
  }
  for (std::size_t i = 1; i < forms.size(); ++i) {
    CHECK_FALSE(is_nearer_to_start(problem, forms[i], forms[i - 1]));
  }
  // Of two as near, the smaller angle.
  problem.start << 2 * kPi, 0;
  at.phi << 3 * kPi, 0;
  CHECK(other_turns(problem, at, std::nullopt, 1).front().phi[0] == Approx(kPi));
  CHECK(is_nearer_to_start(problem, other_turns(problem, at, std::nullopt, 1).front(), at));
}

TEST_CASE("a joint that others follow keeps its limits, and no other joint does") {
  Random random(3);
  CaptureProblem problem =
      with_limits(point_mass_problem(random_planar_robot(random, 4), Vector3d::UnitX()), -6.5, 6.5);
  RobotModel& robot = problem.robot;
  robot.coupled_tree = robot.joints;
  robot.joints.resize(3);
  robot.couplings = {{0, 1, 0}, {1, 1, 0}, {2, 1, 0}, {1, -0.5, 0.1}};
  problem.start = JointVectord::Zero(3);
  problem.variables.joints.assign(3, true);
  CHECK(has_whole_turns(problem, 0));
  CHECK_FALSE(has_whole_turns(problem, 1));
  CHECK(has_whole_turns(problem, 2));
  const Configuration at{Eigen::Vector3d(1, 1, 1), problem.base};
  for (const JointTurns& turns : whole_turns(problem, at, std::nullopt)) {
    CHECK(turns.joint != robot.joints[1].name);
  }
  // Whole turns of the others leave the impact as it is.
  const Formulation formulation(problem);
  const auto value = [&](const Configuration& form) {
    Eigen::VectorXd y;
    Eigen::MatrixXd jacobian;
    formulation.objective_vector(formulation.variables(form), y, jacobian);
    return y.norm();
  };
  REQUIRE(value(at) > 0);
  for (const Configuration& form : other_turns(problem, at, std::nullopt, 8)) {
    CHECK(value(form) == Approx(value(at)).epsilon(1e-9));
  }
}

TEST_CASE("a joint without limits that another follows is not wrapped") {
  Random random(3);
  CaptureProblem problem = point_mass_problem(random_planar_robot(random, 3), Vector3d::UnitX());
  RobotModel& robot = problem.robot;
  for (Joint& joint : robot.joints) joint.type = JointType::Continuous;
  robot.coupled_tree = robot.joints;
  robot.joints.resize(2);
  robot.couplings = {{0, 1, 0}, {1, 1, 0}, {1, 0.5, 0}};
  problem.start = JointVectord::Zero(2);
  problem.variables.joints.assign(2, true);
  const Formulation formulation(problem);
  Eigen::VectorXd x = formulation.variables({Eigen::Vector2d(4, 4), problem.base});
  x = formulation.normalised(x);
  CHECK(x[0] == Approx(4 - 2 * kPi));
  CHECK(x[1] == 4);
}

TEST_CASE("the last joint may roll freely behind a joint that follows another") {
  CaptureProblem problem = test::without_path("deos_latch");
  problem.search.starts = 8;
  problem.constraints.clearance.reset();
  RobotModel& robot = problem.robot;
  REQUIRE(robot.n() == 7);
  const auto without_fourth = [](const JointVectord& all) {
    JointVectord out(6);
    out << all.head(3), all.tail(3);
    return out;
  };
  robot.coupled_tree = robot.joints;
  robot.joints.erase(robot.joints.begin() + 3);
  robot.couplings = {{0, 1, 0}, {1, 1, 0}, {2, 1, 0}, {2, 0.5, 0}, {3, 1, 0}, {4, 1, 0}, {5, 1, 0}};
  problem.start = without_fourth(problem.start);
  problem.resistance.rotor_inertia = without_fourth(problem.resistance.rotor_inertia);
  problem.variables.joints.assign(6, true);
  const SearchResult found = searched(problem);
  REQUIRE_FALSE(found.candidates.empty());
  const int family = found.candidates.front().family;
  REQUIRE(family >= 0);
  CHECK(free_joint(found.families[static_cast<std::size_t>(family)]) == 5);
}

TEST_CASE("limits less than a turn apart are limits") {
  const CaptureProblem problem = with_limits(test::without_path("planar_two_link_c2_a"), -3.1, 3.1);
  for (int k = 0; k < 2; ++k) CHECK_FALSE(has_whole_turns(problem, k));
  const CaptureProblem wide = with_limits(problem, -3.2, 3.2);
  CHECK(has_whole_turns(wide, 0));
  CaptureProblem with_margin = wide;
  with_margin.constraints.joint_limit_margin = 0.1;
  CHECK_FALSE(has_whole_turns(with_margin, 0));
}

}  // namespace stillbase
