// Samples of the self-motion at the contact, and a plan that ends at one.
#include <catch2/catch.hpp>

#include <stillbase/planner/planner.hpp>
#include <stillbase/search/search.hpp>
#include <stillbase/verification/verification.hpp>

#include "planner/approach_stage.hpp"
#include "planner/candidates.hpp"
#include "planner/self_motion.hpp"
#include "support/shipped_problem.hpp"

namespace stillbase {
namespace {

using test::shipped;

SearchResult searched(const CaptureProblem& problem) {
  SearchOptions options;
  options.starts = 16;
  return search(problem, Formulation(problem), options);
}

}  // namespace

TEST_CASE("samples of the self-motion hold the hand, are as good as asked and differ") {
  const CaptureProblem problem = shipped("iiwa_client_50");
  const Formulation formulation(problem);
  const SearchResult found = searched(problem);
  const Candidate& best = found.candidates.front();
  const auto samples =
      self_motion_samples(problem, formulation, {found.points.front()}, best, 1.5, 12, {});
  REQUIRE(samples.size() >= 3);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const CertifiedCandidate at =
        certify_candidate(problem, formulation, samples[i], best, found.certificates.front());
    CHECK(at.candidate.max_violation <= 1e-9);
    CHECK(is_good(problem, at.candidate, best, 1.5));
    CHECK((at.candidate.configuration.phi - best.configuration.phi).norm() > 0.19);
    for (std::size_t j = 0; j < i; ++j) CHECK((samples[i] - samples[j]).norm() > 0.19);
  }
  CHECK(
      self_motion_samples(problem, formulation, {found.points.front()}, best, 1.5, 0, {}).empty());
}

TEST_CASE("a posture without self-motion has no samples") {
  const CaptureProblem problem = shipped("planar_two_link_c2_b");
  const SearchResult found = searched(problem);
  CHECK(self_motion_samples(problem, Formulation(problem), {found.points.front()},
                            found.candidates.front(), 1.5, 8, {})
            .empty());
}

}  // namespace stillbase
