// A text file after parsing: maps, sequences and scalars with their lines, nothing interpreted yet.
#pragma once

#include <algorithm>
#include <cstddef>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <stillbase/core/error.hpp>

namespace stillbase::io {

struct Node {
  enum class Kind { Null, Plain, Quoted, Sequence, Map };
  Kind kind = Kind::Null;
  int line = 0;                   ///< 1-based
  std::string text;               ///< Plain, Quoted
  std::vector<Node> items;        ///< elements of a sequence, values of a map
  std::vector<std::string> keys;  ///< Map: beside items
  std::vector<int> key_lines;     ///< Map: beside items

  /// The value of a key of a map; null: there is none.
  const Node* find(std::string_view key) const {
    const auto at = std::find(keys.begin(), keys.end(), key);
    return at == keys.end() ? nullptr : &items[static_cast<std::size_t>(at - keys.begin())];
  }
};

/// What one reading has found so far.
struct ReadContext {
  std::string source;                 ///< file named in findings
  std::vector<Finding> findings;      ///< everything wrong
  std::set<std::string> known_keys;   ///< paths that were asked for, "[]" for list elements
  std::vector<Finding> remarks = {};  ///< what is allowed and looks like a mistake

  void add(int line, std::string rule, std::string message) {
    findings.push_back({source, line, std::move(rule), std::move(message)});
  }
  void throw_if_any() const {
    if (!findings.empty()) throw InputError(findings);
  }
};

struct DocumentLimits {
  std::size_t bytes = 1u << 20;
  int depth = 32;
  std::size_t nodes = 100'000;
};

/// Of a plan, the largest of the files.
inline constexpr DocumentLimits kPlanLimits{.bytes = 64u << 20, .depth = 32, .nodes = 1'000'000};

/// Parses one YAML document (JSON is YAML).
///
/// Refused: several documents, anchors, aliases, merge keys, tags, keys that are not text,
/// duplicate keys, text that is not UTF-8. Duplicates and the like are added to the context and the
/// first one wins, so that everything else is still judged.
/// @throws InputError with the context's findings when no tree can be made: syntax, size, depth,
/// number of nodes
Node parse_document(std::string_view text, ReadContext& context, const DocumentLimits& limits = {});

/// Of a file that says that it is something else, nothing more is said than that.
/// @param own format that the file should state, "stillbase.plan"
/// @throws InputError
void refuse_other_format(const Node& root, const std::string& source, const std::string& own);

}  // namespace stillbase::io
