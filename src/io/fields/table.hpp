// The language in which the fields of the file formats are stated, once each.
//
// A table is a function that names the fields of one section in order:
//
//     void fields(Table& t, SearchSpec& s) {
//       t("seed", Seed(s.seed), "same seed, same bytes");
//     }
//
// Three kinds of Table run it: MapReader reads a map of a file into `s`, TableWriter writes `s` as
// the normalised copy, TableDescriber makes the JSON Schema and the rows of the reference. The
// state of `s` before reading is the default. A condition between fields is an `if` on fields that
// were named before; the describer runs the table once for every word of a field that decides.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "io/json.hpp"
#include "io/scalars.hpp"

namespace stillbase::io {

class MapReader;

/// A row of the reference table.
struct FieldRow {
  std::string name;     ///< below the field that holds it: ".axis", "[].name"
  std::string text;     ///< what it means
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
};

/// A value of a file: where it is kept, how it is read, written and described.
class Value {
 public:
  virtual ~Value() = default;
  /// @return false with findings in the context: not such a value
  virtual bool read(ReadContext& context, const Node& node, const std::string& path) = 0;
  /// The field is not stated: puts a default in place that the data cannot hold beforehand.
  /// @return whether it may be left out although it is needed
  virtual bool leave_out(ReadContext&, const std::string&) { return false; }
  /// @throws NotFiniteError
  virtual Json write() const = 0;
  virtual bool is_written() const { return true; }
  virtual Shape shape(Definitions& definitions) = 0;
  virtual bool fits(const Node& node) const = 0;  ///< looks like such a value, among alternatives
};

/// What a table says of a field beside its value and its sentence.
struct About {
  Need need = Need::Optional;
  std::string frame = {};         ///< in which a vector is stated
  std::string without = {};       ///< what holds without it, where the data do not say it
  bool is_used = true;            ///< false: stated all the same it is refused
  std::string owner = {};         ///< "the measure cvar": what it belongs to, for that refusal
  std::optional<bool> when = {};  ///< stated exactly when this holds, unknown otherwise
  bool decides = false;           ///< a word on which other fields of the map depend
};

inline const About kNeeded{.need = Need::Required};

class Table {
 public:
  virtual ~Table() = default;
  void operator()(const std::string& key, Value&& value, const std::string& text,
                  const About& about = {}) {
    add(key, value, text, about);
  }
  /// Whether a key is there on which other fields of the map depend. @param is_written in a copy
  virtual bool states(const std::string& key, bool is_written) = 0;
  /// Index of the one key that is there; -1 with a finding of this rule: none or several.
  virtual int one_of(const std::vector<std::string>& keys, int written,
                     const std::string& rule) = 0;
  /// Two keys that stand for each other.
  virtual void not_both(const std::string& a, const std::string& b) = 0;
  /// The reader, for findings that take more than one field; null: not reading.
  virtual MapReader* reader() { return nullptr; }

 protected:
  virtual void add(const std::string& key, Value& value, const std::string& text,
                   const About& about) = 0;
};

/// The values of data as an object.
class TableWriter : public Table {
 public:
  Json json = Json::object();
  bool states(const std::string&, bool is_written) override { return is_written; }
  int one_of(const std::vector<std::string>&, int written, const std::string&) override {
    return written;
  }
  void not_both(const std::string&, const std::string&) override {}

 protected:
  void add(const std::string& key, Value& value, const std::string& text,
           const About& about) override;
};

using TableBody = std::function<void(Table&)>;

/// A map of fields.
class Map : public Value {
 public:
  struct Also {
    std::string alone = {};  ///< key of the word that may stand for a map of it alone
    std::string name = {};   ///< of the definition in schemas; its fields are not rows
    bool is_written = true;
    bool is_section = false;  ///< absent it is an empty map
  };
  explicit Map(TableBody body) : Map(std::move(body), Also{}) {}
  Map(TableBody body, Also also) : body_(std::move(body)), also_(std::move(also)) {}
  bool read(ReadContext& context, const Node& node, const std::string& path) override;
  bool leave_out(ReadContext& context, const std::string& path) override;
  Json write() const override;
  bool is_written() const override { return also_.is_written; }
  Shape shape(Definitions& definitions) override;
  bool fits(const Node& node) const override { return node.kind == Node::Kind::Map; }

 private:
  TableBody body_;
  Also also_;
};

/// The map of data for which there is a table `fields(Table&, T&)`.
template <class T>
Map map_of(T& data, Map::Also also = {}) {
  return {[&data](Table& t) { fields(t, data); }, std::move(also)};
}

struct ListLimits {
  std::size_t least = 0;
  bool is_unique = false;       ///< no value twice
  std::string unique_key = {};  ///< of maps: no two with the same value of this key
  std::string of = {};          ///< "pairs [link, link]", for messages
};

class ListValue : public Value {
 public:
  using Use = std::function<void(Value&)>;
  explicit ListValue(ListLimits limits) : limits_(std::move(limits)) {}
  bool read(ReadContext& context, const Node& node, const std::string& path) override;
  Json write() const override;
  Shape shape(Definitions& definitions) override;
  bool fits(const Node& node) const override { return node.kind == Node::Kind::Sequence; }

 protected:
  virtual std::size_t size() const = 0;
  virtual void clear() = 0;
  virtual void append() = 0;
  virtual void use(std::size_t i, const Use& how) const = 0;

 private:
  ListLimits limits_;
};

/// A list; `element` hands the value of one element on: [](T& x, auto use) { use(Text(x)); }.
template <class T, class Element>
class List : public ListValue {
 public:
  List(std::vector<T>& items, Element element, ListLimits limits = {})
      : ListValue(std::move(limits)), items_(items), element_(element) {}
  /// @param blank a new element, where T{} is none
  List(std::vector<T>& items, Element element, ListLimits limits, T blank)
      : List(items, element, std::move(limits)) {
    blank_ = std::move(blank);
  }

 protected:
  std::size_t size() const override { return items_.size(); }
  void clear() override { items_.clear(); }
  void append() override {
    if (blank_) {
      items_.push_back(*blank_);
    } else {
      items_.emplace_back();
    }
  }
  void use(std::size_t i, const Use& how) const override {
    element_(items_[i], [&how](Value&& value) { how(value); });
  }

 private:
  std::vector<T>& items_;
  Element element_;
  std::optional<T> blank_;
};

/// A list of maps for which there is a table `fields(Table&, T&)`.
template <class T, class... Blank>
auto maps_of(std::vector<T>& items, ListLimits limits = {}, Blank... blank) {
  return List(
      items, [](T& item, auto use) { use(map_of(item)); }, std::move(limits), std::move(blank)...);
}

class Alternatives : public Value {
 public:
  bool read(ReadContext& context, const Node& node, const std::string& path) override;
  Json write() const override;
  bool is_written() const override;
  Shape shape(Definitions& definitions) override;
  bool fits(const Node& node) const override;

 protected:
  virtual std::vector<Value*> values() const = 0;
};

/// One of several values: read as the first that a text looks like, or else the last; written as
/// the first that is to be written.
template <class... V>
class Either : public Alternatives {
 public:
  explicit Either(V... values) : values_(std::move(values)...) {}

 protected:
  std::vector<Value*> values() const override {
    return std::apply([](auto&... value) { return std::vector<Value*>{&value...}; }, values_);
  }

 private:
  mutable std::tuple<V...> values_;
};

/// A value that files may state and copies never do.
template <class V, class Then>
class Shorthand : public V {
 public:
  Shorthand(V value, Then then) : V(std::move(value)), then_(then) {}
  bool read(ReadContext& context, const Node& node, const std::string& path) override {
    if (!V::read(context, node, path)) return false;
    then_();
    return true;
  }
  bool is_written() const override { return false; }

 private:
  Then then_;
};

/// A value that is written when a condition holds.
template <class V>
class WrittenIf : public V {
 public:
  WrittenIf(V value, bool is_written) : V(std::move(value)), is_written_(is_written) {}
  bool is_written() const override { return is_written_; }

 private:
  bool is_written_;
};

/// A value or null.
template <class V, class MakeNull>
class OrNull : public V {
 public:
  OrNull(V value, bool is_null, MakeNull make_null)
      : V(std::move(value)), is_null_(is_null), make_null_(make_null) {}
  bool read(ReadContext& context, const Node& node, const std::string& path) override {
    if (!holds_null(node)) return V::read(context, node, path);
    make_null_();
    return true;
  }
  Json write() const override { return is_null_ ? Json() : V::write(); }
  bool is_written() const override { return true; }
  Shape shape(Definitions& definitions) override {
    Shape shape = V::shape(definitions);
    shape.schema = {{"anyOf", Json::array({shape.schema, {{"type", "null"}}})}};
    return shape;
  }

 private:
  static bool holds_null(const Node& node) {
    return node.kind == Node::Kind::Null || (node.kind == Node::Kind::Plain && node.text == "null");
  }
  bool is_null_;
  MakeNull make_null_;
};

}  // namespace stillbase::io
