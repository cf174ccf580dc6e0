// stillbase report: a plan or a benchmark's folder as one HTML file.
#include <cmath>
#include <filesystem>
#include <memory>

#include <fmt/format.h>

#include <stillbase/core/error.hpp>
#include <stillbase/core/file.hpp>
#include <stillbase/io/plan_file.hpp>
#include <stillbase/report/page.hpp>
#include <stillbase/report/plot.hpp>

#include "app/bench_page.hpp"
#include "app/command_line.hpp"
#include "app/plan_summary.hpp"
#include "app/words.hpp"
#include "io/json.hpp"

namespace stillbase::app {

namespace {

using io::Json;

struct ReportRequest {
  std::string input;
  OutputFile output;
};

std::string number(double x) { return std::isfinite(x) ? fmt::format("{:.6g}", x) : ""; }

/// The lines that `plan --verbose` prints.
PageSection summary(const Plan& plan) {
  PageSection out;
  out.heading = "Summary";
  out.paragraphs = {plan.problem.purpose};
  out.table.header = {"topic", "result"};
  for (const SummaryLine& line : plan_summary(plan, true)) {
    out.table.rows.push_back({line.topic, line.words});
  }
  return out;
}

PageSection posture(const Plan& plan) {
  PageSection out;
  out.heading = "Posture at the contact";
  out.paragraphs = {"Base " + pose_words(plan.configuration.base) +
                    fmt::format(" at {:.6g} s.", plan.configuration.contact_time)};
  out.table.header = {"joint", "position", "rate after the impact"};
  const RobotModel& robot = plan.problem.robot;
  for (int k = 0; k < robot.n(); ++k) {
    const Joint& joint = robot.joints[static_cast<std::size_t>(k)];
    const bool slides = joint.is_prismatic();
    const double scale = slides ? 1 : kDegrees;
    out.table.rows.push_back(
        {joint.name,
         fmt::format("{:.4f} {}", scale * plan.configuration.phi[k], slides ? "m" : "deg"),
         fmt::format("{:.4f} {}", scale * plan.impact.Delta_phidot[k], slides ? "m/s" : "deg/s")});
  }
  return out;
}

PageSection constraints(const Plan& plan) {
  PageSection out;
  out.heading = "Constraints";
  out.table.header = {"name", "value", "lower", "upper", "violation"};
  for (const ConstraintValue& row : plan.constraints) {
    out.table.rows.push_back(
        {row.name, number(row.value), number(row.lower), number(row.upper), number(row.violation)});
  }
  return out;
}

PageSection candidates(const Plan& plan) {
  PageSection out;
  out.heading = "Candidates";
  const std::string unit = plan.objective.unit;
  out.table.header = {"", "posture", "nominal, " + unit, "worst case, " + unit, "collision"};
  for (std::size_t i = 0; i < plan.candidates.size(); ++i) {
    const Candidate& row = plan.candidates[i];
    out.table.rows.push_back({std::to_string(i + 1),
                              posture_words(plan.problem.robot, row.configuration.phi),
                              number(row.objective), number(row.worst_case),
                              row.collision_free ? "none" : row.collision});
  }
  return out;
}

/// One panel per kind of joint: degrees and metres share no axis.
PageSection approach(const Plan& plan) {
  PageSection out;
  out.heading = "Approach";
  const Approach& path = plan.approach;
  out.paragraphs = {
      fmt::format("{}{}{}", to_string(path.status), path.detail.empty() ? "" : ": ", path.detail)};
  if (path.times.size() < 2) return out;
  std::vector<PlotPanel> panels;
  for (const bool slides : {false, true}) {
    PlotPanel panel;
    panel.title = slides ? "Sliding joints" : "Joints";
    panel.x_label = "time (s)";
    panel.y_label = slides ? "position (m)" : "angle (deg)";
    panel.x = path.times;
    for (int k = 0; k < plan.problem.robot.n(); ++k) {
      const Joint& joint = plan.problem.robot.joints[static_cast<std::size_t>(k)];
      if (joint.is_prismatic() != slides || panel.series.size() == 18) continue;
      PlotSeries series;
      series.name = joint.name;
      for (const JointVectord& phi : path.joint_positions) {
        series.y.push_back((slides ? 1 : kDegrees) * phi[k]);
      }
      panel.series.push_back(std::move(series));
    }
    if (!panel.series.empty()) panels.push_back(std::move(panel));
  }
  if (!panels.empty()) {
    out.figures = {{"approach.svg", "Joints during the approach", plot_svg(panels)}};
  }
  return out;
}

PageSection verification(const std::string& text) {
  PageSection out;
  out.heading = "Verification";
  if (text.empty()) {
    out.paragraphs = {"The plan file contains no verification; `stillbase verify` makes one."};
    return out;
  }
  const Json json = Json::parse(text);
  const auto words = [](const Json& value) {
    return value.is_number() ? number(value.get<double>())
           : value.is_text() ? value.get<std::string>()
                             : value.dump();
  };
  out.paragraphs = {"Verdict: " + json.value("verdict", "unknown") + "."};
  out.table.header = {"check", "value", "limit", "unit", "holds", "detail"};
  for (const Json& claim : json.value("claims", Json::array())) {
    std::vector<std::string> row;
    for (const char* key : {"name", "value", "limit", "unit"}) {
      row.push_back(words(claim.value(key, Json(""))));
    }
    const Json pass = claim.value("pass", Json(false));
    row.emplace_back(pass.is_null() ? "not checked" : pass == true ? "yes" : "NO");
    row.push_back(words(claim.value("detail", Json(""))));
    out.table.rows.push_back(std::move(row));
  }
  return out;
}

/// A plan as a page. @param verification_json the object under `verification` in its file; empty:
/// none
Page plan_page(const Plan& plan, const std::string& verification_json) {
  return {"Capture plan: " + plan.problem.name,
          {summary(plan), posture(plan), constraints(plan), candidates(plan), approach(plan),
           verification(verification_json)}};
}

Page page_of_plan(const std::string& path) {
  const std::string text = read_text_file(path);
  const PlanFile file = read_plan(text, path);
  const auto json = io::Json::parse(text);  // read_plan() does not look at verdicts
  const io::Json* verdict = json.find("verification");
  const bool has_verdict = verdict != nullptr && verdict->is_object();
  try {
    return plan_page(file.plan, has_verdict ? verdict->dump() : "");
  } catch (const io::JsonError& error) {
    throw InputError({{path, 0, "wrong-type", std::string("verification: ") + error.what()}});
  }
}

int write_report(const ReportRequest& request) {
  request.output.check();
  const bool is_folder = std::filesystem::is_directory(request.input);
  const Page page =
      is_folder ? bench_folder_page(read_bench_folder(request.input)) : page_of_plan(request.input);
  request.output.write(page_to_html(page));
  if (request.output.is_given()) say(fmt::format("written to {}", request.output.path));
  return kDone;
}

}  // namespace

Command report_command() {
  auto request = std::make_shared<ReportRequest>();
  return {"report", "a plan or a benchmark's folder as one HTML file",
          std::vector<Option>{{"input", "PLAN.json|BENCH_DIR",
                               "plan file, or folder that `bench` wrote", &request->input, true}} +
              output_options(request->output, "-o,--output", "report (HTML); without it stdout"),
          [request] { return write_report(*request); }};
}

}  // namespace stillbase::app
