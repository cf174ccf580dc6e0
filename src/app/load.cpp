#include "app/load.hpp"

#include <algorithm>
#include <cctype>
#include <filesystem>

#include <stillbase/core/error.hpp>
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
  try {
    return read_robot(path, hand);
  } catch (const InputError& error) {
    // The file is good; the command line has to say which link is the hand.
    if (error.findings().size() == 1 && error.findings().front().rule == "hand-missing") {
      throw CommandLineError(to_string(error.findings().front()) + " (--hand LINK)");
    }
    throw;
  }
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
