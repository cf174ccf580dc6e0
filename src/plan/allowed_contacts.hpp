// Pairs that may touch.
#pragma once

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

namespace stillbase {

/// Whether two names are one of the pairs, in either order.
inline bool is_allowed(const std::vector<std::pair<std::string, std::string>>& pairs,
                       const std::string& a, const std::string& b) {
  return std::any_of(pairs.begin(), pairs.end(), [&](const auto& pair) {
    return (pair.first == a && pair.second == b) || (pair.first == b && pair.second == a);
  });
}

}  // namespace stillbase
