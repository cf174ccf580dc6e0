// What the READMEs show is run: every `$ stillbase ...` line of a console block in its own copy of
// the problems, and every line of output below it must come out again.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <map>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include <stillbase/core/file.hpp>
#include <stillbase/io/problem_file.hpp>

#include "support/temporary_folder.hpp"

namespace stillbase {
namespace {

namespace fs = std::filesystem;

const fs::path kRoot = STILLBASE_SOURCE_DIR;

/// Every page of documentation.
std::vector<fs::path> pages() {
  std::vector<fs::path> out{kRoot / "README.md"};
  for (const char* folder : {"problems", "problems/reference", "docs", "docs/how-to", "examples",
                             "src", "bench", "tests", "web"}) {
    if (!fs::exists(kRoot / folder)) continue;
    for (const auto& entry : fs::directory_iterator(kRoot / folder)) {
      if (entry.path().extension() == ".md") out.push_back(entry.path());
    }
  }
  return out;
}

/// A command with the lines shown below it, or a file that is written before the next command.
struct Snippet {
  std::string command;
  std::vector<std::string> output;
  std::string file = {}, content = {};
};

/// Commands of the console blocks and files of the blocks that name one ("```yaml file=NAME"), in
/// their order.
std::vector<Snippet> console_snippets(const fs::path& file) {
  std::istringstream text(read_text_file(file.string()));
  const std::regex named("```[a-z]+ file=(\\S+)");
  std::vector<Snippet> out;
  enum class Block { None, Other, Console, File } block = Block::None;
  for (std::string line; std::getline(text, line);) {
    std::smatch name;
    if (line.rfind("```", 0) == 0) {
      const bool is_file = std::regex_match(line, name, named);
      if (block != Block::None) {
        block = Block::None;
      } else if (is_file) {
        block = Block::File;
        out.push_back({"", {}, name[1], ""});
      } else {
        block = line == "```console" ? Block::Console : Block::Other;
      }
    } else if (block == Block::File) {
      out.back().content += line + "\n";
    } else if (block == Block::Console && line.rfind("$ ", 0) == 0) {
      out.push_back({line.substr(2), {}});
    } else if (block == Block::Console && !line.empty()) {
      REQUIRE_FALSE(out.empty());
      out.back().output.push_back(line);
    }
  }
  return out;
}

/// Whether a printed line is the one shown: the same words, every number within 5 %. The last
/// digits, and through them counts and whether a zero is exact, depend on the processor's sine.
bool prints(const std::string& printed, const std::string& shown_line) {
  const auto with_exact_zeros = [](const std::string& line) {
    return std::regex_replace(line, std::regex("0 \\(below 1e-9\\)"), "0");
  };
  const std::string shown = with_exact_zeros(shown_line);
  const std::regex number("-?[0-9]+(\\.[0-9]+)?(e-?[0-9]+)?");
  const auto words = [&](const std::string& line) { return std::regex_replace(line, number, "#"); };
  const auto numbers = [&](const std::string& line) {
    std::vector<double> out;
    for (std::sregex_iterator it(line.begin(), line.end(), number), end; it != end; ++it) {
      out.push_back(std::stod(it->str()));
    }
    return out;
  };
  std::istringstream lines(printed);
  const std::vector<double> wanted = numbers(shown);
  for (std::string line; std::getline(lines, line);) {
    line = with_exact_zeros(line);
    if (words(line) != words(shown)) continue;
    const std::vector<double> found = numbers(line);
    bool same = true;
    for (std::size_t i = 0; i < wanted.size(); ++i) {
      same = same && std::abs(found[i] - wanted[i]) <= 0.05 * std::abs(wanted[i]) + 0.02;
    }
    if (same) return true;
  }
  return false;
}

/// Runs a command in a folder; gives everything that it printed.
std::string run(const std::string& command, const fs::path& folder, int& code) {
  const std::string whole = "cd '" + folder.string() + "' && ( " + command + " ) 2>&1";
  std::string printed;
  FILE* pipe = popen(whole.c_str(), "r");
  REQUIRE(pipe != nullptr);
  char buffer[4096];
  while (const std::size_t size = fread(buffer, 1, sizeof buffer, pipe))
    printed.append(buffer, size);
  code = pclose(pipe);
  return printed;
}

}  // namespace

TEST_CASE("every command in the READMEs runs and prints what is shown", "[proofs]") {
  int commands = 0, pictures = 0;
  for (const fs::path& readme : pages()) {
    if (console_snippets(readme).empty()) continue;
    const TemporaryFolder scratch;
    const fs::path& folder = scratch.folder();
    fs::copy(kRoot / "problems", folder / "problems", fs::copy_options::recursive);
    for (const Snippet& snippet : console_snippets(readme)) {
      if (!snippet.file.empty()) {
        write_file_atomically((folder / snippet.file).string(), snippet.content, true);
        continue;
      }
      INFO(readme.string() << ": " << snippet.command);
      REQUIRE(snippet.command.rfind("stillbase ", 0) == 0);
      int code = 0;
      const std::string printed =
          run(std::string(STILLBASE_TOOL) + snippet.command.substr(9), folder, code);
      CHECK(code == 0);
      for (const std::string& line : snippet.output) {
        INFO("shown:   " << line << "\nprinted:\n" << printed);
        CHECK(prints(printed, line));
      }
      ++commands;
    }
    const fs::path picture = folder / "planar_two_link_sweep_a.svg";
    if (fs::exists(picture)) {
      // The picture of the README is what its command draws today.
      ++pictures;
      CHECK(read_text_file(picture.string()) ==
            read_text_file((kRoot / "problems" / picture.filename()).string()));
    }
  }
  CHECK(commands >= 4);
  CHECK(pictures == 1);
}

/// Every equation of the paper stands in a table row of the page, and every function of such a row
/// is declared in a header and called by a test. Where the row names headers, in one of them.
void check_equations(const fs::path& page) {
  INFO(page.string());
  std::string headers, tests;
  for (const auto& entry : fs::recursive_directory_iterator(kRoot / "include")) {
    if (entry.path().extension() == ".hpp") headers += read_text_file(entry.path().string());
  }
  for (const auto& entry : fs::recursive_directory_iterator(kRoot / "tests")) {
    if (entry.path().extension() == ".cpp") tests += read_text_file(entry.path().string());
  }
  std::vector<bool> numbers(26, false);
  const std::regex row("\\| \\([0-9]+\\)[^|]*\\|.*"), number("\\(([0-9]+)\\)");
  const std::regex name("`([a-z]+_[a-z_]+)`"), header("`([a-z]+/[a-z_]+\\.hpp)`");
  std::istringstream text(read_text_file(page.string()));
  for (std::string line; std::getline(text, line);) {
    if (!std::regex_match(line, row)) continue;
    const std::string equations = line.substr(0, line.find('|', 1));
    for (std::sregex_iterator it(equations.begin(), equations.end(), number), end; it != end;
         ++it) {
      numbers.at(static_cast<std::size_t>(std::stoi((*it)[1]))) = true;
    }
    std::string named;
    for (std::sregex_iterator it(line.begin(), line.end(), header), end; it != end; ++it) {
      named += read_text_file((kRoot / "include/stillbase" / (*it)[1].str()).string());
    }
    int found = 0;
    for (std::sregex_iterator it(line.begin(), line.end(), name), end; it != end; ++it, ++found) {
      const std::string function = (*it)[1];
      INFO(function);
      CHECK((named.empty() ? headers : named).find(" " + function + "(") != std::string::npos);
      const bool tested = tests.find(function + "(") != std::string::npos ||
                          tests.find(function + "<") != std::string::npos;
      CHECK(tested);
    }
    INFO(line);
    CHECK(found > 0);
  }
  for (std::size_t i = 1; i <= 25; ++i) {
    INFO("equation (" << i << ")");
    CHECK(numbers[i]);
  }
}

TEST_CASE("the README's factors are of every problem ranked over a cone, and of the best known") {
  std::vector<std::string> wanted, listed;
  for (const auto& entry : fs::directory_iterator(kRoot / "problems")) {
    if (entry.path().extension() != ".yaml") continue;
    const CaptureProblem problem = read_problem(entry.path().string());
    const bool has_cone = problem.uncertainty.cone_half_angle > 0;
    if (problem.measure.kind == RiskMeasure::WorstCase && has_cone) wanted.push_back(problem.name);
  }
  std::map<std::string, double> best_known;
  std::istringstream table(read_text_file((kRoot / "problems/best_known.csv").string()));
  for (std::string line; std::getline(table, line);) {
    const std::size_t comma = line.find(',');
    if (comma == std::string::npos || line.front() == '#') continue;
    best_known[line.substr(0, comma)] = std::atof(line.c_str() + comma + 1);
  }
  const std::regex row(
      "\\| `([a-z0-9_]+)` \\| ([0-9.e-]+) [^|]+ \\| ([0-9.e-]+) [^|]+ \\| ([0-9.]+) \\| .*");
  const std::string readme = read_text_file((kRoot / "README.md").string());
  std::istringstream text(readme);
  std::smatch cells;
  for (std::string line; std::getline(text, line);) {
    if (!std::regex_match(line, cells, row)) continue;
    INFO(line);
    listed.push_back(cells[1]);
    const double robust = std::stod(cells[3]), factor = std::stod(cells[4]);
    // Three digits are shown.
    CHECK(robust == Approx(best_known[cells[1]]).epsilon(0.006));
    CHECK(factor == Approx(std::stod(cells[2]) / robust).epsilon(0.012));
    if (listed.size() > 1) continue;
    CHECK(readme.find("has up to " + std::string(cells[4]) + " times") != std::string::npos);
  }
  std::sort(wanted.begin(), wanted.end());
  std::sort(listed.begin(), listed.end());
  CHECK(listed == wanted);
}

TEST_CASE("every function that README and theory give for an equation exists and is tested") {
  check_equations(kRoot / "README.md");
  check_equations(kRoot / "docs/theory.md");
}

TEST_CASE("the README's program is the one that the package test builds and runs") {
  const std::string readme = read_text_file((kRoot / "README.md").string());
  const std::size_t begin = readme.find("```cpp\n");
  REQUIRE(begin != std::string::npos);
  const std::size_t end = readme.find("```", begin + 7);
  CHECK(readme.substr(begin + 7, end - begin - 7) ==
        read_text_file((kRoot / "tests/package/consumer/readme.cpp").string()));
}

TEST_CASE("the page of fields is what the tables of fields print") {
  int code = 0;
  const std::string printed = run(std::string(STILLBASE_TOOL) + " schema --fields", kRoot, code);
  CHECK(code == 0);
  // After a change: stillbase schema --fields -o problems/reference/fields.md --force
  CHECK(printed == read_text_file((kRoot / "problems/reference/fields.md").string()));
}

TEST_CASE("every file that a page links to exists") {
  const std::regex link("\\]\\(([^)#:]+)\\)");
  int links = 0;
  for (const fs::path& page : pages()) {
    const std::string text = read_text_file(page.string());
    for (std::sregex_iterator it(text.begin(), text.end(), link), end; it != end; ++it, ++links) {
      INFO(page.string() << ": " << (*it)[1]);
      CHECK(fs::exists(page.parent_path() / (*it)[1].str()));
    }
  }
  CHECK(links >= 20);
}

TEST_CASE("MkDocs builds static pages of everything, with every link good") {
  const std::string script = (kRoot / "tools/docs").string();
  const std::string text = read_text_file(script);
  const std::regex entry("- (?:[^:\\n]+: )?(\\S+\\.md)\\n");
  int entries = 0;
  for (std::sregex_iterator it(text.begin(), text.end(), entry), end; it != end; ++it, ++entries) {
    INFO((*it)[1]);
    CHECK(fs::exists(kRoot / (*it)[1].str()));
  }
  CHECK(entries >= 12);
  if (std::system("command -v mkdocs >/dev/null && command -v git >/dev/null") != 0) {
    std::cout << "skipped: no mkdocs\n";
    return;
  }
  const TemporaryFolder scratch;
  const fs::path& folder = scratch.folder();
  int code = 0;
  INFO(run("'" + script + "' site", folder, code));
  CHECK(code == 0);
  CHECK(fs::exists(folder / "site/docs/start.html"));
  // Scripts and styles are there: the pages ask nothing of the network.
  const std::regex used("(?:src|href)=\"([^\"]+[.](?:js|css))\"");
  int uses = 0;
  for (const fs::directory_entry& page : fs::recursive_directory_iterator(folder / "site")) {
    const bool is_reference = page.path().string().find("/site/api/") != std::string::npos;
    if (page.path().extension() != ".html" || is_reference) continue;
    const std::string html = read_text_file(page.path().string());
    for (std::sregex_iterator it(html.begin(), html.end(), used), end; it != end; ++it, ++uses) {
      INFO(page.path() << ": " << (*it)[1]);
      CHECK(((*it)[1].str().front() == '/' ||
             fs::exists(page.path().parent_path() / (*it)[1].str())));
    }
  }
  CHECK(uses > 50);
}

TEST_CASE("Doxygen writes the reference of the public headers without a warning") {
  if (std::system("command -v doxygen >/dev/null") != 0) {
    std::cout << "skipped: no doxygen\n";
    return;
  }
  const TemporaryFolder scratch;
  const fs::path& folder = scratch.folder();
  int code = 0;
  INFO(run("'" + (kRoot / "tools/docs").string() + "' --api api", folder, code));
  CHECK(code == 0);
  CHECK(fs::exists(folder / "api/index.html"));
  CHECK(fs::exists(folder / "api/jump_8hpp.html"));
}

TEST_CASE("the annotated problem of problems/README.md is a problem that can be planned") {
  const std::string page = read_text_file((kRoot / "problems/README.md").string());
  const std::size_t begin = page.find("```yaml\n");
  REQUIRE(begin != std::string::npos);
  const std::string text = page.substr(begin + 8, page.find("```", begin + 8) - begin - 8);
  const TemporaryFolder scratch;
  const fs::path& folder = scratch.folder();
  fs::copy(kRoot / "problems", folder / "problems", fs::copy_options::recursive);
  write_file_atomically((folder / "problems/annotated.yaml").string(), text, false);
  int code = 0;
  INFO(run(std::string(STILLBASE_TOOL) + " plan problems/annotated.yaml -o plan.json", folder,
           code));
  CHECK(code == 0);
}

}  // namespace stillbase
