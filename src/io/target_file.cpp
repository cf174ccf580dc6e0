#include <stillbase/io/target_file.hpp>

#include "io/fields/sections.hpp"
#include "io/read_map.hpp"

namespace stillbase {

TargetBody read_target_text(std::string_view text, const std::string& source) {
  TargetBody body;
  io::read_map(text, source, [&](io::Table& t) { io::target_file_fields(t, body); });
  return body;
}

std::string stated_format(std::string_view text, const std::string& source) {
  io::ReadContext context{source, {}, {}};
  // As large as a plan may be.
  const io::Node root =
      io::parse_document(text, context, {.bytes = 64u << 20, .depth = 32, .nodes = 200'000});
  for (std::size_t i = 0; i < root.keys.size(); ++i) {
    if (root.keys[i] == "format") return root.items[i].text;
  }
  return "";
}

}  // namespace stillbase
