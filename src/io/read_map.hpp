// A whole file that one table describes.
#pragma once

#include <string>
#include <string_view>

#include "io/fields/table.hpp"

namespace stillbase::io {

/// @throws InputError with every finding
void read_map(std::string_view text, const std::string& source, TableBody body,
              const DocumentLimits& limits = {});

}  // namespace stillbase::io
