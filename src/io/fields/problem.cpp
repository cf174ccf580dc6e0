// A problem file: its sections in order.
#include "io/fields/sections.hpp"

namespace stillbase::io {

void problem_fields(Table& t, CaptureProblem& problem, const ProblemSources& sources) {
  const auto section = [&problem](void (*table)(Table&, CaptureProblem&)) {
    return Map([&problem, table](Table& m) { table(m, problem); }, {.is_section = true});
  };
  format_fields(t, "stillbase.problem");
  t("name", Text(problem.name), "short name", {.without = "stem of the file's name"});
  t("purpose", Text(problem.purpose), "one sentence", kNeeded);
  t("robot", Map([&](Table& m) { robot_fields(m, problem, sources); }), "", kNeeded);
  t("target",
    Map([&](Table& m) { target_fields(m, problem, sources); },
        {.is_written = problem.target.has_value()}),
    "the body that is captured; left out for a given impulse without body", {.without = "none"});
  t("impact", section(impact_fields), "", kNeeded);
  t("variables", section(variables_fields), "what the search may change; all else stays as stated");
  t("objective",
    Map([&](Table& m) { objective_fields(m, problem); }, {.alone = "quantity", .is_section = true}),
    "the quantity alone, or a map", kNeeded);
  t("hand", Map([&](Table& m) { hand_fields(m, problem.hand); }, {.is_section = true}),
    "equations on the hand");
  t("constraints", section(constraints_fields), "");
  t("uncertainty", section(uncertainty_fields), "");
  t("search", Map([&](Table& m) { search_fields(m, problem.search); }, {.is_section = true}), "");
  t("approach", section(approach_fields), "");
  t("post_impact",
    Map([&](Table& m) { post_impact_fields(m, problem.post_impact); }, {.is_section = true}), "");
  t("obstacles",
    maps_of(problem.obstacles, {.unique_key = "name"},
            Obstacle{{}, Frame::Inertial, {}, Sphere{0}}),
    "list of fixed bodies");
}

}  // namespace stillbase::io
