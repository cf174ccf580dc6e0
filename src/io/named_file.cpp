#include "io/named_file.hpp"

#include <filesystem>

#include <fmt/format.h>

#include <stillbase/core/file.hpp>

namespace stillbase::io {

std::optional<std::string> read_named_file(MapReader& map, const std::string& key,
                                           const std::string& name,
                                           const std::optional<std::string>& folder,
                                           std::string& full_path) {
  if (!folder) {
    map.refuse(key, "not-used",
               fmt::format("'{}' cannot be read from here; state its content in place", name));
    return std::nullopt;
  }
  full_path = (std::filesystem::path(*folder) / name).string();
  try {
    return read_text_file(full_path, DocumentLimits{}.bytes);
  } catch (const InputError& error) {
    for (const Finding& finding : error.findings()) {
      map.refuse(key, finding.rule, fmt::format("{}: {}", full_path, finding.message));
    }
  }
  return std::nullopt;
}

}  // namespace stillbase::io
