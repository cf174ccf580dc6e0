// stillbase new: a first problem for a robot file.
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <iostream>
#include <memory>

#include <fmt/format.h>

#include <stillbase/io/problem_file.hpp>

#include "app/command_line.hpp"
#include "app/draft_words.hpp"
#include "app/problem_draft.hpp"
#include "app/window_words.hpp"
#include "app/words.hpp"
#include "io/fields/ranges.hpp"

namespace stillbase::app {

namespace {

struct NewRequest {
  DraftRequest draft;
  std::vector<std::string> base_size;
  OutputFile output;
};

/// An answer to a question on a terminal; the default for an empty one.
std::string ask(const std::string& question, const std::string& otherwise) {
  fmt::print(stderr, "{}{}: ", question, otherwise.empty() ? "" : " [" + otherwise + "]");
  std::string answer;
  if (!std::getline(std::cin, answer)) throw CommandLineError("there is no answer");
  return answer.empty() ? otherwise : answer;
}

double number_of(const std::string& option, const std::string& text) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  if (text.empty() || *end != '\0' || !std::isfinite(value) || value < 0) {
    throw CommandLineError(fmt::format("{}: '{}' is not a finite number >= 0", option, text));
  }
  return value;
}

void check_at_most(const std::string& option, double value, double most, const char* unit) {
  if (value <= most) return;
  throw CommandLineError(
      fmt::format("{} {:g}: must be at most {:g} {}", option, value, most, unit));
}

/// What the problem file may state.
void check_ranges(const DraftRequest& draft) {
  const double heaviest = kDensity * std::pow(io::kSize.upper, 3);  // its edge follows
  check_at_most("--base-mass", draft.base_mass, heaviest, "kg");
  check_at_most("--target-mass", draft.target_mass, heaviest, "kg");
  check_at_most("--base-size", draft.base_size.maxCoeff(), io::kSize.upper, "m");
  check_at_most("--spin", draft.spin, io::kSpinSize.upper * kDegrees, "deg/s");
  check_at_most("--distance", draft.distance, kFarthest, "m");
}

/// Whether the target can be met in the problem that was written, in words; empty: it can.
std::string contact_doubt(const CaptureProblem& problem) {
  const auto window = next_contact_window(problem, problem.variables.contact_time_lower);
  if (window && window->from < problem.variables.contact_time_upper) return "";
  return "the target's face does not close in on the robot during variables.contact_time: `plan` "
         "finds no configuration; name a smaller --spin or --target-mass";
}

int make_problem(NewRequest request) {
  DraftRequest& draft = request.draft;
  request.output.path = draft.problem;
  request.output.check();
  if (extension_of(draft.problem) != ".yaml" && extension_of(draft.problem) != ".yml") {
    throw CommandLineError(draft.problem + ": a problem ends in .yaml");
  }
  if (draft.robot.empty()) {
    if (isatty(STDIN_FILENO) != 1) throw CommandLineError("--robot ARM.urdf must be named");
    draft.robot = ask("robot file (URDF)", "");
    draft.hand = ask("hand link, empty: found", "");
    draft.base_mass =
        number_of("mass", ask("mass of the satellite, kg, 0: ten times the arm's", "0"));
    draft.target_mass = number_of("mass", ask("mass of the target, kg, 0: a tenth of it all", "0"));
    draft.spin = number_of("rate", ask("its rotation, deg/s", "2"));
  }
  if (!request.base_size.empty()) {
    if (request.base_size.size() != 3)
      throw CommandLineError("--base-size X,Y,Z: three numbers in m");
    for (int i = 0; i < 3; ++i) {
      draft.base_size[i] = number_of("--base-size", request.base_size[static_cast<std::size_t>(i)]);
    }
    if (!(draft.base_size.minCoeff() > 0)) throw CommandLineError("--base-size: must be > 0");
  }
  check_ranges(draft);
  const Draft made = draft_problem(draft);
  request.output.write(made.text);
  for (const std::string& note : made.notes) say(note);
  std::vector<std::string> doubts = made.doubts;
  if (std::string doubt = contact_doubt(read_problem(draft.problem)); !doubt.empty()) {
    doubts.insert(doubts.begin(), std::move(doubt));
  }
  for (const std::string& doubt : doubts) say("doubtful: " + doubt);
  say(fmt::format("written to {0}; next: stillbase plan {0} -o plan.json", draft.problem));
  return kDone;
}

}  // namespace

Command new_command() {
  auto request = std::make_shared<NewRequest>();
  DraftRequest& draft = request->draft;
  return {
      "new",
      "write a first problem for a robot file, annotated, that plans as it is",
      {{"problem", "PROBLEM.yaml", "problem file to write", &draft.problem, true},
       {"--robot", "ARM.urdf", "robot file; on a terminal it is asked for", &draft.robot},
       {"--hand", "LINK", "hand link; without it the end behind the most joints", &draft.hand},
       {"--base-mass", "KG", "of the satellite, kg; without it ten times the arm's",
        &draft.base_mass},
       {"--base-size", "X,Y,Z", "edges of the satellite, m; without it those of 200 kg/m^3",
        &request->base_size},
       {"--target-mass", "KG", "of the target, kg; without it a tenth of the spacecraft's",
        &draft.target_mass},
       {"--spin", "DEG_PER_S", "rotation of the target, deg/s", &draft.spin},
       {"--distance", "M", "of the target at the start, m; without it 1.5, more for slow arms",
        &draft.distance},
       {"--package-path", "DIR",
        "folder in which packages of meshes are looked for; may be repeated", &draft.package_path},
       {"--force", "", "replace a problem file that exists", &request->output.force}},
      [request] { return make_problem(*request); }};
}

}  // namespace stillbase::app
