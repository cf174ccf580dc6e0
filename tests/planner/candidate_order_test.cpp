// Which candidates are judged by the time after the impact, and in which order they are tried.
#include <catch2/catch.hpp>

#include <algorithm>

#include <stillbase/planner/planner.hpp>
#include <stillbase/search/search.hpp>

#include "planner/candidates.hpp"
#include "planner/self_motion.hpp"
#include "support/shipped_problem.hpp"

namespace stillbase {
namespace {

using Places = std::vector<std::size_t>;

/// Candidates of a problem, every fourth of which touches something.
struct Listed {
  CaptureProblem problem;
  std::vector<Candidate> candidates;

  explicit Listed(const std::string& name) : problem(test::shipped(name)) {
    problem.search.starts = 24;
    SearchOptions options;
    options.starts = problem.search.starts;
    candidates = search(problem, Formulation(problem), options).candidates;
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      candidates[i].collision_free = i % 4 != 1;
      candidates[i].collision = i % 4 == 1 ? "link with base" : "";
    }
  }
};

/// Those that hold, each judged alone.
Places holding_of(const Listed& listed, AfterImpactJudge& after) {
  Places out;
  for (std::size_t i = 0; i < listed.candidates.size(); ++i) {
    const Candidate& one = listed.candidates[i];
    if (one.collision_free && after.keeps_limits(one.configuration)) out.push_back(i);
  }
  return out;
}

}  // namespace

TEST_CASE("candidates are judged as far as they are asked for, whatever is judged with them") {
  bool is_left_out = false;
  for (const char* name : {"iiwa_client_50", "deos_latch", "planar_three_link_client"}) {
    INFO(name);
    const Listed listed(name);
    AfterImpactJudge alone(listed.problem, {}, 1, nullptr);
    const Places all = holding_of(listed, alone);
    for (const int jobs : {1, 3}) {
      AfterImpactJudge after(listed.problem, {}, jobs, nullptr);
      CandidateOrder order(listed.problem, listed.candidates, after);
      if (all.empty()) {
        CHECK(order.holding().empty());
        continue;
      }
      CHECK(order.holding() == Places{all.front()});
      CHECK(order.first() == all.front());

      constexpr double kFactor = 1.3;
      order.judge_good_ones(kFactor);
      std::size_t last = 0;
      for (std::size_t i = 0; i < listed.candidates.size(); ++i) {
        const Candidate& best = listed.candidates[all.front()];
        if (is_good(listed.problem, listed.candidates[i], best, kFactor)) last = i;
      }
      Places good;
      std::copy_if(all.begin(), all.end(), std::back_inserter(good),
                   [&](std::size_t i) { return i <= std::max(last, all.front()); });
      CHECK(order.holding() == good);
      is_left_out = is_left_out || good.size() < all.size();
      // Of every other one up to there the reason is known.
      for (std::size_t i = 0; i <= last; ++i) {
        const bool holds = std::find(good.begin(), good.end(), i) != good.end();
        CHECK(order.excluded().count(i) == (holds ? 0 : 1));
      }

      order.judge_all();
      CHECK(order.holding() == all);
      Places tried;
      while (const auto next = order.at(tried.size())) tried.push_back(*next);
      CHECK(Places(tried.begin(), tried.begin() + static_cast<std::ptrdiff_t>(all.size())) == all);
      CHECK(std::is_sorted(tried.begin() + static_cast<std::ptrdiff_t>(all.size()), tried.end()));
      const auto free = std::count_if(listed.candidates.begin(), listed.candidates.end(),
                                      [](const Candidate& one) { return one.collision_free; });
      CHECK(tried.size() == static_cast<std::size_t>(free));
    }
  }
  CHECK(is_left_out);
}

TEST_CASE("where nothing holds the best that touches nothing comes first") {
  Listed listed("iiwa_client_50");
  for (Joint& joint : listed.problem.robot.joints) joint.max_velocity = 1e-9;
  AfterImpactJudge after(listed.problem, {}, 1, nullptr);
  listed.candidates[0].collision_free = false;
  CandidateOrder order(listed.problem, listed.candidates, after);
  CHECK(order.holding().empty());
  CHECK(order.first() == 2);
  CHECK(order.at(0) == std::size_t{2});
  for (Candidate& candidate : listed.candidates) candidate.collision_free = false;
  CandidateOrder none(listed.problem, listed.candidates, after);
  CHECK(none.first() == 0);
  CHECK(none.at(0) == std::size_t{0});
  CHECK_FALSE(none.at(1));
}

}  // namespace stillbase
