#include "app/quantity.hpp"

#include <optional>
#include <string_view>

#include <fmt/format.h>

#include "app/tool.hpp"

namespace stillbase::app {

double read_quantity(const std::string& option, const std::string& text, io::Dimension dimension,
                     const io::Range& range) {
  const io::Scanned number = io::scan_number(text);
  std::string_view unit = number.remainder;
  while (!unit.empty() && unit.front() == ' ') unit.remove_prefix(1);
  const std::optional<double> factor =
      unit.empty() ? std::optional<double>(1) : io::unit_factor(unit, dimension);
  // Digits behind a zero are octal in some files; on the command line they are not.
  const bool is_number = number.result == io::Scanned::Result::Good ||
                         number.result == io::Scanned::Result::LeadingZero;
  if (!is_number || !factor || !range.contains(number.value * *factor)) {
    throw CommandLineError(
        fmt::format("{} {}: must be a number {}, alone or with one of the units {}", option, text,
                    range.text(), io::units_of(dimension)));
  }
  return number.value * *factor;
}

}  // namespace stillbase::app
