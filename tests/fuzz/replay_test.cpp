#include <catch2/catch.hpp>

#include <algorithm>
#include <filesystem>
#include <vector>

#include <stillbase/core/file.hpp>

#include "fuzz/fuzz_targets.hpp"

namespace {

namespace fs = std::filesystem;
using namespace stillbase;

struct Counts {
  int accepted = 0, refused = 0;
};

template <class Target>
Counts replay(const char* kind, Target target) {
  const fs::path folder = fs::path(STILLBASE_SOURCE_DIR) / "tests/fuzz/corpus" / kind;
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder)) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  Counts counts;
  for (const fs::path& file : files) {
    INFO(file.string());
    const std::string text = read_text_file(file.string());
    bool accepted = false;
    CHECK_NOTHROW(accepted = target(text));
    ++(accepted ? counts.accepted : counts.refused);
  }
  return counts;
}

}  // namespace

TEST_CASE("every robot of the fuzzer's corpus is accepted or refused with findings") {
  const Counts counts = replay("urdf", [](std::string_view text) { return fuzz::urdf(text); });
  CHECK(counts.accepted >= 3);
  CHECK(counts.refused >= 10);
}

TEST_CASE("every problem of the fuzzer's corpus is accepted or refused with findings") {
  const Counts counts =
      replay("problem", [](std::string_view text) { return fuzz::problem(text); });
  CHECK(counts.accepted >= 3);
  CHECK(counts.refused >= 10);
}
