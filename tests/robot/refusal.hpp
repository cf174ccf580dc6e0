// What a reader says of a text that it refuses.
#pragma once

#include <stdexcept>
#include <string>

namespace stillbase::test {

/// Empty: it is read.
template <class Read>
std::string refusal_of(const Read& read) {
  try {
    read();
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

}  // namespace stillbase::test
