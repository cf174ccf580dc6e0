// Help, the manual page and completion.
#include <catch2/catch.hpp>

#include <algorithm>
#include <regex>

#include "cli/tool.hpp"

using namespace stillbase::cli_test;

namespace {

const std::string kHelp = "'" STILLBASE_TOOL "' help ";

long lines_in(const std::string& text) { return std::count(text.begin(), text.end(), '\n'); }

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

}  // namespace

TEST_CASE("help explains topics and commands, -V prints the version") {
  const Workshop shop;
  const Outcome version = shop.run("-V");
  CHECK(version.code == 0);
  CHECK(version.out == shop.run("--version").out);
  const Outcome topics = shop.run("help");
  CHECK(topics.code == 0);
  for (const char* topic : {"files", "units", "exit-codes", "optimizers", "controllers",
                            "contact-laws", "frames", "objectives", "planners", "environment"}) {
    INFO(topic);
    CHECK(contains(topics.out, std::string("  ") + topic + " "));
    const Outcome page = shop.run(std::string("help ") + topic);
    CHECK(page.code == 0);
    CHECK(lines_in(page.out) >= 3);
    // Every word of a registry has its sentence.
    CHECK_FALSE(std::regex_search(page.out, std::regex("\n  [a-z_]+ *\n  [a-z_]+ *\n")));
  }
  CHECK(shop.run("help optimisers").says("did you mean 'optimizers'?"));
  CHECK(shop.run("help exit codes").out == shop.run("help exit-codes").out);
  CHECK(shop.run("help plan").out == shop.run("plan --help").out);
  CHECK(shop.run("help campaign run").out == shop.run("campaign run --help").out);
}

TEST_CASE("the manual page has every command and option, and groff finds no fault") {
  const Workshop shop;
  REQUIRE(shop.run_script(kHelp + "--man >stillbase.1").code == 0);
  const std::string page = shop.text("stillbase.1");
  for (const char* part : {".TH STILLBASE 1", ".SS campaign merge", "\\-\\-optimizer", "NO_COLOR",
                           ".SS exit\\-codes"}) {
    INFO(part);
    CHECK(contains(page, part));
  }
  if (shop.run_script("command -v groff").code != 0) return;
  const Outcome checked = shop.run_script("groff -man -Tutf8 -ww -z stillbase.1");
  CHECK(checked.code == 0);
  CHECK(checked.err.empty());
}

TEST_CASE("bash completes commands, options and words") {
  const Workshop shop;
  REQUIRE(shop.run_script(kHelp + "--completion bash >completion").code == 0);
  const auto completed = [&shop](const std::string& line) {
    shop.write("ask", "source ./completion\nCOMP_WORDS=(" + line +
                          ")\nCOMP_CWORD=$((${#COMP_WORDS[@]} - 1))\n_stillbase\n"
                          "echo \"${COMPREPLY[@]}\"\n");
    return shop.run_script("bash ask").out;
  };
  CHECK(completed("stillbase ver") == "verify\n");
  CHECK(completed("stillbase campaign m") == "make merge\n");
  CHECK(completed("stillbase plan --opt") == "--optimizer\n");
  CHECK(completed("stillbase plan --optimizer ipopt-") == "ipopt-lbfgs\n");
  CHECK(completed("stillbase campaign run --sh") == "--shard\n");
  CHECK(completed("stillbase schema prob") == "problem\n");
  CHECK(completed("stillbase plan --seed ''") == "\n");
  if (shop.run_script("command -v zsh").code != 0) return;
  REQUIRE(shop.run_script(kHelp + "--completion zsh >_stillbase").code == 0);
  CHECK(shop.run_script("zsh -n _stillbase").code == 0);
}
