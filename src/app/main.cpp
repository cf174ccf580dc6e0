// The command line of stillbase: parsing, and every error's way to its exit code.
#include <algorithm>
#include <exception>
#include <sstream>
#include <string>
#include <vector>

#include <fmt/format.h>

#include <stillbase/core/error.hpp>

#include "app/commands.hpp"
#include "app/exit_code.hpp"
#include "app/interruption.hpp"
#include "app/output.hpp"

namespace {

using namespace stillbase;
using namespace stillbase::app;

constexpr const char* kAbout =
    "stillbase plans how a free-floating space robot captures an object so that the impact leaves "
    "its base\nas still as possible, finds the way to that posture, and proves that it works.";

constexpr const char* kFooter = R"(
A first plan:
  stillbase check problems/iiwa_client_50.yaml
  stillbase plan problems/iiwa_client_50.yaml -o plan.json
  stillbase verify plan.json -o verification.json

Data goes to stdout or to the file of -o, messages go to stderr. An existing file is replaced only with --force.
Exit codes: 0 done; 1 internal error; 2 command line wrong; 3 input file refused (file:line: rule: message);
4 no configuration satisfies the constraints (the nearest attempt is written); 5 verification failed;
6 a limit was reached (the best so far is written); 7 reading or writing failed; 8 campaign incomplete;
9 a configuration, but no approach path to it; 130, 143 stopped by a signal (what was finished is saved).
Problem files are described in problems/README.md; `stillbase schema` knows the keys of every file.)";

int run(const Action& action) {
  try {
    return action();
  } catch (const InputError& error) {
    say(error.what());
    return kInputRefused;
  } catch (const FileError& error) {
    say(fmt::format("stillbase: {}", error.what()));
    return kFileFailed;
  } catch (const CommandLineError& error) {
    say(fmt::format("stillbase: {}", error.what()));
    return kCommandLine;
  } catch (const std::exception& error) {
    say(fmt::format("stillbase: internal error: {}", error.what()));
    return kInternalError;
  }
}

/// What no parser refuses by itself: empty values, and a first word that is no subcommand.
void check_arguments(const CLI::App& app, int argc, const char* const* argv) {
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument.empty()) throw CommandLineError("an argument is empty");
    if (argument.rfind("--", 0) == 0 && argument.size() > 2 && argument.back() == '=') {
      throw CommandLineError(argument + ": the value is empty");
    }
  }
  if (argc < 2 || argv[1][0] == '-') return;
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands({})) names.push_back(command->get_name());
  if (std::find(names.begin(), names.end(), argv[1]) == names.end()) {
    throw CommandLineError(
        fmt::format("there is no subcommand '{}'; there are {}", argv[1], fmt::join(names, ", ")));
  }
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(kAbout, "stillbase");
  app.set_version_flag("--version", "stillbase " STILLBASE_VERSION);
  app.footer(kFooter);
  app.require_subcommand(1);
  Action action;
  add_check(app, action);
  add_inspect(app, action);
  add_analyze(app, action);
  add_plan(app, action);
  add_simulate(app, action);
  add_verify(app, action);
  add_audit(app, action);
  add_campaign(app, action);
  add_bench(app, action);
  add_report(app, action);
  add_schema(app, action);
  return run([&] {
    check_arguments(app, argc, argv);
    try {
      app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
      const bool is_request = error.get_exit_code() == 0;  // --help, --version
      std::ostringstream out, err;
      app.exit(error, out, err);
      if (is_request) {
        write_stdout(out.str());
        return int{kDone};
      }
      say(err.str() + out.str());
      return int{kCommandLine};
    }
    catch_signals();
    return action();
  });
}
