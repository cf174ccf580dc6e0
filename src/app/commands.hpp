// The subcommands, one file each.
#pragma once

#include "app/command_line.hpp"

namespace stillbase::app {

Command check_command();
Command inspect_command();
Command analyze_command();
Command plan_command();
Command simulate_command();
Command verify_command();
Command audit_command();
Command campaign_command();
Command bench_command();
Command report_command();
Command schema_command();

}  // namespace stillbase::app
