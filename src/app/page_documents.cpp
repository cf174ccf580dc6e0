#include "app/page_documents.hpp"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

#include <stillbase/core/error.hpp>
#include <stillbase/core/file.hpp>
#include <stillbase/io/plan_file.hpp>
#include <stillbase/io/target_file.hpp>
#include <stillbase/report/page.hpp>

#include "app/bench_page.hpp"
#include "app/page_scene.hpp"
#include "app/plan_summary.hpp"
#include "app/tool.hpp"

namespace stillbase::app {

namespace {

using io::Json;

Json summary_json(const Plan& plan) {
  Json out = Json::array();
  for (const SummaryLine& line : plan_summary(plan, true)) {
    out.push_back({{"topic", line.topic}, {"words", line.words}});
  }
  return out;
}

/// A plan with what the page draws of it. `verification` stands beside it; the samples of the
/// approach are those of the scene alone.
Json plan_document(const std::string& text, const std::string& path) {
  const PlanFile file = read_plan(text, path);
  Json content = Json::parse(text);
  Json scene = plan_scene(file.plan, stop_condition());
  scene["robot"]["visuals"] = visuals_json(file.plan.problem.robot, robot_files(file, path));
  Json out{{"kind", "plan"},
           {"as_written", file.is_as_written()},
           {"summary", summary_json(file.plan)},
           {"scene", scene}};
  const Json* verification = content.find("verification");
  if (verification != nullptr && verification->is_object()) {
    out["verification"] = *verification;
    content.erase("verification");
  }
  for (const char* column : {"times", "joint_positions", "joint_velocities", "joint_accelerations",
                             "joint_torques", "base_poses", "base_velocities"}) {
    content["approach"].erase(column);
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
        Json entry{{"name", line.name}, {"y", line.y}};
        if (!line.low.empty()) entry["band"] = {{"low", line.low}, {"high", line.high}};
        series.push_back(std::move(entry));
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

bool is_plan(const Json& document) { return document.at("kind").get<std::string>() == "plan"; }

/// The plan among the documents that a verification judges, by the fingerprint that it states, or
/// null. A page says where that one does not fit.
Json* judged_plan(Json& documents, const std::string& sha256) {
  for (Json& document : documents) {
    if (!is_plan(document)) continue;
    const Json& plan = document.at("content");
    if (plan.at("content_sha256").get<std::string>() == sha256) return &document;
  }
  return nullptr;
}

/// The verdict of a verification follows from its checks, and it is of a plan that is there where
/// there are plans.
/// @param path of its file
void require_consistent(const Json& verification, const std::string& path, Json& documents) {
  const auto refuse = [&path](const char* rule, const std::string& message) {
    throw InputError({{path, 0, rule, message}});
  };
  try {
    int failed = 0, held = 0;
    const Json& claims = verification.at("claims");
    for (std::size_t i = 0; i < claims.size(); ++i) {
      const Json& pass = claims.at(i).at("pass");
      if (pass.is_null()) continue;
      ++(pass.get<bool>() ? held : failed);
    }
    const bool is_cut =
        verification.contains("interrupted") && verification.at("interrupted").get<bool>();
    const bool is_pass = verification.at("verdict").get<std::string>() == "pass";
    if (is_pass && (failed > 0 || held == 0 || is_cut)) {
      refuse("contradiction",
             fmt::format("verdict: is 'pass', but {} checks fail and {} hold{}; verify the plan "
                         "again",
                         failed, held, is_cut ? ", and it was interrupted" : ""));
    }
    if (!is_pass && failed == 0 && held > 0 && !is_cut) {
      refuse("contradiction", "verdict: is not 'pass', but no check fails; verify the plan again");
    }
    const std::string sha256 = verification.at("content_sha256").get<std::string>();
    const bool has_plans = std::any_of(documents.begin(), documents.end(), is_plan);
    if (has_plans && judged_plan(documents, sha256) == nullptr) {
      refuse("other-plan",
             fmt::format("content_sha256: {} is of none of the plans given; verify the plan, or "
                         "leave this verification out",
                         sha256));
    }
  } catch (const io::JsonError& error) {
    refuse("not-verification", std::string("format: ") + error.what());
  }
}

Json documents_of(const std::vector<std::string>& paths) {
  Json documents = Json::array(), alone = Json::array();
  for (const std::string& path : paths) {
    Json document = document_of(path);
    document["path"] = path;
    const bool is_verdict = document.at("kind").get<std::string>() == "verification";
    (is_verdict ? alone : documents).push_back(document);
  }
  for (Json& document : documents) {
    if (!is_plan(document) || !document.contains("verification")) continue;
    Json itself = Json::array();
    itself.push_back(document);
    require_consistent(document.at("verification"), document.at("path").get<std::string>(), itself);
  }
  for (const Json& verdict : alone) {
    const Json& content = verdict.at("content");
    require_consistent(content, verdict.at("path").get<std::string>(), documents);
    Json* const plan = judged_plan(documents, content.at("content_sha256").get<std::string>());
    if (plan != nullptr && !plan->contains("verification")) {
      (*plan)["verification"] = content;
    } else {
      documents.push_back(verdict);
    }
  }
  return documents;
}

/// The page around its documents.
std::string page_of(const Json& documents) {
  const Json data{{"stillbase", STILLBASE_VERSION}, {"documents", documents}};
  return page_html(data.dump());
}

}  // namespace

std::string report_page(const std::vector<std::string>& paths) {
  return page_of(documents_of(paths));
}

std::string check_page(const std::vector<CheckedFile>& files) {
  Json documents = Json::array();
  for (const CheckedFile& file : files) {
    const bool is_robot = !file.problem;
    Json scene = is_robot ? lone_robot_scene(file.robot) : problem_scene(*file.problem);
    scene["robot"]["visuals"] = visuals_json(file.robot, file.robot_files);
    documents.push_back({{"kind", is_robot ? "robot" : "problem"},
                         {"path", file.path},
                         {"title", is_robot ? file.robot.name : file.problem->name},
                         {"words", file.words},
                         {"scene", scene}});
  }
  return page_of(documents);
}

}  // namespace stillbase::app
