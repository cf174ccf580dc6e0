// How surely and how fast paths are found: every shipped problem with an approach, many seeds.
//
//   approach_bench [--seeds N] [problem.yaml ...]      default: 20 seeds, all of problems/
//
// The search runs once for each problem; what is repeated and timed is everything after it, from
// the list of candidates to the checked motion (choose_approach), in seconds of processor time of
// the one thread that works. One line of a table per problem,
// and exit code 1 when one misses its level.
#include <algorithm>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <iostream>
#include <string>
#include <vector>

#include <fmt/format.h>

#include <stillbase/core/constants.hpp>
#include <stillbase/io/problem_file.hpp>
#include <stillbase/proof/proof.hpp>

#include "planner/approach_stage.hpp"
#include "planner/candidates.hpp"
#include "planner/completeness.hpp"

namespace {

using namespace stillbase;

constexpr double kDegrees = 180 / kPi;
constexpr double kSure = 0.95;  ///< part of the seeds that must find a path

/// Seconds that the median seed may take.
double level_of(const CaptureProblem& problem) {
  if (problem.approach.base == BaseMode::ReactionNull) return 30;
  return base_follows_path(problem) ? 5 : 1;
}

std::vector<std::string> shipped_problems() {
  std::vector<std::string> files;
  const std::filesystem::path folder = std::string(STILLBASE_SOURCE_DIR) + "/problems";
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() == ".yaml") files.push_back(entry.path().string());
  }
  std::sort(files.begin(), files.end());
  return files;
}

/// One line of the table; whether the levels are reached.
bool measure(const CaptureProblem& problem, int seeds) {
  const Formulation formulation(problem);
  const CollisionJudge collisions(problem);
  SearchOptions options;
  options.optimizer = problem.search.optimizer;
  options.starts = number_of_starts(problem.search);
  options.seed = problem.search.seed;
  options.max_candidates = problem.search.max_candidates;
  SearchResult found = search(problem, formulation, options);
  collisions.judge_all(1, {}, found.candidates);
  const Proof proof = prove_solutions(default_prover(), problem, formulation, {});

  std::vector<double> seconds;
  double hand = 0, angle = 0, rotation = 0;
  int reached = 0;
  for (int seed = 1; seed <= seeds; ++seed) {
    std::map<std::string, long> calls;
    const std::clock_t begin = std::clock();
    AfterImpactJudge after(problem, {}, 1, nullptr);
    const ChosenApproach choice =
        choose_approach(problem, formulation.encounter_model(), collisions, found, proof,
                        static_cast<std::uint64_t>(seed), after, {}, calls);
    seconds.push_back(static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC);
    if (choice.approach.status != ApproachStatus::Found) continue;
    ++reached;
    hand = std::max(hand, choice.approach.hand_position_error);
    angle = std::max(angle, choice.approach.hand_angle_error);
    rotation = std::max(rotation, choice.approach.attitude_excursion);
  }
  std::sort(seconds.begin(), seconds.end());
  const double median = seconds[seconds.size() / 2];
  const bool good = reached >= kSure * seeds && median <= level_of(problem) && hand < 1e-3 &&
                    angle * kDegrees < 0.1;
  std::cout << fmt::format("| {} | {}/{} | {:.3f} | {:.3f} | {:.1e} | {:.1e} | {:.2g} | {} |\n",
                           problem.name, reached, seeds, median, seconds.back(), 1e3 * hand,
                           angle * kDegrees, rotation * kDegrees, good ? "yes" : "NO")
            << std::flush;
  return good;
}

}  // namespace

int main(int argc, char** argv) {
#ifdef STILLBASE_WITH_PROOF
  stillbase::enable_proofs();
#endif
  int seeds = 20;
  std::vector<std::string> files;
  for (int i = 1; i < argc; ++i) {
    if (std::string(argv[i]) == "--seeds" && i + 1 < argc) {
      seeds = std::max(1, std::atoi(argv[++i]));
    } else {
      files.emplace_back(argv[i]);
    }
  }
  if (files.empty()) files = shipped_problems();
  std::cout
      << "| problem | found | median, s | longest, s | hand off by, mm | deg | base rotates by up "
         "to, deg | level |\n|---|---|---|---|---|---|---|---|\n";
  bool all = true;
  for (const std::string& file : files) {
    const CaptureProblem problem = read_problem(file);
    if (problem.approach.enabled) all = measure(problem, seeds) && all;
  }
  return all ? EXIT_SUCCESS : EXIT_FAILURE;
}
