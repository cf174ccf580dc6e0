// Verification: a plan passes, and one with a millionth more impulse does not.
//
//   as planned: pass
//   impulse altered: fail (the first check that does not hold)
//
// Run from the root of the repository.
#include <cstdio>
#include <filesystem>

#include <stillbase/stillbase.hpp>

namespace {

/// Prints the verdict on a plan and the first check that fails.
bool passes(const char* what, const stillbase::Plan& plan) {
  const stillbase::Verification verification = stillbase::verify_plan(plan);
  std::printf("%s: %s", what, verification.pass ? "pass" : "fail");
  for (const stillbase::Claim& check : verification.claims) {
    if (check.pass) continue;
    std::printf(" (%s)", check.name.c_str());
    break;
  }
  std::printf("\n");
  return verification.pass;
}

}  // namespace

int main() {
  using namespace stillbase;
  const CaptureProblem problem = read_problem("problems/planar_three_link_client.yaml");

  // A plan file contains the problem and the robot; reading it back gives the same plan.
  const std::string path = (std::filesystem::temp_directory_path() / "06_verify.json").string();
  write_plan(make_plan(problem), path);
  Plan plan = load_plan(path).plan;
  std::filesystem::remove(path);

  const bool is_good = passes("as planned", plan);
  plan.impact.Fbar *= 1 + 1e-6;
  const bool is_altered_good = passes("impulse altered", plan);
  return is_good && !is_altered_good ? 0 : 1;
}
