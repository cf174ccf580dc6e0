#include "app/command_line.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <memory>
#include <sstream>
#include <type_traits>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "io/scalars.hpp"
#include "robot/mesh_shapes.hpp"

namespace stillbase::app {

namespace {

// CLI11's own checks let NaN and wrapped signs through.
CLI::Validator positive_number() {
  return CLI::Validator(
      [](const std::string& text) {
        char* end = nullptr;
        const double value = std::strtod(text.c_str(), &end);
        const bool is_good = *end == '\0' && std::isfinite(value) && value > 0;
        return is_good ? std::string() : "'" + text + "' is not a finite number > 0";
      },
      "> 0");
}

CLI::Validator whole_number() {
  return CLI::Validator(
      [](const std::string& text) {
        std::uint64_t value = 0;
        const char* const end = text.data() + text.size();
        const auto [stop, error] = std::from_chars(text.data(), end, value);
        const bool is_good = stop == end && error == std::errc();
        return is_good ? std::string() : "'" + text + "' is not a whole number from 0 to 2^64 - 1";
      },
      "WHOLE");
}

/// Adds an option by the type of its target.
struct OptionAdder {
  CLI::App& app;
  const Option& option;

  CLI::Option* operator()(bool* target) const {
    return app.add_flag(option.name, *target, option.about);
  }
  CLI::Option* operator()(std::vector<std::string>* target) const {
    CLI::Option* const added = app.add_option(option.name, *target, option.about);
    // One value a time, or the list would take the arguments behind it.
    return added->get_positional() ? added : added->delimiter(',')->allow_extra_args(false);
  }
  CLI::Option* operator()(std::vector<double>* target) const {
    return app.add_option(option.name, *target, option.about)->expected(option.count);
  }
  template <class T>
  CLI::Option* operator()(std::optional<T>* target) const {
    return checked<T>(app.add_option(option.name, *target, option.about));
  }
  template <class T>
  CLI::Option* operator()(T* target) const {
    CLI::Option* const added = checked<T>(app.add_option(option.name, *target, option.about));
    return *target == T() ? added : added->capture_default_str();
  }

 private:
  template <class T>
  CLI::Option* checked(CLI::Option* added) const {
    if constexpr (std::is_same_v<T, double>) return added->check(positive_number());
    if constexpr (std::is_same_v<T, std::uint64_t>) return added->check(whole_number());
    if constexpr (std::is_signed_v<T> && std::is_integral_v<T>) {
      return added->check(CLI::Range(option.least, option.most));
    }
    return added;
  }
};

void add_command(CLI::App& parent, const Command& command, const Command*& chosen) {
  CLI::App* const app = parent.add_subcommand(command.name, command.about);
  std::map<std::string, CLI::Option*> added;
  for (const Option& option : command.options) {
    CLI::Option* const made = std::visit(OptionAdder{*app, option}, option.target);
    if (!option.value.empty()) made->type_name(option.value);
    if (option.is_required) made->required();
    for (const std::string& other : option.excludes) made->excludes(added.at(other));
    added[option.name] = made;
  }
  for (const Command& subcommand : command.subcommands) add_command(*app, subcommand, chosen);
  if (command.subcommands.empty()) {
    app->callback([&command, &chosen] { chosen = &command; });
  } else {
    app->require_subcommand(1);
  }
}

std::vector<std::string> names_of(const std::vector<Command>& commands) {
  std::vector<std::string> names;
  for (const Command& command : commands) names.push_back(command.name);
  return names;
}

/// "--output=x" is the option --output; a negative number is none.
void check_option(const std::string& argument, const std::vector<std::string>& known,
                  const std::string& path) {
  const bool is_long = argument.rfind("--", 0) == 0 && argument.size() > 2;
  const bool is_short = argument.size() > 1 && argument[0] == '-' && !is_long &&
                        std::isalpha(static_cast<unsigned char>(argument[1])) != 0;
  if (!is_long && !is_short) return;
  const std::string name = is_long ? argument.substr(0, argument.find('=')) : argument.substr(0, 2);
  if (std::find(known.begin(), known.end(), name) != known.end()) return;
  const std::string where = path.empty() ? "" : path + ": ";
  throw CommandLineError(fmt::format("{}there is no option {}; `stillbase {}` lists them{}", where,
                                     name, path.empty() ? "--help" : path + " --help",
                                     io::did_you_mean(name, known)));
}

/// CLI11 leaves out what is empty between two commas.
/// @param next the argument behind this one, its value unless it has one of its own
void check_list(const std::vector<Option>& options, const std::string& argument,
                const std::string& next) {
  const std::size_t equals = argument.find('=');
  const std::string name = argument.substr(0, equals);
  const bool is_list = std::any_of(options.begin(), options.end(), [&](const Option& option) {
    const std::vector<std::string> flags = flags_of(option);
    return std::holds_alternative<std::vector<std::string>*>(option.target) &&
           std::find(flags.begin(), flags.end(), name) != flags.end();
  });
  if (!is_list) return;
  const std::string list = equals == std::string::npos ? next : argument.substr(equals + 1);
  if (("," + list + ",").find(",,") == std::string::npos) return;
  throw CommandLineError(fmt::format("{} {}: an element of the list is empty", name, list));
}

/// What CLI11 does not refuse by itself, or without a suggestion: empty values, subcommands and
/// options that do not exist.
void check_arguments(const std::vector<Command>& commands, const std::vector<const char*>& argv) {
  const std::vector<std::string> arguments(argv.begin() + 1, argv.end());
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    const std::string& argument = arguments[i];
    if (argument.empty()) {
      const bool is_value = i > 0 && arguments[i - 1].rfind('-', 0) == 0;
      throw CommandLineError(is_value ? arguments[i - 1] + ": the value is empty"
                                      : "an argument is empty");
    }
    if (argument.rfind("--", 0) == 0 && argument.size() > 2 && argument.back() == '=') {
      throw CommandLineError(argument + ": the value is empty");
    }
  }
  std::string path;
  std::vector<std::string> known{"-h", "--help", "-V", "--version"};
  const std::vector<Command>* level = &commands;
  const std::vector<Option>* options = nullptr;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    const std::string& argument = arguments[i];
    if (argument == "--") return;
    if (argument[0] == '-') {
      check_option(argument, known, path);
      // An option without a value is CLI11's own finding.
      const std::string next = i + 1 < arguments.size() ? arguments[i + 1] : "-";
      if (options != nullptr) check_list(*options, argument, next);
      continue;
    }
    if (level->empty()) continue;
    const auto chosen = std::find_if(level->begin(), level->end(),
                                     [&](const Command& c) { return c.name == argument; });
    if (chosen == level->end()) {
      const std::vector<std::string> names = names_of(*level);
      throw CommandLineError(fmt::format("there is no subcommand '{}'; there are {}{}", argument,
                                         fmt::join(names, ", "),
                                         io::did_you_mean(argument, names)));
    }
    path += (path.empty() ? "" : " ") + argument;
    known = {"-h", "--help"};
    for (const Option& option : chosen->options) {
      for (const std::string& flag : flags_of(option)) known.push_back(flag);
    }
    level = &chosen->subcommands;
    options = &chosen->options;
  }
}

}  // namespace

std::vector<std::string> flags_of(const Option& option) {
  std::vector<std::string> flags;
  std::istringstream names(option.name);
  for (std::string name; std::getline(names, name, ',');) {
    if (name.front() == '-') flags.push_back(name);
  }
  return flags;
}

std::vector<Option> output_options(OutputFile& output, const std::string& name,
                                   const std::string& about) {
  return {{name, "FILE", about, &output.path},
          {"--force", "", "replace an output file that exists", &output.force}};
}

std::vector<Option> operator+(std::vector<Option> a, const std::vector<Option>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

Command with_package_path(Command command) {
  for (Command& subcommand : command.subcommands) {
    subcommand = with_package_path(std::move(subcommand));
  }
  if (!command.run) return command;
  auto folders = std::make_shared<std::vector<std::string>>();
  command.options.push_back(
      {"--package-path", "DIR",
       "folder in which packages of meshes are looked for, before those of ROS_PACKAGE_PATH; may "
       "be repeated",
       folders.get()});
  command.run = [folders, run = std::move(command.run)] {
    for (const std::string& folder : *folders) {
      if (!std::filesystem::is_directory(folder) || folder.find(':') != std::string::npos) {
        throw CommandLineError("--package-path " + folder +
                               ": is no folder, or has a colon in its name");
      }
    }
    urdf::put_before_ros_package_path(*folders);
    return run();
  };
  return command;
}

int run_command_line(const ProgramText& program, const std::vector<Command>& commands, int argc,
                     const char* const* argv) {
  open_standard_descriptors();
  std::vector<const char*> arguments(argv, argv + argc);
  const auto is_command = [&](const std::string& name) {
    return std::any_of(commands.begin(), commands.end(),
                       [&](const Command& command) { return command.name == name; });
  };
  // `help plan` is `plan --help`.
  if (argc > 2 && std::string_view(argv[1]) == "help" && is_command(argv[2])) {
    arguments.erase(arguments.begin() + 1);
    arguments.push_back("--help");
  }
  CLI::App app(program.about, program.name);
  app.set_version_flag("-V,--version", program.name + " " + program.version);
  app.footer(program.footer);
  app.require_subcommand(1);
  const Command* chosen = nullptr;
  for (const Command& command : commands) add_command(app, command, chosen);
  check_arguments(commands, arguments);
  try {
    app.parse(static_cast<int>(arguments.size()), arguments.data());
  } catch (const CLI::ParseError& error) {
    const bool is_request = error.get_exit_code() == 0;  // --help, --version
    std::ostringstream out, err;
    app.exit(error, out, err);
    if (is_request) {
      write_stdout(out.str());
      return kDone;
    }
    say(err.str() + out.str());
    return kCommandLine;
  }
  catch_signals();
  return chosen->run();
}

}  // namespace stillbase::app
