// Completion for bash and zsh, from the commands as data.
#include <algorithm>
#include <variant>

#include <fmt/format.h>

#include "app/help.hpp"

namespace stillbase::app {

namespace {

/// A command that runs, with its path: "campaign run".
struct Leaf {
  std::string path;
  const Command* command;
};

std::vector<Leaf> leaves_of(const std::vector<Command>& commands, const std::string& before = {}) {
  std::vector<Leaf> leaves;
  for (const Command& command : commands) {
    const std::string path = before + command.name;
    if (command.subcommands.empty()) {
      leaves.push_back({path, &command});
    } else {
      for (const Leaf& leaf : leaves_of(command.subcommands, path + " ")) leaves.push_back(leaf);
    }
  }
  return leaves;
}

std::string joined_names(const std::vector<Command>& commands) {
  std::vector<std::string> names;
  for (const Command& command : commands) names.push_back(command.name);
  return fmt::format("{}", fmt::join(names, " "));
}

bool takes_value(const Option& option) { return !std::holds_alternative<bool*>(option.target); }

/// A word in single quotes.
std::string quoted_word(const std::string& word) {
  std::string text = "'";
  for (const char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return text + "'";
}

std::string bash_completion(const std::vector<Command>& commands) {
  std::string text =
      "# bash completion of stillbase; made by `stillbase help --completion bash`\n"
      "_stillbase() {\n"
      "  local cur=${COMP_WORDS[COMP_CWORD]} prev=${COMP_WORDS[COMP_CWORD-1]}\n"
      "  local path=${COMP_WORDS[1]} flags= words=\n"
      "  compopt -o default 2>/dev/null\n";
  text += fmt::format(
      "  if ((COMP_CWORD == 1)); then\n"
      "    COMPREPLY=($(compgen -W {} -- \"$cur\"))\n    return\n  fi\n",
      quoted_word(joined_names(commands) + " --help --version"));
  for (const Command& command : commands) {
    if (command.subcommands.empty()) continue;
    text += fmt::format(
        "  if [[ $path == {} ]]; then\n    if ((COMP_CWORD == 2)); then\n"
        "      COMPREPLY=($(compgen -W {} -- \"$cur\"))\n      return\n    fi\n"
        "    path+=\" ${{COMP_WORDS[2]}}\"\n  fi\n",
        command.name, quoted_word(joined_names(command.subcommands)));
  }
  text += "  case $path in\n";
  for (const Leaf& leaf : leaves_of(commands)) {
    std::vector<std::string> flags;
    std::string cases, words;
    for (const Option& option : leaf.command->options) {
      const std::vector<std::string> own = flags_of(option);
      flags.insert(flags.end(), own.begin(), own.end());
      const std::string values = fmt::format("{}", fmt::join(option.words, " "));
      if (own.empty()) {
        words += values;
      } else if (!values.empty()) {
        cases += fmt::format("        {}) words={}; flags= ;;\n", fmt::join(own, "|"),
                             quoted_word(values));
      } else if (takes_value(option)) {
        cases += fmt::format("        {}) return ;;\n", fmt::join(own, "|"));
      }
    }
    flags.emplace_back("--help");
    text += fmt::format("    {})\n      flags={} words={}\n", quoted_word(leaf.path),
                        quoted_word(fmt::format("{}", fmt::join(flags, " "))), quoted_word(words));
    if (!cases.empty()) text += "      case $prev in\n" + cases + "      esac\n";
    text += "      ;;\n";
  }
  return text +
         "  esac\n"
         "  if [[ $cur == -* ]]; then words=$flags; fi\n"
         "  if [[ $words ]]; then COMPREPLY=($(compgen -W \"$words\" -- \"$cur\")); fi\n"
         "}\n"
         "complete -F _stillbase stillbase\n";
}

/// A description inside an argument of _arguments: no brackets, no colons that end it.
std::string zsh_words(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '[' || c == ']' || c == ':' || c == '\\') out += '\\';
    out += c;
  }
  return out;
}

std::string zsh_action(const Option& option) {
  if (option.words.empty()) return "_files";
  return "(" + fmt::format("{}", fmt::join(option.words, " ")) + ")";
}

std::string zsh_arguments(const Command& command) {
  std::string text = "_arguments -S '--help[print the options]'";
  for (const Option& option : command.options) {
    const std::vector<std::string> flags = flags_of(option);
    const std::string value = option.value.empty() ? "value" : zsh_words(option.value);
    if (flags.empty()) {
      const bool is_list = std::holds_alternative<std::vector<std::string>*>(option.target);
      text +=
          " " + quoted_word(fmt::format("{}:{}:{}", is_list ? "*" : "", value, zsh_action(option)));
    }
    for (const std::string& flag : flags) {
      std::string spec = fmt::format("{}[{}]", flag, zsh_words(option.about));
      if (takes_value(option)) spec += fmt::format(":{}:{}", value, zsh_action(option));
      text += " " + quoted_word(spec);
    }
  }
  return text;
}

std::string zsh_described(const std::vector<Command>& commands) {
  std::string text;
  for (const Command& command : commands) {
    text += " " + quoted_word(zsh_words(command.name) + ":" + zsh_words(command.about));
  }
  return text;
}

/// Completes the word after the command, then by the command's own function.
std::string zsh_level(const std::vector<Command>& commands, const std::string& function) {
  std::string text = fmt::format(
      "{}() {{\n  if ((CURRENT == 2)); then\n    local -a commands=({})\n"
      "    _describe command commands\n    return\n  fi\n  shift words\n  ((CURRENT--))\n"
      "  case $words[1] in\n",
      function, zsh_described(commands));
  for (const Command& command : commands) {
    text += fmt::format("    {}) {}_{} ;;\n", command.name, function, command.name);
  }
  text += "  esac\n}\n";
  for (const Command& command : commands) {
    const std::string own = function + "_" + command.name;
    text += command.subcommands.empty()
                ? fmt::format("{}() {{\n  {}\n}}\n", own, zsh_arguments(command))
                : zsh_level(command.subcommands, own);
  }
  return text;
}

std::string zsh_completion(const std::vector<Command>& commands) {
  return "#compdef stillbase\n# made by `stillbase help --completion zsh`\n" +
         zsh_level(commands, "_stillbase") +
         "if [[ $zsh_eval_context[-1] == loadautofunc ]]; then\n  _stillbase \"$@\"\nelse\n"
         "  compdef _stillbase stillbase\nfi\n";
}

}  // namespace

std::string shell_completion(const std::string& shell, const std::vector<Command>& commands) {
  return shell == "zsh" ? zsh_completion(commands) : bash_completion(commands);
}

}  // namespace stillbase::app
