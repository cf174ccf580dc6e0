// The order of candidates: measure, worst case, distance from the start posture.
#include <catch2/catch.hpp>

#include <limits>

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

TEST_CASE("a group of equal candidates begins anew, and what is not a number is last") {
  List list(RiskMeasure::WorstCase);
  list.add(0, std::numeric_limits<double>::quiet_NaN(), 0);
  list.add(0, 2 * kEqual, 0).add(0, kEqual, 1).add(0, 0.5 * kEqual, 0.5).add(0, 0, 2);
  CHECK(list.order() == Indices{3, 2, 4, 1, 0});
}

}  // namespace
}  // namespace stillbase
