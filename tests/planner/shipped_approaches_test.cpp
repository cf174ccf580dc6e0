// The approaches of all shipped problems: replayed by the second implementation of the dynamics,
// and planned anew with many seeds.
#include <catch2/catch.hpp>

#include <algorithm>
#include <chrono>
#include <filesystem>

#include <fmt/format.h>

#include <stillbase/approach/approach.hpp>
#include <stillbase/collision/scene.hpp>
#include <stillbase/io/problem_file.hpp>
#include <stillbase/plan/encounter.hpp>
#include <stillbase/planner/planner.hpp>
#include <stillbase/verification/verification.hpp>

namespace stillbase {
namespace {

std::vector<std::string> problem_files() {
  std::vector<std::string> files;
  const std::filesystem::path folder = std::string(STILLBASE_SOURCE_DIR) + "/problems";
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() == ".yaml") files.push_back(entry.path().string());
  }
  std::sort(files.begin(), files.end());
  return files;
}

std::optional<TargetMotion> target_at(const CaptureProblem& problem, const Configuration& at) {
  const auto kinematics = compute_kinematics<double>(problem.robot, at.phi);
  return encounter_motion(problem, at.base * Vector3d(kinematics.r_bh), at.base.orientation,
                          at.contact_time);
}

/// Whether the straight line in joint space touches something: the robot itself, obstacles, or the
/// target where it is at the contact.
bool straight_line_collides(const CaptureProblem& problem, const Configuration& goal) {
  const CollisionScene scene(problem);
  const auto motion = target_at(problem, goal);
  const Pose target = motion ? motion->state(goal.contact_time).pose : Pose{};
  for (int i = 0; i <= 400; ++i) {
    const JointVectord phi = problem.start + i / 400.0 * (goal.phi - problem.start);
    if (scene.first_hit(compute_kinematics<double>(problem.robot, phi), goal.base,
                        motion ? &target : nullptr)) {
      return true;
    }
  }
  return false;
}

}  // namespace

TEST_CASE("every shipped approach is flown again by other dynamics and holds", "[.slow]") {
  int three_dimensional = 0, colliding = 0;
  for (const std::string& file : problem_files()) {
    const CaptureProblem problem = read_problem(file);
    if (!problem.approach.enabled) continue;
    const Plan plan = make_plan(problem);
    INFO(problem.name << ": " << plan.approach.detail);
    REQUIRE(plan.approach.status == ApproachStatus::Found);
    VerifyOptions options;
    options.post_impact = false;
    const Verification verification = verify_plan(plan, options);
    for (const Claim& claim : verification.claims) {
      INFO(claim.name << ": " << claim.value.value_or(-1) << " limit " << claim.limit << ", "
                      << claim.detail);
      CHECK(claim.pass);
    }
    const bool planar = problem.name.rfind("planar", 0) == 0;
    const bool collides = straight_line_collides(problem, plan.configuration);
    WARN(problem.name << ": straight line " << (collides ? "collides" : "is free"));
    three_dimensional += !planar;
    colliding += !planar && collides;
  }
  CHECK(2 * colliding >= three_dimensional);
}

TEST_CASE("approaches to the shipped problems' configurations are found with nearly every seed",
          "[.slow]") {
  constexpr int kSeeds = 20;
  for (const std::string& file : problem_files()) {
    const CaptureProblem problem = read_problem(file);
    const bool follows =
        problem.approach.base == BaseMode::Floating && !problem.approach.station_free;
    if (!problem.approach.enabled || follows) continue;
    const Plan plan = make_plan(problem);
    const auto motion = target_at(problem, plan.configuration);
    std::vector<double> seconds;
    int found = 0;
    for (int seed = 1; seed <= kSeeds; ++seed) {
      std::map<std::string, long> calls;
      const auto begin = std::chrono::steady_clock::now();
      const Approach approach =
          plan_approach(problem, plan.configuration, motion ? &*motion : nullptr,
                        1000 + static_cast<std::uint64_t>(seed), {}, calls);
      seconds.push_back(
          std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
      found += approach.status == ApproachStatus::Found;
    }
    std::sort(seconds.begin(), seconds.end());
    WARN(fmt::format("{:32} found {:2}/{}  median {:.3f} s  longest {:.3f} s", problem.name, found,
                     kSeeds, seconds[kSeeds / 2], seconds.back()));
    CHECK(found >= 0.95 * kSeeds);
  }
}

}  // namespace stillbase
