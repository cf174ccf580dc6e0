// Files that a file names.
#pragma once

#include <optional>
#include <string>

#include "io/field_reader.hpp"

namespace stillbase::io {

/// Text of a file that a key names; one that is missing is a finding at that key.
/// @param folder in which relative paths start; empty: no file may be read
/// @param full_path set to the path that was read
std::optional<std::string> read_named_file(MapReader& map, const std::string& key,
                                           const std::string& name,
                                           const std::optional<std::string>& folder,
                                           std::string& full_path);

}  // namespace stillbase::io
