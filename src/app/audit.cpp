// stillbase audit: is the search record of a plan right?
#include <memory>

#include <fmt/format.h>

#include <stillbase/audit/audit.hpp>
#include <stillbase/core/file.hpp>
#include <stillbase/io/verification_file.hpp>

#include "app/commands.hpp"
#include "app/exit_code.hpp"
#include "app/interruption.hpp"
#include "app/judgement.hpp"
#include "app/output.hpp"

namespace stillbase::app {

namespace {

struct Options {
  std::string plan;
  OutputFile output;
  bool json = false;
};

int run(const Options& options) {
  options.output.check();
  const PlanFile file = read_plan(read_text_file(options.plan), options.plan);
  VerifyOptions audit;
  audit.stop = stop_condition();
  const Verification verification = audit_plan(file.plan, audit);
  const std::string text = verification_to_json(verification, file.computed_sha256);
  options.output.write(text);
  if (options.json && options.output.is_given()) write_stdout(text);
  print_checks(file.plan, verification);
  print_verdict(verification, "audit");
  if (options.output.is_given()) say(fmt::format("written to {}", options.output.path));
  if (signal_exit_code() != 0) return signal_exit_code();
  return verification.pass ? kDone : kVerificationFailed;
}

}  // namespace

void add_audit(CLI::App& app, Action& action) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand(
      "audit",
      "check the search record of a plan alone: candidates, continua of solutions, "
      "enclosures, bounds, counts (part of verify)");
  command->add_option("plan", options->plan, "plan file (JSON)")
      ->type_name("PLAN.json")
      ->required();
  add_output(*command, options->output, "-o,--output", "verification file (JSON); else stdout");
  command->add_flag("--json", options->json, "print the result on stdout also with -o");
  command->callback([options, &action] { action = [options] { return run(*options); }; });
}

}  // namespace stillbase::app
