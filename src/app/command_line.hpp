// The command line as data: what each subcommand takes and what it runs. CLI11 reads it, in
// command_line.cpp alone.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "app/tool.hpp"

namespace stillbase::app {

/// Where an option's value is stored. The type decides what is accepted: `int`, `long` within the
/// option's range; `std::uint64_t` from 0 to 2^64 - 1; `double` finite and positive; a list of
/// texts by commas (positional: by spaces); a list of numbers of the stated `count`.
using OptionTarget =
    std::variant<bool*, std::string*, std::vector<std::string>*, int*, long*, std::uint64_t*,
                 double*, std::optional<int>*, std::optional<std::uint64_t>*, std::vector<double>*>;

/// One option or argument. Its help shows the initial value unless that is zero or empty.
struct Option {
  std::string name;   ///< "--seed", "-o,--output"; of a positional argument "problem"
  std::string value;  ///< placeholder of the value, e.g. "PROBLEM.yaml"; empty: by the type
  std::string about;
  OptionTarget target;  ///< lives as long as the command
  bool is_required = false;
  long least = 1, most = std::numeric_limits<int>::max();  ///< range of `int` and `long`
  int count = 1;                                           ///< of a list of numbers
  std::vector<std::string> excludes = {};                  ///< options that it cannot go with
  std::vector<std::string> words = {};  ///< values that the shell completes; others may be good
};

/// A subcommand.
struct Command {
  std::string name;
  std::string about;
  std::vector<Option> options;
  std::function<int()> run;               ///< after parsing; its result is the exit code
  std::vector<Command> subcommands = {};  ///< one of them is required where there are some
};

/// The names of an option, "-o" and "--output"; none of a positional argument.
std::vector<std::string> flags_of(const Option& option);

/// Options for an output file and for --force, which permits to replace it.
std::vector<Option> output_options(OutputFile& output, const std::string& name,
                                   const std::string& about);

/// Both lists in one.
std::vector<Option> operator+(std::vector<Option> a, const std::vector<Option>& b);

/// The command, and each of its subcommands, with an option --package-path, for those that read
/// robots: its folders come before those of ROS_PACKAGE_PATH, in worker processes too.
Command with_package_path(Command command);

// The subcommands, one file each.

Command new_command();
Command check_command();
Command inspect_command();
Command analyze_command();
Command plan_command();
Command simulate_command();
Command verify_command();
Command audit_command();
Command campaign_command();
Command bench_command();
Command predict_command();
Command replan_command();
Command export_command();
Command report_command();
Command schema_command();

/// What a program says of itself.
struct ProgramText {
  std::string name, version, about, footer;
};

/// Parses the arguments and runs the chosen command; --help and --version print to stdout.
/// @return the exit code
/// @throws CommandLineError for what cannot be parsed
int run_command_line(const ProgramText& program, const std::vector<Command>& commands, int argc,
                     const char* const* argv);

}  // namespace stillbase::app
