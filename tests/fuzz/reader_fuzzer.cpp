// libFuzzer harness of one reader, which `--reader=NAME` chooses (tests/fuzz/README.md).
#include <cstdint>
#include <cstdio>
#include <cstdlib>

#include "fuzz/readers.hpp"

namespace {

const stillbase::fuzz::Reader* chosen = nullptr;

}  // namespace

extern "C" int LLVMFuzzerInitialize(int* count, char*** arguments) {
  for (int i = 1; i < *count; ++i) {
    for (const stillbase::fuzz::Reader& reader : stillbase::fuzz::kReaders) {
      if ((*arguments)[i] == std::string("--reader=") + reader.name) chosen = &reader;
    }
  }
  if (chosen != nullptr) return 0;
  std::fputs("--reader=NAME is missing, one of:", stderr);
  for (const auto& reader : stillbase::fuzz::kReaders) std::fprintf(stderr, " %s", reader.name);
  std::fputs("\n", stderr);
  std::exit(2);
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  chosen->accepts({reinterpret_cast<const char*>(data), size});
  return 0;
}
