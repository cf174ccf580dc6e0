// The manual page stillbase(1), from the commands as data.
#include <fmt/format.h>

#include "app/help.hpp"

namespace stillbase::app {

namespace {

/// Text of a manual page: backslashes, hyphens of options, and controls at the begin of a line.
std::string roff(const std::string& text) {
  std::string out;
  bool at_begin = true;
  for (const char c : text) {
    if (at_begin && (c == '.' || c == '\'')) out += "\\&";
    at_begin = c == '\n';
    if (c == '\\') {
      out += "\\e";
    } else if (c == '-') {
      out += "\\-";
    } else {
      out += c;
    }
  }
  return out;
}

std::string option_head(const Option& option) {
  std::string names;
  for (const std::string& flag : flags_of(option)) {
    names += (names.empty() ? "\\fB" : ", \\fB") + roff(flag) + "\\fR";
  }
  const std::string value = option.value.empty() ? "" : "\\fI" + roff(option.value) + "\\fR";
  if (names.empty()) return value;
  return value.empty() ? names : names + " " + value;
}

std::string synopsis(const Command& command) {
  std::string text;
  bool has_options = false;
  for (const Option& option : command.options) {
    const bool is_positional = flags_of(option).empty();
    has_options = has_options || !is_positional;
    if (!is_positional) continue;
    const std::string value = "\\fI" + roff(option.value) + "\\fR";
    text += option.is_required ? " " + value : " [" + value + "]";
  }
  return text + (has_options ? " [options]" : "");
}

std::string command_text(const Command& command, const std::string& path) {
  std::string text;
  if (command.subcommands.empty()) {
    text += fmt::format(".SS {}\n\\fBstillbase {}\\fR{}\n.PP\n{}.\n", roff(path), roff(path),
                        synopsis(command), roff(command.about));
    for (const Option& option : command.options) {
      text += fmt::format(".TP\n{}\n{}\n", option_head(option), roff(option.about));
    }
  }
  for (const Command& inner : command.subcommands) {
    text += command_text(inner, path + " " + inner.name);
  }
  return text;
}

std::string topic_text(const Topic& topic) {
  return fmt::format(".SS {}\n.nf\n{}.fi\n", roff(topic.name), roff(topic.text()));
}

}  // namespace

std::string man_page(const ProgramText& program, const std::vector<Command>& commands) {
  std::string text = fmt::format(
      ".\\\" made by `stillbase help --man`\n"
      ".TH STILLBASE 1 \"\" \"stillbase {}\" \"User Commands\"\n"
      ".SH NAME\nstillbase \\- pre\\-impact configurations of free\\-floating space robots\n"
      ".SH SYNOPSIS\n.B stillbase\n\\fICOMMAND\\fR [\\fIarguments\\fR]\n"
      ".SH DESCRIPTION\n{}\n.SH COMMANDS\n",
      roff(program.version), roff(program.about));
  for (const Command& command : commands) text += command_text(command, command.name);
  text += ".SH TOPICS\n";
  for (const Topic& topic : help_topics()) text += topic_text(topic);
  return text;
}

}  // namespace stillbase::app
