// stillbase report: plans, verifications and other results as one HTML page.
#include <filesystem>
#include <memory>

#include <fmt/format.h>

#include <stillbase/core/error.hpp>
#include <stillbase/core/file.hpp>
#include <stillbase/io/plan_file.hpp>
#include <stillbase/io/target_file.hpp>
#include <stillbase/report/page.hpp>

#include "app/bench_page.hpp"
#include "app/command_line.hpp"
#include "app/page_scene.hpp"
#include "app/plan_summary.hpp"
#include "io/json.hpp"

namespace stillbase::app {

namespace {

using io::Json;

struct ReportRequest {
  std::vector<std::string> inputs;
  OutputFile output;
};

Json summary_json(const Plan& plan) {
  Json out = Json::array();
  for (const SummaryLine& line : plan_summary(plan, true)) {
    out.push_back({{"topic", line.topic}, {"words", line.words}});
  }
  return out;
}

/// A plan with what the page draws of it. `verification` stands beside it.
Json plan_document(const std::string& text, const std::string& path) {
  const PlanFile file = read_plan(text, path);
  Json content = Json::parse(text);
  Json out{{"kind", "plan"},
           {"as_written", file.is_as_written()},
           {"summary", summary_json(file.plan)},
           {"scene", plan_scene(file.plan, stop_condition())}};
  const Json* verification = content.find("verification");
  if (verification != nullptr && verification->is_object()) {
    out["verification"] = *verification;
    content.erase("verification");
  }
  out["content"] = content;
  return out;
}

Json bench_document(const std::string& folder) {
  const Page page = bench_folder_page(read_bench_folder(folder));
  Json sections = Json::array();
  for (const PageSection& section : page.sections) {
    Json figures = Json::array();
    for (const PageFigure& figure : section.figures) {
      Json series = Json::array();
      for (const PlotSeries& line : figure.panel.series) {
        series.push_back({{"name", line.name}, {"y", line.y}});
      }
      figures.push_back({{"title", figure.panel.title},
                         {"x_label", figure.panel.x_label},
                         {"y_label", figure.panel.y_label},
                         {"x", figure.panel.x},
                         {"series", series}});
    }
    sections.push_back({{"heading", section.heading},
                        {"paragraphs", section.paragraphs},
                        {"header", section.table.header},
                        {"rows", section.table.rows},
                        {"figures", figures}});
  }
  return {{"kind", "bench"}, {"title", page.title}, {"sections", sections}};
}

constexpr const char* kReadable[] = {"analysis", "campaign_result", "pareto", "verification"};

Json document_of(const std::string& path) {
  if (std::filesystem::is_directory(path)) return bench_document(path);
  const std::string text = read_text_file(path);
  const std::string format = stated_format(text, path);
  // Its reader says what a problem, or a file without format, has to do with a plan.
  if (format.empty() || format == "stillbase.plan" || format == "stillbase.problem") {
    return plan_document(text, path);
  }
  for (const char* kind : kReadable) {
    if (format == fmt::format("stillbase.{}", kind)) {
      return {{"kind", kind}, {"content", Json::parse(text)}};
    }
  }
  throw InputError({{path, 0, "format",
                     fmt::format("format: is '{}'; a page is made from a stillbase.plan, "
                                 "stillbase.{}, or a folder that `bench` wrote",
                                 format, fmt::join(kReadable, ", stillbase."))}});
}

/// The plan among the documents that a verification judges, or null.
Json* judged_plan(Json& documents, const Json& verification) {
  for (Json& document : documents) {
    if (document.at("kind").get<std::string>() != "plan" || document.contains("verification")) {
      continue;
    }
    const Json& plan = document.at("content");
    if (plan.at("content_sha256") == verification.at("content_sha256")) return &document;
  }
  return nullptr;
}

/// @throws InputError, FileError
Json documents_of(const std::vector<std::string>& paths) {
  Json documents = Json::array(), alone = Json::array();
  for (const std::string& path : paths) {
    Json document = document_of(path);
    document["path"] = path;
    const bool is_verdict = document.at("kind").get<std::string>() == "verification";
    (is_verdict ? alone : documents).push_back(document);
  }
  for (const Json& verdict : alone) {
    Json* const plan = judged_plan(documents, verdict.at("content"));
    if (plan != nullptr) {
      (*plan)["verification"] = verdict.at("content");
    } else {
      documents.push_back(verdict);
    }
  }
  return documents;
}

int write_report(const ReportRequest& request) {
  request.output.check({".html", ".htm"});
  const Json data{{"stillbase", STILLBASE_VERSION}, {"documents", documents_of(request.inputs)}};
  request.output.write(page_html(data.dump()));
  if (request.output.is_given()) say(fmt::format("written to {}", request.output.path));
  return kDone;
}

}  // namespace

Command report_command() {
  auto request = std::make_shared<ReportRequest>();
  return {"report",
          "plans with their verification, a sweep, a front, a campaign or a benchmark "
          "as one HTML page with scene and plots",
          std::vector<Option>{
              {"inputs", "FILE|BENCH_DIR...",
               "plans, verifications, results of `analyze`, `plan --pareto` and `campaign merge` "
               "(.json), folders that `bench` wrote; several plans stand side by side",
               &request->inputs, true}} +
              output_options(request->output, "-o,--output", "page (HTML); without it stdout"),
          [request] { return write_report(*request); }};
}

}  // namespace stillbase::app
