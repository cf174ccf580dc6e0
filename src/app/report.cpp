// stillbase report: a plan or a benchmark's folder as one HTML file.
#include <filesystem>
#include <memory>

#include <fmt/format.h>

#include <stillbase/core/error.hpp>
#include <stillbase/core/file.hpp>
#include <stillbase/io/plan_file.hpp>
#include <stillbase/report/page.hpp>

#include "app/bench_folder.hpp"
#include "app/command_line.hpp"
#include "app/plan_page.hpp"
#include "io/json.hpp"

namespace stillbase::app {

namespace {

struct ReportRequest {
  std::string input;
  OutputFile output;
};

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
