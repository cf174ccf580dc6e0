// Package recipes against tools/setup and the project's version: a library that the build needs and
// a recipe does not name would only be missed on somebody else's machine.
#include <catch2/catch.hpp>

#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>

#include <nlohmann/json.hpp>

#include <stillbase/core/file.hpp>

namespace stillbase {
namespace {

std::string text_of(const std::string& path) {
  return read_text_file(std::string(STILLBASE_SOURCE_DIR) + "/" + path);
}

bool has_word(const std::string& text, const std::string& word) {
  const std::regex wanted("(^|[^a-z0-9_-])" + word + "([^a-z0-9_-]|$)");
  return std::regex_search(text, wanted);
}

/// Development packages that tools/setup installs for the library and the tool.
std::set<std::string> libraries_of_setup() {
  const std::string text = text_of("tools/setup");
  const std::size_t begin = text.find("# numbers, optimizers"), end = text.find("# tests");
  REQUIRE(begin != std::string::npos);
  REQUIRE(end != std::string::npos);
  std::istringstream lines(text.substr(begin, end - begin));
  std::set<std::string> out;
  for (std::string line; std::getline(lines, line);) {
    if (line.find('#') != std::string::npos) continue;
    std::istringstream words(line);
    for (std::string word; words >> word;) out.insert(word);
  }
  return out;
}

struct Names {
  std::string conda, vcpkg, conan, ros;
};

/// Debian package -> its name elsewhere. Boost is taken apart by vcpkg; Conan has no OMPL, which
/// that recipe takes from Debian.
const std::map<std::string, Names> kNames = {
    {"libeigen3-dev", {"eigen", "eigen3", "eigen", "eigen"}},
    {"libboost-dev", {"libboost-devel", "boost-odeint", "boost", "boost"}},
    {"libnlopt-dev", {"nlopt", "nlopt", "nlopt", "libnlopt-dev"}},
    {"coinor-libipopt-dev", {"ipopt", "coin-or-ipopt", "coin-ipopt", "coinor-libipopt-dev"}},
    {"libompl-dev", {"ompl", "ompl", "libompl-dev", "ompl"}},
    {"libfcl-dev", {"fcl", "fcl", "fcl", "libfcl-dev"}},
    {"libtinyxml2-dev", {"tinyxml2", "tinyxml2", "tinyxml2", "tinyxml2"}},
    {"libyaml-cpp-dev", {"yaml-cpp", "yaml-cpp", "yaml-cpp", "yaml-cpp"}},
    {"libassimp-dev", {"assimp", "assimp", "assimp", "assimp"}},
    {"libqhull-dev", {"qhull", "qhull", "qhull", "libqhull-dev"}},
    {"nlohmann-json3-dev",
     {"nlohmann_json", "nlohmann-json", "nlohmann_json", "nlohmann-json-dev"}},
    {"libcli11-dev", {"cli11", "cli11", "cli11", "libcli11-dev"}},
    {"libfmt-dev", {"fmt", "fmt", "fmt", "fmt"}},
    {"libssl-dev", {"openssl", "openssl", "openssl", "libssl-dev"}},
};

}  // namespace

TEST_CASE("every recipe names every library of the set-up script") {
  const std::string conda = text_of("packaging/conda/meta.yaml");
  const std::string vcpkg = text_of("packaging/vcpkg/vcpkg.json");
  const std::string conan = text_of("packaging/conan/conanfile.py");
  const std::string ros = text_of("package.xml");
  const std::string debian = text_of("cmake/packages.cmake");
  const std::set<std::string> libraries = libraries_of_setup();
  CHECK(libraries.size() >= 14);
  for (const std::string& library : libraries) {
    INFO(library);
    const auto names = kNames.find(library);
    REQUIRE(names != kNames.end());
    CHECK(has_word(conda, names->second.conda));
    CHECK(has_word(vcpkg, names->second.vcpkg));
    CHECK(has_word(conan, names->second.conan));
    CHECK(has_word(ros, names->second.ros));
    // Of the command line alone: no part of the development package.
    CHECK(has_word(debian, library) == (library != "libcli11-dev"));
  }
}

TEST_CASE("every recipe has the version of the project") {
  const std::string project = text_of("CMakeLists.txt");
  std::smatch found;
  REQUIRE(std::regex_search(project, found, std::regex("project\\(stillbase VERSION ([0-9.]+)")));
  const std::string version = found[1];
  for (const char* file : {"package.xml", "packaging/conda/meta.yaml", "packaging/vcpkg/vcpkg.json",
                           "packaging/conan/conanfile.py", "CITATION.cff"}) {
    INFO(file);
    CHECK(has_word(text_of(file), std::regex_replace(version, std::regex("\\."), "\\.")));
  }
  CHECK(nlohmann::json::parse(text_of("packaging/vcpkg/vcpkg.json")).at("version") == version);
  CHECK(nlohmann::json::parse(text_of(".devcontainer/devcontainer.json")).at("image") ==
        "debian:bookworm");
}

}  // namespace stillbase
