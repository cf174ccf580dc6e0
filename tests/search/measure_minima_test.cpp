// Which minima of a worst case a search lists.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

#include <stillbase/search/search.hpp>

#include "support/shipped_problem.hpp"

namespace stillbase {
namespace {

/// Its best minima lie at a limit of joint 2, at 2.007 rad.
bool is_off_limit(const Configuration& at) { return std::abs(at.phi[1]) < 1.9; }

/// The least value of those candidates off that limit.
double least_off_limit(const SearchResult& found) {
  double least = kInfinity;
  for (const Candidate& candidate : found.candidates) {
    if (is_off_limit(candidate.configuration)) least = std::min(least, candidate.value);
  }
  return least;
}

}  // namespace

TEST_CASE("the best minimum of a worst case is found from stated starts with any seed") {
  const CaptureProblem problem = test::shipped("iiwa_cone");
  const Formulation formulation(problem);
  SearchOptions options;
  options.starts = number_of_starts(problem.search);
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    options.seed = seed;
    INFO("seed " << seed);
    CHECK(search(problem, formulation, options).candidates.front().value ==
          Approx(0.0400123731).epsilon(1e-6));
  }
}

TEST_CASE("minima that touch nothing are listed where better ones touch something") {
  const CaptureProblem problem = test::shipped("iiwa_cone");
  const Formulation formulation(problem);
  SearchOptions options;
  options.starts = number_of_starts(problem.search);
  options.is_free = is_off_limit;
  options.minima.finished = 4;
  options.minima.finished_free = 8;
  const double with_free = least_off_limit(search(problem, formulation, options));
  CHECK(with_free == Approx(0.0430285086).epsilon(1e-6));
  options.is_free = [](const Configuration&) { return false; };
  CHECK(least_off_limit(search(problem, formulation, options)) > 1.01 * with_free);
}

}  // namespace stillbase
