#include <stillbase/io/schema.hpp>

#include <algorithm>
#include <functional>
#include <stdexcept>

#include <fmt/format.h>

#include "io/fields/describer.hpp"
#include "io/fields/replan.hpp"
#include "io/fields/results.hpp"

namespace stillbase {

namespace {

using io::Json;
using io::Table;

struct Format {
  std::string name, description;
  std::function<void(Table&)> body;
  bool is_written_by_people = false;
};

/// Those that people write first, in the order of the reference.
std::vector<Format> formats() {
  return {
      {"problem",
       "Which robot captures which target, what may be chosen, and what is asked of the choice. "
       "Keys, types, units and ranges; `stillbase check` also finds names that do not exist and "
       "fields that contradict each other.",
       [problem = CaptureProblem{}](Table& t) mutable { io::problem_fields(t, problem, {}); },
       true},
      {"target", "The body that is captured, as problem files name it (`target.file`).",
       [body = TargetBody{}](Table& t) mutable { io::target_file_fields(t, body); }, true},
      {"campaign", "What `stillbase campaign make` turns into cases.",
       [spec = CampaignSpec{}](Table& t) mutable { io::campaign_fields(t, spec); }, true},
      {"suite", "Families of capture problems for `stillbase bench`.",
       [suite = SuiteSpec{}](Table& t) mutable { io::suite_fields(t, suite, std::nullopt); }, true},
      {"state", "A state of the robot and an impulse, for `stillbase inspect`. All in B.",
       [state = RobotState{}, robot = RobotModel{}](Table& t) mutable {
         io::state_fields(t, state, &robot);
       },
       true},
      {"plan", "What `stillbase plan` writes: everything that a plan says and was made from.",
       [file = PlanFile{}](Table& t) mutable { io::plan_fields(t, file, ""); }},
      {"verification",
       "The verdict of `stillbase verify` (or `stillbase audit`) on a plan, check by check.",
       [verdict = Verification{}, sha256 = std::string(), trials = TrialResult{}](
           Table& t) mutable { io::verification_fields(t, verdict, sha256, &trials); }},
      {"inspection",
       "What `stillbase inspect --json` prints: every matrix of a robot at one state, in the base "
       "frame; matrices as lists of rows.",
       [](Table& t) {
         RobotModel base_alone;
         base_alone.base.mass = 1;
         base_alone.base.inertia = Matrix3d::Identity();
         io::inspection_fields(t, base_alone, zero_state(base_alone));
       }},
      {"analysis", "What `stillbase analyze` says of the impact in a posture (JSON).",
       [x = io::Analysis{}](Table& t) mutable { io::analysis_fields(t, x); }},
      {"simulation",
       "What `stillbase simulate --json` prints: the motion after the impact, per controller.",
       [runs = io::SimulationRuns{}](Table& t) mutable { io::simulation_fields(t, runs); }},
      {"contact_table",
       "What `stillbase simulate --contact-table --json` prints: contacts that take time beside "
       "the instantaneous impact.",
       [table = io::ContactTable{}](Table& t) mutable { io::contact_table_fields(t, table); }},
      {"prediction",
       "What `stillbase predict` says of a target over time: its state and contact features, in N.",
       [x = io::TargetPrediction{}](Table& t) mutable { io::prediction_fields(t, x); }},
      {"replan", "What `stillbase replan` says of a plan while the estimate of its target moves.",
       [x = io::ReplanRecord{}](Table& t) mutable { io::replan_fields(t, x); }},
      {"pareto", "Two quantities against each other: what `stillbase plan --pareto A,B` found.",
       [front = TradeOff{}](Table& t) mutable { io::pareto_fields(t, {}, front); }},
      {"campaign_result", "What `stillbase campaign merge` says of all trials.",
       [merged = MergedCampaign{}, groups = std::vector<io::CampaignGroup>{}](Table& t) mutable {
         io::campaign_result_fields(t, merged, groups);
       }},
      {"bench",
       "`bench.json` in the folder of a benchmark; its runs stand in records.jsonl beside it.",
       [references = BenchReferences{}](Table& t) mutable { io::bench_fields(t, references); }},
      {"best_known", "The best values known of a suite's instances, and how each was found.",
       [table = BestKnownTable{}](Table& t) mutable { io::best_known_fields(t, table); }}};
}

/// A text between the bars of a table in Markdown.
std::string cell(std::string text) {
  for (std::size_t at = 0; (at = text.find('|', at)) != std::string::npos; at += 2) {
    text.insert(at, "\\");
  }
  return text;
}

/// Heading, sentence and table of a format.
std::string section_of(const Format& format) {
  Json definitions = Json::object();
  const io::Shape shape = io::TableDescriber(definitions).describe(format.body, "");
  std::string text = fmt::format(
      "\n## {}\n\n{}\n\n| field | meaning | shape | unit, frame | range | without it |\n"
      "|---|---|---|---|---|---|\n",
      format.name, format.description);
  for (const io::FieldRow& row : shape.rows) {
    text += fmt::format("| `{}` | {} | {} | {} | {} | {} |\n", row.name.substr(1), cell(row.text),
                        row.shape, cell(row.unit), cell(row.range), cell(row.without));
  }
  return text;
}

}  // namespace

std::vector<FileFormat> file_formats() {
  std::vector<FileFormat> list;
  for (const Format& format : formats()) list.push_back({format.name, format.description});
  std::sort(list.begin(), list.end(),
            [](const FileFormat& a, const FileFormat& b) { return a.name < b.name; });
  return list;
}

std::string schema_of(const std::string& name) {
  for (const Format& format : formats()) {
    if (format.name != name) continue;
    Json definitions = Json::object();
    Json schema{{"$schema", "http://json-schema.org/draft-07/schema#"},
                {"title", "stillbase " + name},
                {"description", format.description}};
    schema.update(io::TableDescriber(definitions).describe(format.body, "").schema);
    if (!definitions.empty()) schema["definitions"] = definitions;
    return io::pretty(schema);
  }
  throw std::invalid_argument("no schema named " + name);
}

std::string field_reference(const std::string& name) {
  std::string text = fmt::format(
      "# Fields of {}\n\n"
      "Made by `stillbase schema {}--fields` from the tables that read and write the files "
      "(`src/io/fields`). Numbers without unit are SI and radians; a text with a unit is "
      "converted. Frames: N inertial, B base, T target. Shapes of lists: n one per joint, k any "
      "number. `[]` stands for every element of a list.\n",
      name.empty() ? "the file formats" : "the format " + name, name.empty() ? "" : name + " ");
  bool is_known = false;
  for (const Format& format : formats()) {
    if (name.empty() ? !format.is_written_by_people : format.name != name) continue;
    is_known = true;
    text += section_of(format);
  }
  if (!is_known) throw std::invalid_argument("no fields of " + name);
  return text;
}

}  // namespace stillbase
