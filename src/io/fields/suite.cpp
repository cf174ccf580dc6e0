// Benchmark suites.
#include <algorithm>
#include <filesystem>

#include <stillbase/core/file.hpp>
#include <stillbase/io/benchmark_file.hpp>
#include <stillbase/io/problem_file.hpp>

#include "io/fields/sections.hpp"

namespace stillbase {

namespace io {

namespace {

constexpr auto kVariationNames =
    names<Variation>({{"impulse_direction", Variation::ImpulseDirection},
                      {"hand_position", Variation::HandPosition},
                      {"target_attitude", Variation::TargetAttitude},
                      {"target_spin", Variation::TargetSpin}});

/// A list of words, one at least, each once.
template <class E, class Names>
List<E> words_value(std::vector<E>& list, const Names& names) {
  return List<E>(list, [names](E& word) { return Word(word, names); },
                 {.least = 1, .is_unique = true, .of = "words"});
}

std::string beside(const std::optional<std::string>& folder, const std::string& file) {
  return folder ? (std::filesystem::path(*folder) / file).lexically_normal().string() : file;
}

void family_fields(Table& t, FamilySpec& family, const std::optional<std::string>& folder) {
  const auto has = [&family](BenchmarkGoal goal) {
    return std::find(family.goals.begin(), family.goals.end(), goal) != family.goals.end()
               ? Need::Required
               : Need::Optional;
  };
  std::string problem;
  t("name", Text(family.name), "short name", kNeeded);
  t("problem", Text(problem), "the base problem, relative to this file", kNeeded);
  if (t.reader() != nullptr && folder && !problem.empty()) {
    family.problem = read_problem((std::filesystem::path(*folder) / problem).string());
  }
  t("goals", words_value(family.goals, names_up_to(BenchmarkGoal::Case)),
    "what is minimised or asked for", kNeeded);
  t("vary", words_value(family.vary, kVariationNames), "what the seed of an instance changes",
    kNeeded);
  t("case", Word(family.impact_case, kCaseConstraintNames), "of the goal `case`, which needs it",
    {.need = has(BenchmarkGoal::Case)});
  t("cone_half_angle",
    Number(family.cone_half_angle, Dimension::Angle,
           {.lower = 0, .upper = kPi / 2, .is_lower_open = true}),
    "of the goal `worst_case`, which needs it", {.need = has(BenchmarkGoal::WorstCase)});
  t("free_attitude",
    Number(family.free_attitude, Dimension::Angle,
           {.lower = 0, .upper = kPi, .is_lower_open = true}),
    "the base may rotate by this angle, too");
  t("free_contact_time", Number(family.free_contact_time, Dimension::Time, kWait),
    "the contact may be this much earlier or later, too");
  t("instances", Integer(family.instances, 1, 1000), "per goal");
}

}  // namespace

void suite_fields(Table& t, SuiteSpec& suite, const std::optional<std::string>& folder) {
  format_fields(t, "stillbase.suite");
  t("gradient_cost", Number(suite.gradient_cost, kLarge), "cost of a gradient in evaluations",
    kNeeded);
  t("best_known", Text(suite.best_known), "file with the best known values, relative to this file",
    {.without = "none"});
  t("approaches", Texts(suite.approaches, {.of = "problem files"}),
    "problem files of `bench --planners`");
  t("families",
    List(suite.families,
         [&folder](FamilySpec& family) {
           return Map([&](Table& m) { family_fields(m, family, folder); });
         }),
    "families of capture problems", kNeeded);
  if (t.reader() == nullptr) return;
  if (!suite.best_known.empty()) suite.best_known = beside(folder, suite.best_known);
  for (std::string& path : suite.approaches) path = beside(folder, path);
}

}  // namespace io

SuiteSpec read_suite(const std::string& path) {
  SuiteSpec suite;
  const std::string folder = std::filesystem::path(path).parent_path().string();
  io::read_map(read_text_file(path, io::DocumentLimits{}.bytes), path,
               [&](io::Table& t) { io::suite_fields(t, suite, folder); });
  return suite;
}

}  // namespace stillbase
