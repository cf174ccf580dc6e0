// stillbase report: a plan or a benchmark's folder as one HTML file.
#include <filesystem>
#include <memory>

#include <fmt/format.h>

#include <stillbase/core/error.hpp>
#include <stillbase/core/file.hpp>
#include <stillbase/io/plan_file.hpp>
#include <stillbase/report/page.hpp>

#include "app/bench_folder.hpp"
#include "app/commands.hpp"
#include "app/exit_code.hpp"
#include "app/output.hpp"
#include "app/plan_page.hpp"
#include "io/json.hpp"

namespace stillbase::app {

namespace {

struct Options {
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

int run(const Options& options) {
  options.output.check();
  const bool is_folder = std::filesystem::is_directory(options.input);
  const Page page =
      is_folder ? bench_folder_page(read_bench_folder(options.input)) : page_of_plan(options.input);
  options.output.write(page_to_html(page));
  if (options.output.is_given()) say(fmt::format("written to {}", options.output.path));
  return kDone;
}

}  // namespace

void add_report(CLI::App& app, Action& action) {
  auto options = std::make_shared<Options>();
  CLI::App* command =
      app.add_subcommand("report", "a plan or a benchmark's folder as one HTML file");
  command->add_option("input", options->input, "plan file, or folder that `bench` wrote")
      ->type_name("PLAN.json|BENCH_DIR")
      ->required();
  add_output(*command, options->output, "-o,--output", "report (HTML); without it stdout");
  command->callback([options, &action] { action = [options] { return run(*options); }; });
}

}  // namespace stillbase::app
