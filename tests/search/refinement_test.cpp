// Postures do not depend on the last digits of a solver's path.
#include <catch2/catch.hpp>

#include <stillbase/search/search.hpp>

#include "support/shipped_problem.hpp"

namespace stillbase {
namespace {

SearchResult searched(const CaptureProblem& problem, std::uint64_t seed, int starts) {
  SearchOptions options;
  options.seed = seed;
  options.starts = starts;
  options.jobs = 0;
  return search(problem, Formulation(problem), options);
}

/// How far the nearest posture of the others is: the largest difference of joint angles.
double nearest(const SearchResult& others, const Candidate& candidate) {
  double least = kInfinity;
  for (const Candidate& one : others.candidates) {
    const Eigen::VectorXd apart = one.configuration.phi - candidate.configuration.phi;
    least = std::min(least, apart.lpNorm<Eigen::Infinity>());
  }
  return least;
}

}  // namespace

TEST_CASE("a minimum that two seeds find has the same posture to rounding") {
  for (const char* name : {"iiwa_cone", "spart_given_push", "mounted_two_arms"}) {
    CAPTURE(name);
    const CaptureProblem problem = test::without_path(name);
    const SearchResult a = searched(problem, 1, 48), b = searched(problem, 2, 48);
    int common = 0;
    for (std::size_t i = 0; i < a.candidates.size(); ++i) {
      const Candidate& candidate = a.candidates[i];
      const double apart = nearest(b, candidate);
      // Listed are minima of the nominal value as well, and b has not found all that a has; one
      // that lies in a valley of steep walls may not be refined.
      if (!(a.certificates[i].kkt_residual <= 1e-11) || apart > 1e-5) continue;
      CAPTURE(candidate.value, apart);
      ++common;
      CHECK(apart <= 1e-9);
    }
    CHECK(common >= 3);
  }
}

TEST_CASE("zeros that a last digit of the target's motion leads elsewhere are the same again") {
  // In the second one solves of hundreds of evaluations lead to zeros far from each other.
  for (const auto& [name, starts, least] :
       {std::tuple("matched_light", 16, 10), std::tuple("servicer_latch", 64, 20)}) {
    CAPTURE(name);
    const CaptureProblem problem = test::without_path(name);
    CaptureProblem other = problem;
    other.target_state.linear_velocity[0] *= 1 + 3e-15;
    const SearchResult a = searched(problem, 1, starts), b = searched(other, 1, starts);
    int common = 0;
    for (const Candidate& candidate : a.candidates) {
      if (nearest(b, candidate) <= 1e-13) ++common;
    }
    CAPTURE(a.candidates.size());
    CHECK(common >= least);
    CHECK(nearest(b, a.candidates.front()) <= 1e-12);
  }
}

}  // namespace stillbase
