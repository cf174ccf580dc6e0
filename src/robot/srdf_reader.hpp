// SRDF: what MoveIt's set-up says of a robot beside its URDF.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace stillbase {

struct Srdf {
  /// Links between which collisions are not checked.
  std::vector<std::pair<std::string, std::string>> disabled_collisions;
  /// Last links of the groups that are chains, in file order.
  std::vector<std::string> chain_tips;
};

/// Reads the groups and the disabled collisions; everything else is left out.
/// @throws InputError no well-formed XML, no <robot>, or a name that is missing: file and line
Srdf read_srdf(std::string_view text, const std::string& source);

}  // namespace stillbase
