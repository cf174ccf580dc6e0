// The committed results of the full run, and what README.md says of them.
#include <catch2/catch.hpp>

#include <algorithm>
#include <regex>
#include <sstream>

#include <stillbase/core/file.hpp>
#include <stillbase/plan/problem.hpp>

namespace stillbase {
namespace {

std::string shipped(const std::string& path) {
  return read_text_file(STILLBASE_SOURCE_DIR "/" + path);
}

std::string unwrapped(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

/// The line of a text that begins so.
std::string line_with(const std::string& text, const std::string& begin) {
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) {
    if (line.rfind(begin, 0) == 0) return line;
  }
  return "no line begins with " + begin;
}

}  // namespace

TEST_CASE("README names the default optimizer in the words of the results, and the default is it") {
  const std::string readme = unwrapped(shipped("README.md"));
  const std::string choice = line_with(shipped("bench/results/report.md"), "By default ");
  const std::string speed = line_with(shipped("bench/results/times.md"), "In a second ");
  CHECK(readme.find(choice + " " + speed) != std::string::npos);
  CHECK(choice.find("By default " + SearchSpec{}.optimizer + ":") == 0);
}

TEST_CASE(
    "the results have the size that was promised, and the problems are neither trivial nor "
    "out of reach") {
  const std::string report = shipped("bench/results/report.md");
  const std::regex row(R"(\| (\S+) +\| (\d+) +\|.*\| (\d+)/(\d+) +\| \d+ +\| [0-9.]+ +\|)");
  int optimizers = 0;
  bool has_random_search = false;
  std::istringstream stream(report);
  for (std::string line; std::getline(stream, line);) {
    std::smatch match;
    if (!std::regex_match(line, match, row)) continue;
    ++optimizers;
    const int runs = std::stoi(match[2]), solved = std::stoi(match[3]), all = std::stoi(match[4]);
    CAPTURE(line);
    CHECK(all >= 60);
    CHECK(runs >= 15 * all);
    CHECK(solved < all);
    if (match[1] == "random-search") {
      has_random_search = true;
      CHECK(10 * solved <= 7 * all);
    }
  }
  CHECK(optimizers >= 14);
  CHECK(has_random_search);
}

}  // namespace stillbase
