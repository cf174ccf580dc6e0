// The language in which the fields of the file formats are stated, once each.
//
// A table is a function that names the fields of one section in order:
//
//     void fields(Table& t, SearchSpec& s) {
//       t("seed", Seed(s.seed), "same seed, same bytes");
//     }
//
// Three kinds of Table run it: MapReader reads a map of a file into `s`, TableWriter writes `s` as
// JSON, TableDescriber makes the JSON Schema and the rows of the reference. The state of `s` before
// reading is the default. A condition between fields is an `if` on fields that were named before;
// the describer runs the table once for every word of a field that decides.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "io/json.hpp"
#include "io/scalars.hpp"

namespace stillbase::io {

class MapReader;

/// A row of the reference table.
struct FieldRow {
  std::string name;     ///< below the field that holds it: ".axis", "[].name"
  std::string text;     ///< what it means
  std::string shape;    ///< of lists: "3", "k x n"
  std::string unit;     ///< unit and frame
  std::string range;    ///< "> 0", "in [0, 1]"
  std::string without;  ///< what holds without it: the default, "required", "none"
};

using Definitions = Json;  ///< name -> schema that several fields refer to

/// What schema and reference say of a value.
struct Shape {
  Json schema;
  std::string unit = {}, range = {};
  std::vector<FieldRow> rows = {};  ///< of the fields inside
  /// Of arrays of numbers: "3", "k x n"; k is any number, n the number of joints. Empty: no array.
  std::string extents = {};
};

/// A value of a file: how it is read, written and described. It refers to the data that keep it.
struct Value {
  /// @return false with findings in the context: the node holds no such value
  std::function<bool(ReadContext&, const Node&, const std::string& path)> read;
  std::function<Json()> write;  ///< @throws NotFiniteError
  std::function<Shape(Definitions&)> shape;
  /// Whether a node looks like such a value, among alternatives.
  std::function<bool(const Node&)> fits = is_scalar;
  bool is_written = true;
  /// Puts a default in place that the data cannot hold before the field is known to be absent.
  /// @param line of the map that lacks the field
  /// @return whether the field may be left out although it is needed
  std::function<bool(ReadContext&, const std::string& path, int line)> leave_out = nullptr;
  /// Of a word of a closed list: the list, and a function that makes the data hold its word i.
  std::vector<std::string> words = {};
  std::function<void(std::size_t)> choose = nullptr;
};

/// A default as the reference shows it, by what the data hold; "none" of a value that is not
/// written.
std::string default_text(const Value& value);

/// What a table says of a field beside its value and its sentence.
struct About {
  Need need = Need::Optional;
  std::string unit = {};          ///< where the value does not say it
  std::string frame = {};         ///< in which a vector is stated
  std::string without = {};       ///< what holds without it, where the data do not say it
  bool is_used = true;            ///< false: stated all the same it is refused
  std::string owner = {};         ///< "the measure cvar": what it belongs to, for that refusal
  std::optional<bool> when = {};  ///< stated exactly when this holds, unknown otherwise
  bool decides = false;           ///< a word on which other fields of the map depend
};

inline const About kNeeded{.need = Need::Required};
About needed(std::string unit, std::string frame = {});

class Table {
 public:
  virtual ~Table() = default;
  virtual void operator()(const std::string& key, const Value& value, std::string_view text,
                          const About& about = {}) = 0;
  /// Whether a key is there on which other fields of the map depend. @param is_written in a copy
  virtual bool states(const std::string& key, bool is_written) = 0;
  /// Index of the one key that is there; -1 with a finding of this rule: none or several.
  virtual int one_of(const std::vector<std::string>& keys, int written,
                     const std::string& rule) = 0;
  /// Two keys that stand for each other.
  virtual void not_both(const std::string& a, const std::string& b) = 0;
  /// The reader, for findings that take more than one field; null: not reading.
  virtual MapReader* reader() { return nullptr; }
};

/// The values of data as an object.
class TableWriter : public Table {
 public:
  Json json = Json::object();
  void operator()(const std::string& key, const Value& value, std::string_view text,
                  const About& about = {}) override;
  bool states(const std::string&, bool is_written) override { return is_written; }
  int one_of(const std::vector<std::string>&, int written, const std::string&) override {
    return written;
  }
  void not_both(const std::string&, const std::string&) override {}
};

using TableBody = std::function<void(Table&)>;

/// The object that a table writes.
Json written(const TableBody& body);

/// Reads a whole file that one table describes.
/// @throws InputError with every finding
void read_map(std::string_view text, const std::string& source, const TableBody& body,
              const DocumentLimits& limits = {});
/// The same of JSON text that a program wrote on one line.
void read_json(std::string_view text, const std::string& source, const TableBody& body);

struct MapOptions {
  std::string alone = {};  ///< key of the word that may stand for a map of it alone
  std::string name = {};   ///< of the definition in schemas; its fields are not rows
  bool is_written = true;
  bool is_section = false;  ///< absent it is an empty map
};

/// A map of fields.
struct Map : Value {
  explicit Map(const TableBody& body, const MapOptions& options = {});
};

/// The map of data for which there is a table `fields(Table&, T&)`.
template <class T>
Map map_of(T& data, const MapOptions& options = {}) {
  return Map([&data](Table& t) { fields(t, data); }, options);
}

struct ListLimits {
  std::size_t least = 0;
  bool is_unique = false;       ///< no value twice
  std::string unique_key = {};  ///< of maps: no two with the same value of this key
  std::string of = {};          ///< "pairs [link, link]", for messages
};

/// A list of values, whatever keeps them.
struct ListValue : Value {
  struct Items {
    std::function<std::size_t()> size;
    std::function<void()> clear, append;
    std::function<Value(std::size_t)> at;
  };
  ListValue(const Items& items, const ListLimits& limits);
};

template <class T>
using Element = std::type_identity_t<std::function<Value(T&)>>;

/// A list. @param element the value of one item @param blank a new item
template <class T>
struct List : ListValue {
  List(std::vector<T>& items, const Element<T>& element, const ListLimits& limits = {},
       const T& blank = T{})
      : ListValue({[&items] { return items.size(); }, [&items] { items.clear(); },
                   [&items, blank] { items.push_back(blank); },
                   [&items, element](std::size_t i) { return element(items[i]); }},
                  limits) {}
};

/// A list of maps for which there is a table `fields(Table&, T&)`.
template <class T, class... Blank>
List<T> maps_of(std::vector<T>& items, const ListLimits& limits = {}, const Blank&... blank) {
  return List<T>(
      items, [](T& item) { return map_of(item); }, limits, blank...);
}

/// A map of any keys to values of one kind, whatever keeps them.
struct DictionaryValue : Value {
  /// @param at the value of a key, made when it is new
  DictionaryValue(const std::function<std::vector<std::string>()>& keys,
                  const std::function<Value(const std::string&)>& at,
                  const std::function<Value()>& sample);
};

template <class T>
struct Dictionary : DictionaryValue {
  Dictionary(std::map<std::string, T>& map, const Element<T>& element)
      : DictionaryValue(
            [&map] {
              std::vector<std::string> keys;
              for (const auto& entry : map) keys.push_back(entry.first);
              return keys;
            },
            [&map, element](const std::string& key) { return element(map[key]); },
            [element] {
              static T sample{};
              return element(sample);
            }) {}
};

/// One of several values: read as the first that a text looks like, or else the last; written as
/// the first that is to be written.
struct Either : Value {
  explicit Either(const std::vector<Value>& values);
};

/// A word among alternatives that stands for a state of the data.
struct Instead : Value {
  Instead(
      const std::string& word, bool is_now, const std::function<void()>& make = [] {});
};

/// A value that files may state and copies never do. @param then after reading
struct Shorthand : Value {
  Shorthand(const Value& value, const std::function<void()>& then);
};

/// A value that is written when a condition holds.
struct WrittenIf : Value {
  WrittenIf(const Value& value, bool condition) : Value(value) { is_written = condition; }
};

/// A value or null.
struct OrNull : Value {
  OrNull(
      const Value& value, bool is_null, const std::function<void()>& make_null = [] {});
};

}  // namespace stillbase::io
