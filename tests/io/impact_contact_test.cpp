// impact.contact: what a problem may ask of a contact, and what it may not.
#include <catch2/catch.hpp>

#include <unistd.h>

#include <stillbase/core/error.hpp>
#include <stillbase/io/problem_file.hpp>

#include "io/io_support.hpp"
#include "io/problem_text.hpp"

using namespace stillbase;
using namespace stillbase::io_test;

namespace {

using Changes = std::vector<std::pair<std::string, std::string>>;

CaptureProblem contact_problem(const std::string& name, const Changes& changes) {
  std::string text = file_text(source_path("problems/" + name + ".yaml"));
  for (const auto& [from, to] : changes) {
    INFO(from);
    REQUIRE(text.find(from) != std::string::npos);
    text = replaced(text, from, to);
  }
  text = replaced(text, "robots/", source_path("problems/robots/"));
  if (text.find("targets/") != std::string::npos) {
    text = replaced(text, "targets/", source_path("problems/targets/"));
  }
  const std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("stillbase_" + std::to_string(getpid()) + ".yaml");
  std::ofstream(path) << text;
  struct Removal {
    std::filesystem::path path;
    ~Removal() { std::filesystem::remove(path); }
  } removal{path};
  return read_problem(path.string());
}

std::string contact_refusal(const std::string& name, const Changes& changes) {
  try {
    (void)contact_problem(name, changes);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("a contact is read, normal without a word, and the copy says the same") {
  CHECK(contact_problem("servicer_6dof_held", {}).impulse.contact == ContactLaw::Frictionless);
  CHECK(contact_problem("spart_sticking", {}).impulse.contact == ContactLaw::Sticking);
  const CaptureProblem latch = contact_problem(
      "servicer_latch", {{"  horizon", "  model: {target_mass_scale: 0}\n  horizon"}});
  CHECK(latch.impulse.contact == ContactLaw::Latch);
  CHECK(latch.post_impact.model.target_mass_scale == 0);
  const std::string copy = problem_to_json(latch);
  CHECK(read_problem_text(copy, "copy", latch.urdf).impulse.contact == ContactLaw::Latch);
}

TEST_CASE("what a contact cannot be is refused with the reason") {
  struct Bad {
    const char* problem;
    Changes changes;
    const char* says;
  };
  const char* const objective = "objective: base_angular_momentum";
  const Bad bads[] = {
      {"servicer_latch", {{"contact: latch", "contact: glue"}}, "impact.contact"},
      {"servicer_latch", {{"contact: latch", "contact: 1"}}, "impact.contact"},
      {"servicer_latch",
       {{"contact: latch", "contact: latch\n  restitution: 0.1"}},
       "impact.restitution: is that of the contact 'normal'"},
      {"spart_sticking",
       {{"contact: sticking", "contact: sticking\n  restitution: 0.1"}},
       "impact.restitution"},
      {"spart_sticking", {{"contact: sticking", "contact: latch"}}, "a point mass offers nothing"},
      {"spart_given_push",
       {{"  source: given", "  source: given\n  contact: sticking"}},
       "a given impulse has none"},
      {"servicer_latch",
       {{"approach:\n", "uncertainty: {cone_half_angle: 5 deg}\napproach:\n"}},
       "uncertainty.cone_half_angle: the impulse of the contact 'latch' follows from the whole"},
      {"servicer_latch",
       {{"approach:\n", "uncertainty: {restitution: 0.1}\napproach:\n"}},
       "uncertainty.restitution"},
      {"servicer_latch",
       {{objective, "objective: {quantity: base_angular_momentum, measure: worst_case}"}},
       "objective.measure: 'worst_case' is that over a cone"},
      {"servicer_latch",
       {{objective, "objective: {quantity: attitude_turned, after: 2 s}"}},
       "objective.attitude_turned"},
      {"servicer_latch",
       {{"closing_speed_min", "coupling_singular_value_min: 0.1\n  closing_speed_min"}},
       "constraints.coupling_singular_value_min"},
      {"servicer_latch",
       {{"  horizon", "  contact: {model: compliant, damping: 10}\n  horizon"}},
       "post_impact.contact: a spring-damper with Coulomb friction rebounds"},
      {"servicer_6dof_held",
       {{"  horizon", "  model: {target_mass_scale: 2}\n  horizon"}},
       "post_impact.model.target_mass_scale"},
  };
  for (const Bad& bad : bads) {
    const std::string says = contact_refusal(bad.problem, bad.changes);
    INFO(bad.problem << " " << bad.says << "\n" << says);
    CHECK(says.find(bad.says) != std::string::npos);
  }
}

TEST_CASE("samples of mass, inertia, place and time are for every contact") {
  const CaptureProblem problem = contact_problem(
      "servicer_latch",
      {{"objective: base_angular_momentum",
        "objective: {quantity: base_angular_momentum, measure: expectation, samples: 8}"},
       {"approach:\n",
        "uncertainty: {target_mass: 0.1, target_inertia: 0.1, contact_point: 0.01, contact_time: "
        "0.5}\napproach:\n"}});
  CHECK(problem.measure.kind == RiskMeasure::Expectation);
}
