// The smallest pieces of reading: what a node is, and the number that a text starts with.
#pragma once

#include <string>
#include <string_view>

#include "io/document.hpp"

namespace stillbase::io {

/// What a node is, for messages.
std::string describe(const Node& node);

/// Leading number of a text by from_chars alone: no locale, no octal, no hexadecimal.
struct Scanned {
  enum class Result { None, Good, LeadingZero, Overflow };
  Result result = Result::None;
  double value = 0;
  std::string_view rest;
};

Scanned scan_number(std::string_view text);

}  // namespace stillbase::io
