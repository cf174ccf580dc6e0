// Runs the built program in a folder of its own.
#pragma once

#include <stdlib.h>
#include <sys/wait.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>

#include "support/temporary_folder.hpp"

namespace stillbase::cli_test {

inline std::string source_path(const std::string& relative) {
  return std::string(STILLBASE_SOURCE_DIR) + "/" + relative;
}

inline std::string file_text(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

struct Outcome {
  int code = -1;
  std::string out, err;
  bool says(const std::string& part) const { return err.find(part) != std::string::npos; }
};

/// A temporary folder with copies of the shipped robots and targets.
class Workshop : public TemporaryFolder {
 public:
  Workshop() {
    for (const char* part : {"robots", "targets"}) {
      std::filesystem::copy(source_path(std::string("problems/") + part), folder() / part);
    }
  }

  bool has(const std::string& name) const { return std::filesystem::exists(folder() / name); }
  std::string text(const std::string& name) const { return file_text(path(name)); }

  /// Writes a shipped file with its first occurrence of `from` replaced, and gives the 1-based line
  /// of the change. A test that replaces nothing is wrong.
  int write_changed(const std::string& name, const std::string& shipped, const std::string& from,
                    const std::string& to) const {
    std::string content = file_text(source_path(shipped));
    const std::size_t at = content.find(from);
    if (at == std::string::npos) throw std::logic_error("nothing to replace: " + from);
    content.replace(at, from.size(), to);
    write(name, content);
    return 1 + static_cast<int>(
                   std::count(content.begin(), content.begin() + static_cast<long>(at), '\n'));
  }

  /// Runs the program in the folder with arguments for the shell.
  Outcome run(const std::string& arguments) const {
    return run_script("'" STILLBASE_TOOL "' " + arguments);
  }

  /// Runs a shell script in the folder.
  Outcome run_script(const std::string& script) const {
    write(".script", script);
    const std::string command = "cd '" + folder().string() + "' && sh .script >.out 2>.err";
    const int status = std::system(command.c_str());
    Outcome outcome;
    if (WIFEXITED(status)) outcome.code = WEXITSTATUS(status);
    outcome.out = text(".out");
    outcome.err = text(".err");
    return outcome;
  }
};

}  // namespace stillbase::cli_test
