// The robust optimum of random problems that nobody tuned for does not depend on the seed.
#include <catch2/catch.hpp>

#include <stillbase/search/search.hpp>

#include "support/random_capture.hpp"

namespace stillbase {
namespace {

/// Least worst cases known of random_capture(0) to (39), in the objective's unit: over all seeds
/// and starts that were tried, about 2000 starts each and several times that where seeds differed.
constexpr double kBestKnown[] = {
    0.090836883,   0.071027855,   0.027705063,   0.00072328177, 0.13949964,   0.00047906296,
    0.00014198426, 0.011671482,   0.016159063,   0.00080773145, 0.014232131,  4.1529463e-05,
    7.4159896e-06, 0.17838228,    0.0013029372,  0.00016821571, 0.089929865,  0.042085001,
    0.0016647157,  7.9554144e-07, 0.089642755,   0.018247148,   0.12640491,   0.012235133,
    0.35943711,    0.03285021,    6.9087043e-07, 0.20462726,    0.0026020611, 0.0037003872,
    0.016044564,   9.6288767e-05, 0.00059460586, 0.011111521,   0.10748445,   0.0018307396,
    0.0031834081,  0.00033963709, 0.0059291556,  0.0405284,
};

double least_worst_case(std::uint64_t number, std::uint64_t seed) {
  const CaptureProblem problem = random_capture(number);
  SearchOptions options;
  options.is_adaptive = true;
  options.seed = seed;
  const SearchResult found = search(problem, Formulation(problem), options);
  REQUIRE(found.status == PlanStatus::Feasible);
  return found.candidates.front().value;
}

/// How many of the seeds from 1 on end within 1 % of the best known.
int seeds_near_best(std::uint64_t number, int seeds) {
  int near = 0;
  for (int seed = 1; seed <= seeds; ++seed) {
    const double found = least_worst_case(number, static_cast<std::uint64_t>(seed));
    INFO("problem " << number << ", seed " << seed);
    // Better than the best known: write the new one into the table.
    CHECK(found >= kBestKnown[number] * (1 - 1e-5));
    if (found <= 1.01 * kBestKnown[number]) ++near;
  }
  return near;
}

}  // namespace

TEST_CASE("the robust optimum of random problems does not depend on the seed") {
  for (const std::uint64_t number : {11, 14, 15}) {
    INFO("problem " << number);
    CHECK(seeds_near_best(number, 3) == 3);
  }
}

// build/ci/tests/test_search "the robust optimum of 40 random problems*"
TEST_CASE("the robust optimum of 40 random problems does not depend on the seed", "[.slow]") {
  constexpr int kSeeds = 20;
  for (std::uint64_t number = 0; number < std::size(kBestKnown); ++number) {
    INFO("problem " << number);
    CHECK(seeds_near_best(number, kSeeds) >= kSeeds - 1);
  }
}

TEST_CASE("a worst case that one start alone reached is stated as seldom reached") {
  const CaptureProblem problem = random_capture(14);
  SearchOptions options;
  options.is_adaptive = true;
  options.minima.first = 1;
  options.minima.most_rounds = 0;
  const SearchResult few = search(problem, Formulation(problem), options);
  CHECK(few.had_rounds);
  CHECK(few.unseen > kUnseenLevel);
  options.minima = {};
  CHECK(search(problem, Formulation(problem), options).unseen <= kUnseenLevel);
}

}  // namespace stillbase
