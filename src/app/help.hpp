// What the tool says of itself: pages of `stillbase help`, the manual page, completion for shells.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "app/command_line.hpp"

namespace stillbase::app {

/// A page of `stillbase help TOPIC`.
struct Topic {
  std::string name, about;
  std::function<std::string()> text;
};

/// By name.
std::vector<Topic> help_topics();

/// The manual page stillbase(1) in the macros of man(7).
std::string man_page(const ProgramText& program, const std::vector<Command>& commands);

/// Completion of commands, options, closed lists of words and files.
/// @param shell "bash" or "zsh"
std::string shell_completion(const std::string& shell, const std::vector<Command>& commands);

/// `help`: topics; with an option the manual page or a completion. What `help COMMAND` prints is
/// for run_command_line().
Command help_command(const ProgramText& program, const std::vector<Command>& commands);

}  // namespace stillbase::app
