// The order of candidates: measure, worst case, distance from the start posture.
#include <catch2/catch.hpp>

#include <limits>
#include <tuple>
#include <utility>

#include <stillbase/core/constants.hpp>
#include <stillbase/plan/turns.hpp>

#include "search/ranking.hpp"
#include "support/shipped_problem.hpp"

namespace stillbase {
namespace {

constexpr double kEqual = 1e-8;

class List {
 public:
  explicit List(RiskMeasure measure) : problem_(test::shipped("planar_two_link_c2_a")) {
    problem_.measure.kind = measure;
  }

  /// @param turned by how much the first joint is from the start posture, rad
  List& add(double nominal, double worst_case, double turned) {
    Candidate candidate;
    candidate.objective = nominal;
    candidate.worst_case = worst_case;
    candidate.value = problem_.measure.kind == RiskMeasure::Nominal ? nominal : worst_case;
    candidate.configuration.phi = problem_.start;
    candidate.configuration.phi[0] += turned;
    candidates_.push_back(candidate);
    return *this;
  }

  std::vector<std::size_t> order() const { return candidate_order(problem_, candidates_, kEqual); }

 private:
  CaptureProblem problem_;
  std::vector<Candidate> candidates_;
};

using Indices = std::vector<std::size_t>;

TEST_CASE("of zeros that differ by rounding the nearest to the start posture is first") {
  for (const RiskMeasure measure : {RiskMeasure::WorstCase, RiskMeasure::Nominal}) {
    List list(measure);
    list.add(3e-16, 3e-16, 2).add(8e-16, 8e-16, -1).add(5e-16, 5e-16, 0.5).add(1e-7, 1e-7, 0);
    CHECK(list.order() == Indices{2, 1, 0, 3});
  }
}

TEST_CASE("nominal values that are equal follow each other by their worst case, then by distance") {
  List list(RiskMeasure::Nominal);
  list.add(1e-15, 0.3, 0).add(2e-15, 0.1, 2).add(3e-15, 0.1 + 1e-12, 1).add(0.01, 0.02, 0);
  CHECK(list.order() == Indices{2, 1, 0, 3});
}

TEST_CASE("endless joints have the shorter way, those with whole turns the nearest of them") {
  CaptureProblem problem = test::shipped("planar_two_link_c2_a");
  problem.variables.joints.assign(2, true);
  problem.start << 3, 0;
  problem.robot.joints[0].type = JointType::Continuous;
  Joint& second = problem.robot.joints[1];
  second.type = JointType::Revolute;
  std::tie(second.lower, second.upper) = std::pair(-4.0, 4.0);
  problem.constraints.joint_limit_margin = 0;
  Configuration at;
  at.phi = JointVectord(2);
  at.phi << -3, 3;  // the second one has no room for a turn less
  CHECK(least_way_from_start(problem, at) == Approx(std::hypot(2 * kPi - 6, 3)));
  problem.start << 3, -3.5;
  CHECK(least_way_from_start(problem, at) == Approx(std::hypot(2 * kPi - 6, 3.5 - (2 * kPi - 3))));
  second.type = JointType::Prismatic;
  CHECK(least_way_from_start(problem, at) == Approx(std::hypot(2 * kPi - 6, 6.5)));

  std::vector<Candidate> candidates(2);
  for (Candidate& candidate : candidates) candidate.configuration.phi = problem.start;
  candidates[0].configuration.phi[0] = 2;
  candidates[1].configuration.phi[0] = -3;
  CHECK(candidate_order(problem, candidates, kEqual) == Indices{1, 0});
}

TEST_CASE("of mirror images that are equally near rounding does not choose") {
  for (const double last_digits : {-1e-13, 1e-13}) {
    List list(RiskMeasure::WorstCase);
    list.add(2e-16, 2e-16, 0.5 + last_digits).add(1e-16 - last_digits, 2e-16, -0.5);
    CHECK(list.order() == Indices{1, 0});
  }
}

TEST_CASE("a group of equal candidates begins anew, and what is not a number is last") {
  List list(RiskMeasure::WorstCase);
  list.add(0, std::numeric_limits<double>::quiet_NaN(), 0);
  list.add(0, 2 * kEqual, 0).add(0, kEqual, 1).add(0, 0.5 * kEqual, 0.5).add(0, 0, 2);
  CHECK(list.order() == Indices{3, 2, 4, 1, 0});
}

}  // namespace
}  // namespace stillbase
