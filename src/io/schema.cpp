#include <stillbase/io/schema.hpp>

#include <algorithm>
#include <functional>
#include <map>
#include <stdexcept>

#include <fmt/format.h>

#include "io/fields/describer.hpp"
#include "io/fields/plan.hpp"
#include "io/schema_texts.hpp"

namespace stillbase {

namespace {

using io::Json;
using io::Table;

constexpr std::string_view kEnding = ".schema.json";

/// A format whose fields stand in a table.
struct TableFormat {
  std::string name, description;
  std::function<void(Table&)> body;
};

std::vector<TableFormat> table_formats() {
  static const RobotModel kNoRobot{};
  return {
      {"problem",
       "Which robot captures which target, what may be chosen, and what is asked of the choice. "
       "Keys, types, units and ranges; `stillbase check` also finds names that do not exist and "
       "fields that contradict each other.",
       [problem = CaptureProblem{}](Table& t) mutable { io::problem_fields(t, problem, {}); }},
      {"target", "The body that is captured, as problem files name it (`target.file`).",
       [body = TargetBody{}](Table& t) mutable { io::target_file_fields(t, body); }},
      {"campaign", "What `stillbase campaign make` turns into cases.",
       [spec = CampaignSpec{}](Table& t) mutable { io::campaign_fields(t, spec); }},
      {"suite", "Families of capture problems for `stillbase bench`.",
       [suite = SuiteSpec{}](Table& t) mutable { io::suite_fields(t, suite, std::nullopt); }},
      {"state", "A state of the robot and an impulse, for `stillbase inspect`. All in B.",
       [state = RobotState{}](Table& t) mutable { io::state_fields(t, state, &kNoRobot); }},
      {"plan", "What `stillbase plan` writes: everything that a plan says and was made from.",
       [file = PlanFile{}, verdict = std::string()](Table& t) mutable {
         io::plan_fields(t, file, verdict);
       }}};
}

std::map<std::string, Json> file_documents() {
  std::map<std::string, Json> documents;
  for (const io::SchemaText& entry : io::schema_texts()) {
    documents[std::string(entry.file)] = Json::parse(entry.text);
  }
  return documents;
}

/// What several formats share: of the tables, and of the file definitions.json.
Json shared_definitions(const std::map<std::string, Json>& documents) {
  Json definitions = documents.at("definitions.json");
  for (const auto& [file, document] : documents) {
    if (const Json* own = document.find("definitions")) definitions.update(*own);
  }
  for (const TableFormat& format : table_formats()) {
    io::TableDescriber(definitions).describe(format.body, "");
  }
  ImpactSummary impact;
  double direction = 0;
  bool is_illustrative = false;
  io::Map(
      [&](Table& t) {
        t("direction_deg", io::Number(direction), "of the impulse, from x of B about z, in deg");
        t("illustrative", io::Flag(is_illustrative), "the resistance is an example");
        io::impact_object_fields(t, impact, RobotModel{});
      },
      {.name = "impact_entry"})
      .shape(definitions);
  return definitions;
}

/// Schemas refer to "#/definitions/name", "definitions.json#/name" or "name.schema.json". Here what
/// one of them uses becomes a definition of its own.
class Bundle {
 public:
  explicit Bundle(Json document) {
    document.erase("definitions");
    out_ = rewritten(std::move(document));
    if (!definitions_.empty()) out_["definitions"] = definitions_;
  }
  const Json& document() const { return out_; }

 private:
  Json rewritten(Json json) {
    if (const Json* reference = json.find("$ref")) {
      const std::string text = reference->get<std::string>();
      const std::size_t slash = text.rfind('/');
      const bool is_file = slash == std::string::npos;
      const std::string name = is_file ? text.substr(0, text.find('.')) : text.substr(slash + 1);
      if (!definitions_.contains(name)) {
        definitions_[name] = nullptr;  // definitions may refer to each other
        Json piece = is_file ? documents_.at(text) : shared_.at(name);
        piece.erase("$schema");
        piece.erase("definitions");
        Json definition = rewritten(std::move(piece));
        definitions_[name] = std::move(definition);
      }
      return {{"$ref", "#/definitions/" + name}};
    }
    for (Json& part : json) {
      if (part.is_structured()) part = rewritten(part);
    }
    return json;
  }

  const std::map<std::string, Json> documents_ = file_documents();
  const Json shared_ = shared_definitions(documents_);
  Json definitions_ = Json::object();
  Json out_;
};

}  // namespace

std::vector<FileFormat> file_formats() {
  std::vector<FileFormat> formats;
  for (const TableFormat& format : table_formats()) {
    formats.push_back({format.name, format.description});
  }
  for (const auto& [file, document] : file_documents()) {
    const std::size_t ending = file.find(kEnding);
    if (ending == std::string::npos) continue;  // what several share
    formats.push_back({file.substr(0, ending), document.at("description").get<std::string>()});
  }
  std::sort(formats.begin(), formats.end(),
            [](const FileFormat& a, const FileFormat& b) { return a.name < b.name; });
  return formats;
}

std::string schema_of(const std::string& name) {
  for (const TableFormat& format : table_formats()) {
    if (format.name != name) continue;
    Json definitions = Json::object();
    Json schema{{"$schema", "http://json-schema.org/draft-07/schema#"},
                {"title", "stillbase " + name},
                {"description", format.description}};
    schema.update(io::TableDescriber(definitions).describe(format.body, "").schema);
    return io::pretty(Bundle(schema).document());
  }
  const auto documents = file_documents();
  const auto found = documents.find(name + std::string(kEnding));
  if (found == documents.end()) throw std::invalid_argument("no schema named " + name);
  return io::pretty(Bundle(found->second).document());
}

std::string field_reference() {
  std::string text =
      "# Fields of the file formats\n\n"
      "Made by `stillbase schema --fields` from the tables that read and write the files "
      "(`src/io/fields`). Numbers without unit are SI and radians; a text with a unit is "
      "converted. Frames: N inertial, B base, T target. `[]` stands for every element of a list.\n";
  for (const TableFormat& format : table_formats()) {
    Json definitions = Json::object();
    const io::Shape shape = io::TableDescriber(definitions).describe(format.body, "");
    text += fmt::format(
        "\n## {}\n\n{}\n\n| field | meaning | unit, frame | range | without it |\n"
        "|---|---|---|---|---|\n",
        format.name, format.description);
    for (const io::FieldRow& row : shape.rows) {
      text += fmt::format("| `{}` | {} | {} | {} | {} |\n", row.name.substr(1), row.text, row.unit,
                          row.range, row.without);
    }
  }
  return text;
}

}  // namespace stillbase
