// stillbase analyze: the impact in the start posture, in the stated direction or in many, with the
// joints resisting in different ways, and the directions that leave the base alone.
#include <memory>

#include <stillbase/io/problem_file.hpp>

#include "app/analysis.hpp"
#include "app/commands.hpp"
#include "app/exit_code.hpp"
#include "app/interruption.hpp"
#include "app/load.hpp"
#include "app/output.hpp"

namespace stillbase::app {

namespace {

struct AnalyzeRequest {
  std::string problem;
  int directions = 0;
  OutputFile output;
  bool json = false;
};

int analyze_impact(const AnalyzeRequest& request) {
  request.output.check();
  const std::string extension = extension_of(request.output.path);
  if (request.output.is_given() && extension != ".json" && extension != ".csv" &&
      extension != ".svg") {
    throw CommandLineError(request.output.path + ": the result is written as .json, .csv or .svg");
  }
  const Analysis analysis = analyse(read_problem(request.problem), request.directions);
  // A stopped sweep is saved as far as it came, but a plot of a part of the circle misleads.
  if (signal_exit_code() != 0 && extension == ".svg") return signal_exit_code();
  if (extension == ".csv") request.output.write(analysis_csv(analysis));
  if (extension == ".json") request.output.write(analysis_json(analysis));
  if (extension == ".svg") request.output.write(analysis_svg(analysis));
  if (request.json) {
    write_stdout(analysis_json(analysis));
  } else if (!request.output.is_given()) {
    write_stdout(analysis_words(analysis));
  }
  return signal_exit_code() != 0 ? signal_exit_code() : kDone;
}

}  // namespace

Command analyze_command() {
  auto request = std::make_shared<AnalyzeRequest>();
  return {"analyze",
          "what the impact does in the start posture, also over all directions in a plane",
          std::vector<Option>{
              {"problem", "PROBLEM.yaml", "problem file (YAML)", &request->problem, true},
              {"--sweep-direction", "N",
               "N directions of the impulse, evenly around the base's z axis from x",
               &request->directions, false, 1, 1'000'000},
              {"--json", "", "print one JSON object", &request->json}} +
              output_options(request->output, "-o,--output",
                             "result as .json, .csv or .svg (plot of the sweep); else tables"),
          [request] { return analyze_impact(*request); }};
}

}  // namespace stillbase::app
