// The subcommands. Each adds itself to the parser and, when the user chose it, sets what is to run.
#pragma once

#include <functional>

#include <CLI/CLI.hpp>

namespace stillbase::app {

/// Runs the chosen subcommand and returns the exit code.
using Action = std::function<int()>;

void add_check(CLI::App& app, Action& action);
void add_inspect(CLI::App& app, Action& action);
void add_analyze(CLI::App& app, Action& action);
void add_plan(CLI::App& app, Action& action);
void add_simulate(CLI::App& app, Action& action);
void add_verify(CLI::App& app, Action& action);
void add_audit(CLI::App& app, Action& action);
void add_campaign(CLI::App& app, Action& action);
void add_bench(CLI::App& app, Action& action);
void add_report(CLI::App& app, Action& action);
void add_schema(CLI::App& app, Action& action);

}  // namespace stillbase::app
