// Files built to hurt are refused within one second of processor time and 256 MB.
#include <catch2/catch.hpp>

#include "cli/tool.hpp"
#include "core/sanitized.hpp"
#include "stillbase/core/random.hpp"

using namespace stillbase::cli_test;

namespace {

/// Address space with which the tool starts, in kB: its libraries differ between systems.
int address_space_to_start(const Workshop& shop) {
  int size = 0;
  do {
    size += 16'384;
    REQUIRE(size < 1'000'000);
  } while (shop.run_script("ulimit -v " + std::to_string(size) + "; '" STILLBASE_TOOL "' --version")
               .code != 0);
  return size;
}

/// Runs `check` as a child that the system kills beyond the limits, 192 MB more than it takes to
/// start; sanitizers need more memory.
Outcome check_within_limits(const Workshop& shop, const std::string& file) {
#if STILLBASE_SANITIZED
  const std::string limits = "ulimit -t 30; ";
#else
  static const int size = address_space_to_start(shop) + 196'608;
  const std::string limits = "ulimit -v " + std::to_string(size) + "; ulimit -t 1; ";
#endif
  return shop.run_script(limits + "'" STILLBASE_TOOL "' check " + file);
}

void require_refused(const Workshop& shop, const std::string& file, const std::string& text,
                     const std::string& rule) {
  shop.write(file, text);
  const Outcome outcome = check_within_limits(shop, file);
  INFO(file << ": " << outcome.err.substr(0, 400));
  CHECK(outcome.code == 3);
  CHECK(outcome.says(file));
  CHECK(outcome.says(rule + ": "));
  CHECK(outcome.err.size() < 100'000);
}

std::string repeated(const std::string& part, int count) {
  std::string text;
  for (int i = 0; i < count; ++i) text += part;
  return text;
}

std::string random_bytes(std::size_t size, int lowest, int highest) {
  stillbase::Random random(3);
  std::string text(size, ' ');
  for (char& c : text) c = static_cast<char>(lowest + random.index(highest - lowest + 1));
  return text;
}

const std::string kRobot = file_text(source_path("problems/robots/planar_two_link_a.urdf"));
const std::string kProblem = file_text(source_path("problems/planar_two_link_c2_a.yaml"));

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  if (at == std::string::npos) throw std::logic_error("nothing to replace: " + from);
  return text.replace(at, from.size(), to);
}

}  // namespace

TEST_CASE("a good robot and a good problem are checked within the limits") {
  const Workshop shop;
  CHECK(check_within_limits(shop, "robots/iiwa_on_cube.urdf").code == 0);
  shop.write("problem.yaml", kProblem);
  CHECK(check_within_limits(shop, "problem.yaml").code == 0);
}

TEST_CASE("robot files built to hurt are refused quickly and in little memory") {
  const Workshop shop;
  const std::string open = "<robot name=\"r\">";
  require_refused(shop, "nested.urdf", open + repeated("<a>", 100'000), "too-deep");
  require_refused(shop, "closed.urdf",
                  open + repeated("<a>", 100'000) + repeated("</a>", 100'000) + "</robot>",
                  "too-deep");
  std::string links, short_links;
  for (int i = 0; i < 300'000; ++i) links += "<link name=\"l" + std::to_string(i) + "\"/>";
  require_refused(shop, "links.urdf", open + links + "</robot>", "too-large");
  for (int i = 0; i < 40'000; ++i) short_links += "<link name=\"" + std::to_string(i) + "\"/>";
  require_refused(shop, "short.urdf", open + short_links + "</robot>", "too-many-links");
  require_refused(shop, "bytes.urdf", random_bytes(10'000'000, 0, 255), "too-large");
  require_refused(shop, "letters.urdf", random_bytes(1'000'000, ' ', '~'), "xml");
  require_refused(shop, "comma.urdf", replaced(kRobot, "value=\"100\"", "value=\"100,5\""),
                  "not-a-number");
  std::string bomb = "<!DOCTYPE r [<!ENTITY a \"aaaaaaaaaa\">";
  for (char c = 'b'; c < 'k'; ++c) {
    bomb += std::string("<!ENTITY ") + c + " \"" +
            repeated(std::string("&") + static_cast<char>(c - 1) + ";", 10) + "\">";
  }
  require_refused(shop, "bomb.urdf", bomb + "]>" + open + "&j;</robot>", "doctype");
  require_refused(shop, "mesh.urdf",
                  replaced(kRobot, "<link name=\"hand\"/>",
                           "<link name=\"hand\"><collision><geometry><mesh "
                           "filename=\"../../../etc/passwd\"/></geometry></collision></link>"),
                  "mesh-path");
}

TEST_CASE("problem and plan files built to hurt are refused quickly and in little memory") {
  const Workshop shop;
  for (const char* name : {"bad.yaml", "bad.json"}) {
    require_refused(shop, name, "a: " + repeated("[", 100'000), "too-deep");
    require_refused(shop, name, "{\"a\": " + repeated("[", 100'000) + repeated("]", 100'000) + "}",
                    "too-deep");
    require_refused(shop, name, random_bytes(10'000'000, 0, 255), "not-utf-8");
    require_refused(shop, name, random_bytes(10'000'000, ' ', '~'), "syntax");
    require_refused(shop, name, "{\"a\": \"" + std::string(10'000'000, 'a') + ", 1", "syntax");
  }
  require_refused(shop, "bad.yaml", "format: stillbase.problem\n" + repeated("a: 1\n", 100'000),
                  "too-large");
  require_refused(shop, "numbers.json", "[" + repeated("1,", 5'000'000) + "1]", "too-large");
  std::string bomb = "a: &a [x, x, x, x, x, x, x, x, x]\n";
  for (char c = 'b'; c < 'k'; ++c) {
    bomb += std::string(1, c) + ": &" + c + " [" +
            repeated(std::string("*") + static_cast<char>(c - 1) + ", ", 9) + "]\n";
  }
  require_refused(shop, "bomb.yaml", kProblem + bomb, "anchor");
  require_refused(shop, "comma.yaml",
                  replaced(kProblem, "closing_speed: 1 m/s", "closing_speed: 1,5"), "wrong-type");
  require_refused(shop, "path.yaml", replaced(kProblem, "file: targets", "file: ../../../targets"),
                  "missing-file");
}
