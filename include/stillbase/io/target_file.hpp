// Target files, and what kind of file a text says it is.
#pragma once

#include <string>
#include <string_view>

#include <stillbase/target/target.hpp>

namespace stillbase {

/// Reads a target file (`format: stillbase.target`, problems/README.md).
/// @throws InputError with every finding
TargetBody read_target_text(std::string_view text, const std::string& source);

/// What a YAML or JSON text says it is, e.g. "stillbase.plan": the top-level key `format`. Empty
/// when it says nothing.
/// @throws InputError when the text is neither
std::string stated_format(std::string_view text, const std::string& source);

}  // namespace stillbase
