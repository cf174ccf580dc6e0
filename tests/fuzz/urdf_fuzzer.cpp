// libFuzzer harness of the urdf reader; built with -D STILLBASE_FUZZ=ON (tests/fuzz/README.md).
#include "fuzz/fuzz_targets.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  stillbase::fuzz::urdf(stillbase::fuzz::as_text(data, size));
  return 0;
}
