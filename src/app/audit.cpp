// stillbase audit: is the search record of a plan right?
#include <memory>

#include <fmt/format.h>

#include <stillbase/audit/audit.hpp>
#include <stillbase/core/file.hpp>
#include <stillbase/io/verification_file.hpp>

#include "app/command_line.hpp"
#include "app/judgement.hpp"

namespace stillbase::app {

namespace {

struct AuditRequest {
  std::string plan;
  OutputFile output;
  bool json = false, shows_all = false, reruns = false;
};

int audit_plan_file(const AuditRequest& request) {
  request.output.check({".json"});
  const PlanFile file = read_plan(read_text_file(request.plan), request.plan);
  VerifyOptions audit;
  audit.stop = stop_condition();
  Verification verification = audit_plan(file.plan, audit);
  if (request.reruns) add_repeated_search(file, 0, verification);
  const std::string text = verification_to_json(verification, file.computed_sha256);
  publish_verification(file.plan, verification, text,
                       {request.output, request.json, request.shows_all, "audit"});
  if (request.output.is_given()) say(fmt::format("written to {}", request.output.path));
  if (signal_exit_code() != 0) return signal_exit_code();
  return verification.pass ? kDone : kVerificationFailed;
}

}  // namespace

Command audit_command() {
  auto request = std::make_shared<AuditRequest>();
  return {
      "audit",
      "check the search record of a plan alone: candidates, continua of solutions, "
      "enclosures, bounds, counts (part of verify)",
      std::vector<Option>{
          {"plan", "PLAN.json", "plan file (JSON)", &request->plan, true},
          {"--all", "", "print every check in full", &request->shows_all},
          {"--rerun", "", "repeat the search and compare all bytes of the plan", &request->reruns},
          {"--json", "", "print the result on stdout also with -o", &request->json}} +
          output_options(request->output, "-o,--output", "verification file (JSON); else stdout"),
      [request] { return audit_plan_file(*request); }};
}

}  // namespace stillbase::app
