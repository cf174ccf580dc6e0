#include "plan/exclusion_words.hpp"

#include <fmt/format.h>

namespace stillbase::exclusion {

std::string not_at_rest(double horizon) {
  return fmt::format("robot and target do not rest within the horizon of {:.4g} s", horizon);
}

std::string of_most(const LimitUse& use) {
  if (use.limit == CaptureLimit::WheelMomentum && use.most <= 0) {
    return fmt::format(", and there is no wheel about {}", use.place);
  }
  return fmt::format(" of {:.4g} {}", use.most, use.unit);
}

}  // namespace stillbase::exclusion
