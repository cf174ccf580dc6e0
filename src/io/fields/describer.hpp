// What a table of fields says, as JSON Schema and as rows of the reference.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "io/fields/table.hpp"

namespace stillbase::io {

/// Runs a table once for every combination of the words that decide and of the keys that may be
/// stated or not. Runs that allow the same keys become one alternative of the schema.
class TableDescriber : public Table {
 public:
  explicit TableDescriber(Definitions& definitions) : definitions_(definitions) {}
  /// @param alone key of the word that may stand for the map; empty: none
  Shape describe(const TableBody& body, const std::string& alone);

  bool states(const std::string& key, bool is_written) override;
  int one_of(const std::vector<std::string>& keys, int written, const std::string& rule) override;
  void not_both(const std::string& a, const std::string& b) override;
  void operator()(const std::string& key, const Value& value, std::string_view text,
                  const About& about = {}) override;

 private:
  /// The keys that one run allows.
  struct Variant {
    Json properties = Json::object();
    std::set<std::string> required;
    std::map<std::string, std::vector<std::string>> words;  ///< of keys that decide
    std::vector<std::pair<std::string, std::string>> exclusive;
    bool operator==(const Variant&) const = default;
  };
  std::size_t choose(std::size_t count);
  bool next_run();
  void add_row(const FieldRow& row);
  void place_new_rows(std::size_t at);
  void merge_variants();
  Json schema_of(const Variant& variant) const;

  Definitions& definitions_;
  std::vector<std::size_t> choices_, counts_;  ///< of this run, in the order in which they came up
  std::size_t depth_ = 0;                      ///< choices made so far in this run
  std::vector<Variant> variants_;              ///< the last one is that of this run
  std::map<std::string, std::string> default_words_;
  bool is_one_of_ = false;  ///< exactly one of the keys of all runs
  std::vector<FieldRow> rows_;
  std::vector<FieldRow> new_rows_;  ///< of this run, behind the last row that an earlier run had
};

/// "text [unit]; default: x": what a schema says of a field.
std::string description_of(const FieldRow& row);
/// A schema with a description, beside which a reference may not stand.
Json described(const Json& schema, const std::string& description);
/// Bounds of a number.
void add_bounds(Json& schema, const Range& range);
/// Reference to a number with one of these units.
Json quantity(const std::string& name, const std::string& units, Definitions& definitions);

}  // namespace stillbase::io
