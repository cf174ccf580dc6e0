// stillbase analyze: the impact in the start posture, in the stated direction or in many, with the
// joints resisting in different ways, and the directions that leave the base alone.
#include <stillbase/io/problem_file.hpp>

#include "app/analysis.hpp"
#include "app/commands.hpp"
#include "app/exit_code.hpp"
#include "app/interruption.hpp"
#include "app/load.hpp"
#include "app/output.hpp"

namespace stillbase::app {

namespace {

struct Options {
  std::string problem;
  int directions = 0;
  OutputFile output;
  bool json = false;
};

int run(const Options& options) {
  options.output.check();
  const std::string extension = extension_of(options.output.path);
  if (options.output.is_given() && extension != ".json" && extension != ".csv" &&
      extension != ".svg") {
    throw CommandLineError(options.output.path + ": the result is written as .json, .csv or .svg");
  }
  const Analysis analysis = analyse(read_problem(options.problem), options.directions);
  // A stopped sweep is saved as far as it came, but a plot of a part of the circle misleads.
  if (signal_exit_code() != 0 && extension == ".svg") return signal_exit_code();
  if (extension == ".csv") options.output.write(analysis_csv(analysis));
  if (extension == ".json") options.output.write(analysis_json(analysis));
  if (extension == ".svg") options.output.write(analysis_svg(analysis));
  if (options.json) {
    write_stdout(analysis_json(analysis));
  } else if (!options.output.is_given()) {
    write_stdout(analysis_words(analysis));
  }
  return signal_exit_code() != 0 ? signal_exit_code() : kDone;
}

}  // namespace

void add_analyze(CLI::App& app, Action& action) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand(
      "analyze", "what the impact does in the start posture, also over all directions in a plane");
  command->add_option("problem", options->problem, "problem file (YAML)")
      ->type_name("PROBLEM.yaml")
      ->required();
  command
      ->add_option("--sweep-direction", options->directions,
                   "N directions of the impulse, evenly around the base's z axis from x")
      ->type_name("N")
      ->check(CLI::Range(1, 1'000'000));
  add_output(*command, options->output, "-o,--output",
             "result as .json, .csv or .svg (plot of the sweep); else tables");
  command->add_flag("--json", options->json, "print one JSON object");
  command->callback([options, &action] { action = [options] { return run(*options); }; });
}

}  // namespace stillbase::app
