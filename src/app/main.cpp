// The tool: its subcommands, and the exit code of every kind of error.
#include <exception>

#include <fmt/format.h>

#include <stillbase/core/error.hpp>
#include <stillbase/proof/proof.hpp>

#include "app/command_line.hpp"
#include "app/help.hpp"

namespace stillbase::app {

namespace {

constexpr const char* kAbout =
    "stillbase plans how a free-floating space robot captures a target so that the impact disturbs "
    "its base\nas little as possible, plans the approach path to that posture, and verifies it "
    "all.";

constexpr const char* kFooter = R"(
A first plan:
  stillbase check problems/iiwa_client_50.yaml
  stillbase plan problems/iiwa_client_50.yaml -o plan.json
  stillbase verify plan.json -o verification.json

Data goes to stdout or to the file of -o, messages go to stderr. An existing file is replaced only with --force.
Problem files are described in problems/README.md, plan files in docs/plan-file.md; `stillbase schema` prints the
JSON Schema of every file, `stillbase help` lists topics: files, units, optimizers, controllers, ...
Exit codes:)";

std::string footer() {
  std::string text = kFooter;
  for (const ExitMeaning& meaning : exit_meanings()) {
    text += "\n  " + meaning.codes + "  " + meaning.text;
  }
  return text;
}

int run_tool(int argc, const char* const* argv) {
  const ProgramText program{"stillbase", STILLBASE_VERSION, kAbout, footer()};
  std::vector<Command> commands{new_command(),
                                with_package_path(check_command()),
                                with_package_path(inspect_command()),
                                with_package_path(analyze_command()),
                                with_package_path(plan_command()),
                                with_package_path(simulate_command()),
                                with_package_path(verify_command()),
                                with_package_path(audit_command()),
                                replan_command(),
                                with_package_path(predict_command()),
                                with_package_path(campaign_command()),
                                with_package_path(bench_command()),
                                export_command(),
                                report_command(),
                                schema_command()};
  commands.push_back(help_command(program, commands));
  try {
    return run_command_line(program, commands, argc, argv);
  } catch (const InputError& error) {
    say(with_lines(error).what());
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

}  // namespace

}  // namespace stillbase::app

int main(int argc, char** argv) {
#ifdef STILLBASE_WITH_PROOF
  stillbase::enable_proofs();
#endif
  return stillbase::app::run_tool(argc, argv);
}
