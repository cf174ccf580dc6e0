#include "app/load.hpp"

#include <algorithm>
#include <cctype>
#include <filesystem>

#include <stillbase/core/error.hpp>
#include <stillbase/core/file.hpp>
#include <stillbase/robot/urdf_reader.hpp>

#include "app/exit_code.hpp"

namespace stillbase::app {

std::string extension_of(const std::string& path) {
  std::string text = std::filesystem::path(path).extension().string();
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

RobotModel load_robot(const std::string& path, const std::string& hand) {
  const std::string text = read_text_file(path, kMaxUrdfBytes);
  try {
    return read_urdf(text, path, hand);
  } catch (const InputError& error) {
    // The file is good; the command line has to say which link is the hand.
    if (error.findings().size() == 1 && error.findings().front().rule == "hand-missing") {
      throw CommandLineError(to_string(error.findings().front()) + " (--hand LINK)");
    }
    throw;
  }
}

PlanFile load_plan(const std::string& path) {
  PlanFile file = read_plan(read_text_file(path), path);
  if (!file.is_as_written()) {
    throw InputError({{path, 0, "fingerprint",
                       "content_sha256: the plan was changed after it was written; `stillbase "
                       "verify` says what does not hold"}});
  }
  return file;
}

bool is_same_file(const std::string& a, const std::string& b) {
  if (a.empty() || b.empty()) return false;
  std::error_code ignored;
  if (std::filesystem::equivalent(a, b, ignored)) return true;
  const auto full = [&ignored](const std::string& path) {
    return std::filesystem::weakly_canonical(std::filesystem::absolute(path), ignored);
  };
  return full(a) == full(b);
}

}  // namespace stillbase::app
