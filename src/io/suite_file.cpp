#include <stillbase/io/suite_file.hpp>

#include <filesystem>

#include <stillbase/core/file.hpp>

#include "io/fields/sections.hpp"
#include "io/read_map.hpp"

namespace stillbase {

SuiteSpec read_suite(const std::string& path) {
  SuiteSpec suite;
  const std::string folder = std::filesystem::path(path).parent_path().string();
  io::read_map(read_text_file(path, io::DocumentLimits{}.bytes), path,
               [&](io::Table& t) { io::suite_fields(t, suite, folder); });
  return suite;
}

}  // namespace stillbase
