// Numbers with units on the command line.
#pragma once

#include <string>

#include "io/scalars.hpp"

namespace stillbase::app {

/// In SI: "10ms", "10 ms" or "0.01" of a time.
/// @param option that has the text as its value, for the message
/// @throws CommandLineError for what is no number of this dimension, or outside the range
double read_quantity(const std::string& option, const std::string& text, io::Dimension dimension,
                     const io::Range& range);

}  // namespace stillbase::app
