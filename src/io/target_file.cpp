#include <stillbase/io/target_file.hpp>

#include "io/target_reader.hpp"

namespace stillbase {

TargetBody read_target_text(std::string_view text, const std::string& source) {
  io::ReadContext context{source, {}, {}};
  TargetBody body = io::read_target_file(io::parse_document(text, context), context);
  context.throw_if_any();
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
