// Catch2 3 under the name that Catch2 2 has for its header. tests/CMakeLists.txt puts this folder
// on the include path where it finds version 3.
#pragma once

#include <string>

#include <catch2/catch_all.hpp>

using Catch::Approx;

namespace Catch {

/// Version 2's names of matchers.
inline auto Contains(const std::string& text) { return Matchers::ContainsSubstring(text); }
inline auto StartsWith(const std::string& text) { return Matchers::StartsWith(text); }

}  // namespace Catch
