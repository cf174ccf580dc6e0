#include <stillbase/audit/audit.hpp>

#include "audit/checks.hpp"
#include "audit/exclusions.hpp"

namespace stillbase {

Verification audit_plan(const Plan& plan, const VerifyOptions& options) {
  using verification::ClaimList;
  using verification::Context;
  const auto checks = [&](const Context& context, ClaimList& list) {
    list.begin(ClaimGroup::Audit);
    const auto run = [&](const char* name, auto check) {
      list.run(name, options.stop, [&] { check(context, list); });
    };
    run("candidates", [](const Context& c, ClaimList& l) {
      audit::check_candidates(c, l);
      audit::check_exclusions(c, l);
      audit::check_turns(c, l);
      audit::check_nominal_optimum(c, l);
      audit::check_choice(c, l);
    });
    run("constraints_complete", audit::check_constraint_list);
    run("kkt_residual", audit::check_stationarity);
    run("families", audit::check_continua);
    run("proof", [](const Context& c, ClaimList& l) {
      audit::check_bound(c, l);
      audit::check_proof(c, l);
      audit::check_repeated_proof(c, l);
    });
    run("consistency", audit::check_search_record);
  };
  return verification::check_plan(plan, options, checks).result(options.stop);
}

Verification judge_plan(const Plan& plan, const VerifyOptions& options) {
  Verification all = verify_plan(plan, options);
  const Verification audit = audit_plan(plan, options);
  for (const Claim& claim : audit.claims) {
    const bool is_audit =
        claim.group == ClaimGroup::Audit || claim.group == ClaimGroup::SearchRecord;
    if (is_audit) all.claims.push_back(claim);
  }
  all.pass = all.pass && audit.pass;
  all.interrupted = !all.pass && options.stop.reached();
  return all;
}

}  // namespace stillbase
