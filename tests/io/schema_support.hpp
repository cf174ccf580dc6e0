// What the tests of the schemas share: files as the documents that validators see.
#pragma once

#include <string>

#include <catch2/catch.hpp>

#include <stillbase/io/schema.hpp>

#include "io/io_support.hpp"
#include "io/scalars.hpp"
#include "support/schema_check.hpp"

namespace stillbase::io_test {

using test::json;

/// A parsed file with the types that YAML gives its values.
inline json typed(const io::Node& node) {
  switch (node.kind) {
    case io::Node::Kind::Null:
      return nullptr;
    case io::Node::Kind::Quoted:
      return node.text;
    case io::Node::Kind::Plain: {
      if (node.text == "true" || node.text == "false") return node.text == "true";
      const io::Scanned number = io::scan_number(node.text);
      if (number.result != io::Scanned::Result::Good || !number.remainder.empty()) return node.text;
      if (node.text.find_first_of(".eE") != std::string::npos) return number.value;
      return static_cast<std::int64_t>(number.value);
    }
    case io::Node::Kind::Sequence: {
      json list = json::array();
      for (const io::Node& item : node.items) list.push_back(typed(item));
      return list;
    }
    case io::Node::Kind::Map: {
      json map = json::object();
      for (std::size_t i = 0; i < node.keys.size(); ++i) map[node.keys[i]] = typed(node.items[i]);
      return map;
    }
  }
  return nullptr;
}

inline json yaml(const std::string& text) {
  io::ReadContext context{"test.yaml", {}, {}};
  const io::Node root = io::parse_document(text, context);
  REQUIRE(context.findings.empty());
  return typed(root);
}

inline json schema(const std::string& name) { return json::parse(schema_of(name)); }

inline bool starts_with(const std::string& text, const std::string& with) {
  return text.rfind(with, 0) == 0;
}

}  // namespace stillbase::io_test
