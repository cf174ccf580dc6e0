// Typed access to the fields of one map of a parsed file.
#pragma once

#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "io/fields/table.hpp"

namespace stillbase::io {

/// The fields of one map, as a table names them or one at a time. Keys that nobody asked for are
/// reported by finish().
class MapReader : public Table {
 public:
  MapReader(ReadContext& context, const Node& node, std::string path);

  ReadContext& context() const { return context_; }
  const std::string& path() const { return path_; }
  std::string path_of(const std::string& key) const;
  int line() const { return node_.line; }
  /// Line of a key, or of the map when it is absent.
  int line_of(std::string_view key) const;
  bool has(std::string_view key) const { return find(key) != nullptr; }
  const Node* find(std::string_view key) const { return node_.find(key); }
  /// The value of a key, or null; from now on the key is known.
  const Node* child(const std::string& key, Need need = Need::Optional);
  /// A key is stated, and its value is not good.
  bool was_refused(const std::string& key) const { return refused_.count(key) > 0; }
  const std::vector<std::string>& missing() const { return missing_; }
  /// Adds the finding "path.key: what" at the line of the key.
  void refuse(const std::string& key, std::string rule, const std::string& what);
  /// Text of a file that a key names; one that is missing is a finding at that key.
  /// @param folder in which relative paths start; empty: no file may be read
  /// @param full_path set to the path that was read
  std::optional<std::string> read_file(const std::string& key, const std::string& name,
                                       const std::optional<std::string>& folder,
                                       std::string& full_path);
  void finish();

  bool states(const std::string& key, bool is_written) override;
  int one_of(const std::vector<std::string>& keys, int written, const std::string& rule) override;
  void not_both(const std::string& a, const std::string& b) override;
  MapReader* reader() override { return this; }
  void operator()(const std::string& key, const Value& value, std::string_view text,
                  const About& about = {}) override;

 private:
  void note(const std::string& key);  ///< adds to the keys that were asked for
  void miss(const std::string& key);  ///< adds the finding that it must be stated

  ReadContext& context_;
  const Node& node_;
  std::string path_;
  std::vector<std::string> known_, missing_;
  std::vector<std::string> elsewhere_;  ///< keys that may be stated instead of others
  std::set<std::string> refused_;
};

}  // namespace stillbase::io
