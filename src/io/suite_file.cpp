#include <algorithm>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>

#include <stillbase/core/constants.hpp>
#include <stillbase/core/file.hpp>
#include <stillbase/io/problem_file.hpp>
#include <stillbase/io/suite_file.hpp>

#include "io/field_reader.hpp"

namespace stillbase {

namespace {

using io::MapReader;
using io::Need;
using io::Node;
using io::ReadContext;

const io::Names<BenchmarkGoal>& goal_names() {
  static const io::Names<BenchmarkGoal> names = {{"nominal", BenchmarkGoal::Nominal},
                                                 {"worst_case", BenchmarkGoal::WorstCase},
                                                 {"case", BenchmarkGoal::Case}};
  return names;
}

const io::Names<Variation>& variation_names() {
  static const io::Names<Variation> names = {{"impulse_direction", Variation::ImpulseDirection},
                                             {"hand_position", Variation::HandPosition},
                                             {"target_attitude", Variation::TargetAttitude},
                                             {"target_spin", Variation::TargetSpin}};
  return names;
}

/// A list of words, one at least, each once.
template <class E>
std::vector<E> read_words(MapReader& map, const std::string& key, const io::Names<E>& names) {
  std::vector<E> out;
  const Node* list = map.child(key, Need::Required);
  if (list == nullptr) return out;
  ReadContext& context = map.context();
  if (list->kind != Node::Kind::Sequence || list->items.empty()) {
    context.add(list->line, "wrong-type",
                fmt::format("{}: must be a list of {}", map.path_of(key),
                            io::list_of(io::words_of(names))));
    return out;
  }
  for (const Node& item : list->items) {
    const auto word = io::read_text(context, item, map.path_of(key));
    if (!word || !io::check_name(context, item.line, map.path_of(key), *word, io::words_of(names),
                                 "allowed")) {
      continue;
    }
    const E value = *io::value_of(names, *word);
    if (std::find(out.begin(), out.end(), value) != out.end()) {
      context.add(item.line, "duplicate", fmt::format("{}: {} twice", map.path_of(key), *word));
    }
    out.push_back(value);
  }
  return out;
}

bool contains(const std::vector<BenchmarkGoal>& goals, BenchmarkGoal goal) {
  return std::find(goals.begin(), goals.end(), goal) != goals.end();
}

FamilySpec read_family(ReadContext& context, const Node& node, const std::string& path,
                       const std::string& folder) {
  FamilySpec out;
  MapReader map(context, node, path);
  map.text("name", out.name, Need::Required);
  std::string file;
  if (map.text("problem", file, Need::Required)) {
    out.problem = read_problem((std::filesystem::path(folder) / file).string());
  }
  out.goals = read_words(map, "goals", goal_names());
  out.vary = read_words(map, "vary", variation_names());
  map.choice("case", out.impact_case, io::case_constraint_names(),
             contains(out.goals, BenchmarkGoal::Case) ? Need::Required : Need::Optional);
  const Node* angle =
      map.child("cone_half_angle",
                contains(out.goals, BenchmarkGoal::WorstCase) ? Need::Required : Need::Optional);
  if (angle != nullptr) {
    const auto value =
        io::read_number(context, *angle, map.path_of("cone_half_angle"), io::Dimension::Angle,
                        {.lower = 0, .upper = 1.5707963267948966, .is_lower_open = true});
    if (value) out.cone_half_angle = *value;
  }
  if (const Node* turn = map.child("free_attitude")) {
    const auto value =
        io::read_number(context, *turn, map.path_of("free_attitude"), io::Dimension::Angle,
                        {.lower = 0, .upper = kPi, .is_lower_open = true});
    if (value) out.free_attitude = *value;
  }
  map.number("free_contact_time", out.free_contact_time, io::Dimension::Time, io::kNonNegative);
  map.integer("instances", out.instances, 1, 1000);
  map.finish();
  return out;
}

}  // namespace

SuiteSpec read_suite(const std::string& path) {
  const std::string text = read_text_file(path, io::DocumentLimits{}.bytes);
  ReadContext context{path, {}, {}};
  const Node root = io::parse_document(text, context);
  const std::string folder = std::filesystem::path(path).parent_path().string();
  SuiteSpec out;
  MapReader map(context, root, "");
  std::string format;
  if (map.text("format", format, Need::Required) && format != "stillbase.suite") {
    context.add(map.line_of("format"), "wrong-format", "format: must be stillbase.suite");
  }
  int version = 1;
  map.integer("version", version, 1, 1, Need::Required);
  map.number("gradient_cost", out.gradient_cost, io::Dimension::None, io::kNonNegative,
             Need::Required);
  const auto beside = [&folder](const std::string& file) {
    return (std::filesystem::path(folder) / file).lexically_normal().string();
  };
  std::string best_known;
  if (map.text("best_known", best_known)) out.best_known = beside(best_known);
  if (const Node* list = map.child("approaches")) {
    if (list->kind != Node::Kind::Sequence) {
      context.add(list->line, "wrong-type", "approaches: must be a list of problem files");
    }
    for (const Node& item : list->items) {
      const auto file = io::read_text(context, item, "approaches");
      if (file) out.approaches.push_back(beside(*file));
    }
  }
  const Node* families = map.child("families", Need::Required);
  if (families != nullptr && families->kind != Node::Kind::Sequence) {
    context.add(families->line, "wrong-type", "families: must be a list");
  } else if (families != nullptr) {
    for (std::size_t i = 0; i < families->items.size(); ++i) {
      out.families.push_back(
          read_family(context, families->items[i], fmt::format("families[{}]", i), folder));
    }
  }
  map.finish();
  context.throw_if_any();
  return out;
}

}  // namespace stillbase
