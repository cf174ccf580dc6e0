// stillbase report: plans, verifications and other results as one HTML page.
#include <memory>

#include <fmt/format.h>

#include "app/command_line.hpp"
#include "app/page_documents.hpp"

namespace stillbase::app {

namespace {

struct ReportRequest {
  std::vector<std::string> inputs;
  OutputFile output;
};

int write_report(const ReportRequest& request) {
  request.output.check({".html", ".htm"});
  request.output.write(report_page(request.inputs));
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
