#include "robot/srdf_reader.hpp"

#include <stillbase/core/file.hpp>

#include "robot/urdf_element.hpp"

namespace stillbase {

Srdf read_srdf(std::string_view text, const std::string& source) {
  urdf::Findings findings(source);
  tinyxml2::XMLDocument document;
  urdf::parse_robot(text, document, findings);
  Srdf srdf;
  urdf::Element robot(*document.RootElement(), findings);
  robot.each("group", 0, urdf::kAny, [&](urdf::Element& group) {
    group.text("name", true);
    group.each("chain", 0, urdf::kAny, [&](urdf::Element& chain) {
      chain.text("base_link", true);
      srdf.chain_tips.push_back(chain.text("tip_link", true));
    });
    group.ignore({"link", "joint", "group"});
  });
  robot.each("disable_collisions", 0, urdf::kAny, [&](urdf::Element& pair) {
    const std::string a = pair.text("link1", true), b = pair.text("link2", true);
    pair.text("reason", false);
    srdf.disabled_collisions.emplace_back(a, b);
  });
  findings.raise();
  return srdf;
}

}  // namespace stillbase
