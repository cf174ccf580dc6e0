// stillbase check: validates files and says what was understood.
#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include <stillbase/core/error.hpp>
#include <stillbase/core/file.hpp>
#include <stillbase/io/campaign_file.hpp>
#include <stillbase/io/problem_file.hpp>
#include <stillbase/io/target_file.hpp>

#include "app/check_report.hpp"
#include "app/command_line.hpp"
#include "app/page_documents.hpp"
#include "app/window_words.hpp"
#include "formulation/variables/layout.hpp"

namespace stillbase::app {

namespace {

struct CheckRequest {
  std::vector<std::string> files;
  std::string hand;
  bool is_strict = false;
  OutputFile page;
  bool suggests_contacts = false;
};

/// Kind of file, as it says itself, and what was understood of it.
struct Report {
  std::string kind, text;
  std::vector<Finding> remarks = {};     ///< on what looks like a mistake
  std::optional<RobotModel> robot = {};  ///< that is in it
  std::optional<CaptureProblem> problem = {};
  std::vector<RobotFile> robot_files = {};  ///< that it is drawn from
};

/// @param robot the last robot before this file: a state is a state of it
Report report_on(const std::string& path, const std::string& hand,
                 std::optional<RobotModel>& robot) {
  const std::string extension = extension_of(path);
  if (extension == ".urdf" || extension == ".xml") {
    robot = load_robot(path, hand, {.may_lack_base = true, .may_lack_hand = true});
    return {"robot", robot_report(*robot), robot->remarks, robot, {}, {{path}}};
  }
  if (extension != ".yaml" && extension != ".yml" && extension != ".json") {
    throw CommandLineError(
        path + ": a robot ends in .urdf, a problem or target in .yaml, a plan or state in .json");
  }
  const std::string text = read_text_file(path);
  const std::string format = stated_format(text, path);
  if (format == "stillbase.plan") {
    const PlanFile file = load_plan(path);
    const RobotModel& planned = file.plan.problem.robot;
    return {"plan", plan_report(file), planned.remarks, planned, {}, robot_files(file, path)};
  }
  if (format == "stillbase.target") return {"target", target_report(read_target_text(text, path))};
  if (format.empty() && extension == ".json") {
    if (!robot) return {"state", lone_state_report(read_state(text, path))};
    return {"state", state_report(read_state(text, path, *robot), *robot)};
  }
  if (format == "stillbase.campaign") {
    const CampaignSpec spec = read_campaign_spec(text, path);
    return {"campaign",
            fmt::format("{} plans, {} problems, {} seeds, {} trials each", spec.plans.size(),
                        spec.problems.size(), spec.seeds.size(), spec.trials)};
  }
  if (!format.empty() && format != "stillbase.problem") {
    throw InputError({{path, 0, "format",
                       "format: is '" + format +
                           "'; known are stillbase.problem, stillbase.target, stillbase.plan and "
                           "stillbase.campaign; a state and a robot say none"}});
  }
  std::vector<Finding> remarks;
  const CaptureProblem problem = read_placed_problem(path, remarks);
  const std::string report = problem_report(problem, remarks);
  remarks.insert(remarks.end(), problem.robot.remarks.begin(), problem.robot.remarks.end());
  return {"problem",     report,  std::move(remarks),
          problem.robot, problem, robot_files(problem, path)};
}

/// The command that takes a good file further.
void print_next(const std::string& file, const Report& report) {
  const std::string& kind = report.kind;
  const std::string stem = std::filesystem::path(file).stem().string();
  if (kind == "problem") {
    const bool has_variables = VariableLayout(*report.problem).size > 0;
    say_next(has_variables ? std::vector<std::string>{"plan", file, "-o", stem + ".json"}
                           : std::vector<std::string>{"analyze", file});
  }
  if (kind == "plan") say_next({"verify", file});
  if (kind == "campaign") say_next({"campaign", "make", file, "-o", stem + ".jsonl"});
}

/// Every file is looked at, whatever is wrong with the ones before it.
int check_files(const CheckRequest& request) {
  request.page.check({".html", ".htm", ".csv", ".svg"});
  int code = kDone;
  std::vector<CheckedFile> drawn;
  std::optional<RobotModel> robot;
  for (const std::string& file : request.files) {
    try {
      const Report report = report_on(file, request.hand, robot);
      if (request.is_strict && !report.remarks.empty()) throw InputError(report.remarks);
      write_stdout(fmt::format("{}: ok, a {}\n{}\n", file, report.kind, report.text));
      if (request.files.size() == 1) print_next(file, report);
      if (report.robot) {
        drawn.push_back({file, report.text, *report.robot, report.problem, report.robot_files});
      }
      if (request.suggests_contacts && report.robot) {
        write_stdout(contact_suggestions(*report.robot));
      }
    } catch (const InputError& error) {
      say(with_lines(error).what());
      code = kInputRefused;
    } catch (const CommandLineError& error) {
      say(fmt::format("stillbase: {}", error.what()));
      if (code == kDone) code = kCommandLine;
    }
  }
  if (!request.page.is_given() || code != kDone) return code;
  if (drawn.empty()) {
    throw CommandLineError("-o: a page shows robots and problems; a plan has one by `report`");
  }
  const std::string extension = extension_of(request.page.path);
  const bool is_window = extension == ".csv" || extension == ".svg";
  if (is_window && (drawn.size() != 1 || !drawn.front().problem)) {
    throw CommandLineError("-o " + request.page.path +
                           ": contact windows are those of one problem");
  }
  request.page.write(extension == ".csv"   ? window_csv(*drawn.front().problem)
                     : extension == ".svg" ? window_svg(*drawn.front().problem)
                                           : check_page(drawn));
  say(fmt::format("written to {}", request.page.path));
  return kDone;
}

}  // namespace

Command check_command() {
  auto request = std::make_shared<CheckRequest>();
  return {
      "check",
      "validate robot, problem, target, plan or state files; print what was understood and what "
      "is suspicious",
      std::vector<Option>{
          {"files", "FILE...",
           "robots (.urdf), problems, targets, campaigns (.yaml), plans, states (.json; after a "
           "robot one of it)",
           &request->files, true},
          {"--hand", "LINK", "hand link of the robots that have several ends", &request->hand},
          {"--strict", "", "refuse what is remarked upon in a robot or problem file",
           &request->is_strict},
          {"--suggest-contacts", "",
           "sample postures: links that always touch, ready to paste, and links that never do",
           &request->suggests_contacts}} +
          output_options(
              request->page, "-o,--output",
              "page (.html) that draws the robots and problems; closing speeds of one problem's "
              "features over time as .csv or .svg"),
      [request] { return check_files(*request); }};
}

}  // namespace stillbase::app
