// The searches of the shipped problems against the frozen best known values.
#include <catch2/catch.hpp>

#include <algorithm>
#include <optional>
#include <sstream>

#include <stillbase/core/file.hpp>
#include <stillbase/search/search.hpp>

#include "support/shipped_problem.hpp"

namespace stillbase {
namespace {

struct BestKnown {
  std::string problem;
  double value;
};

std::vector<BestKnown> best_known() {
  std::istringstream lines(
      read_text_file(std::string(STILLBASE_SOURCE_DIR) + "/problems/best_known.csv"));
  std::vector<BestKnown> out;
  for (std::string line; std::getline(lines, line);) {
    if (line.empty() || line[0] == '#' || line.rfind("problem,", 0) == 0) continue;
    const std::size_t comma = line.find(',');
    out.push_back({line.substr(0, comma), std::stod(line.substr(comma + 1))});
  }
  return out;
}

double best_of_search(const std::string& name, std::optional<std::uint64_t> seed = {}) {
  CaptureProblem problem = test::shipped(name);
  if (seed) problem.search.seed = *seed;
  SearchOptions options;
  options.optimizer = problem.search.optimizer;
  options.starts = number_of_starts(problem.search);
  options.is_adaptive = problem.search.starts == kAutomaticStarts;
  options.seed = problem.search.seed;
  options.max_candidates = problem.search.max_candidates;
  std::vector<std::string> features = problem.variables.features;
  if (features.empty()) features = {problem.variables.feature};
  double best = nlp::kInfinity;
  for (const std::string& feature : features) {
    problem.variables.feature = feature;
    const Formulation formulation(problem);
    for (const Candidate& candidate : search(problem, formulation, options).candidates) {
      if (candidate.max_violation <= 1e-9) best = std::min(best, candidate.value);
    }
  }
  return best;
}

void hold(const BestKnown& known, double found) {
  INFO(known.problem << ": found " << found << ", best known " << known.value);
  // With many free variables there are many minima within a few percent.
  const bool has_many =
      known.problem == "deos_client_224" || known.problem == "servicer_compromise";
  const double apart = has_many ? 0.05 : 1e-6;
  CHECK(found <= known.value * (1 + apart) + 1e-9);
  // Better than the best known: write the new one into the file.
  CHECK(found >= known.value * (1 - 1e-6) - 1e-9);
}

/// Of the seed of the problem. Over two features with a free base its starts are spread thin: two
/// or three seeds of five see the best minimum, which ones is decided by rounding.
double best_of_long_search(const std::string& problem) {
  if (problem != "deos_features") return best_of_search(problem);
  double best = nlp::kInfinity;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    best = std::min(best, best_of_search(problem, seed));
  }
  return best;
}

bool is_long(const std::string& problem) {
  return problem == "deos_client_224" || problem == "deos_features" || problem == "iiwa_case_c";
}

}  // namespace

TEST_CASE("searches reach the best known values") {
  REQUIRE(best_known().size() >= 15);
  for (const BestKnown& known : best_known()) {
    if (!is_long(known.problem)) hold(known, best_of_search(known.problem));
  }
}

TEST_CASE("the least mean over a residual velocity does not depend on the seed") {
  const std::string name = GENERATE("deos_latch_residual", "matched_residual");
  const double best = best_of_search(name);
  for (const std::uint64_t seed : {2, 3, 4}) {
    INFO(name << ", seed " << seed);
    CHECK(best_of_search(name, seed) == Approx(best).epsilon(1e-6));
  }
}

TEST_CASE("whether the best minimum is one does not depend on the seed") {
  CaptureProblem problem = test::shipped("mounted_seven_joint");
  const Formulation formulation(problem);
  for (const std::uint64_t seed : {1, 2, 3, 4, 6, 8}) {
    SearchOptions options;
    options.optimizer = problem.search.optimizer;
    options.starts = number_of_starts(problem.search);
    options.is_adaptive = problem.search.starts == kAutomaticStarts;
    options.seed = seed;
    const SearchResult result = search(problem, formulation, options);
    INFO("seed " << seed);
    CHECK(status_of(result.certificates.front()) == PlanStatus::Optimal);
  }
}

TEST_CASE("long searches reach the best known values", "[.slow]") {
  for (const BestKnown& known : best_known()) {
    if (is_long(known.problem)) hold(known, best_of_long_search(known.problem));
  }
}

}  // namespace stillbase
