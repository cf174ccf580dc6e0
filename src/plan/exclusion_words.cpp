#include "plan/exclusion_words.hpp"

#include <fmt/format.h>

namespace stillbase::exclusion {

std::string not_at_rest(double horizon) {
  return fmt::format("robot and target do not rest within the horizon of {:.4g} s", horizon);
}

}  // namespace stillbase::exclusion
