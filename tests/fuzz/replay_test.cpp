// The fuzzer's corpus with any compiler.
#include <catch2/catch.hpp>

#include <algorithm>
#include <filesystem>
#include <vector>

#include <stillbase/core/file.hpp>

#include "fuzz/readers.hpp"

namespace fs = std::filesystem;
using namespace stillbase;

TEST_CASE("every file of the fuzzer's corpus is accepted or refused with findings") {
  for (const fuzz::Reader& reader : fuzz::kReaders) {
    const fs::path folder = fs::path(STILLBASE_SOURCE_DIR) / "tests/fuzz/corpus" / reader.name;
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(folder)) files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    int accepted = 0, refused = 0;
    for (const fs::path& file : files) {
      INFO(file.string());
      const std::string text = read_text_file(file.string());
      bool is_accepted = false;
      CHECK_NOTHROW(is_accepted = reader.accepts(text));
      ++(is_accepted ? accepted : refused);
    }
    INFO(reader.name);
    CHECK(accepted >= 1);
    CHECK(refused >= 1);
  }
}
