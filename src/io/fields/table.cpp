#include "io/fields/table.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "io/field_reader.hpp"
#include "io/fields/describer.hpp"

namespace stillbase::io {

namespace {

bool read_fields(const TableBody& body, ReadContext& context, const Node& node,
                 const std::string& path) {
  const std::size_t before = context.findings.size();
  MapReader map(context, node, path);
  if (node.kind != Node::Kind::Map) return false;
  body(map);
  map.finish();
  return context.findings.size() == before;
}

/// Reads a word as the map in which it stands under `key` and nothing else is stated.
bool read_alone(const TableBody& body, const std::string& key, ReadContext& context,
                const Node& word, const std::string& path) {
  const std::size_t before = context.findings.size();
  Node alone;
  alone.kind = Node::Kind::Map;
  alone.line = word.line;
  alone.keys = {key};
  alone.key_lines = {word.line};
  alone.items = {word};
  MapReader map(context, alone, path);
  body(map);
  if (map.missing().empty()) return context.findings.size() == before;
  context.findings.resize(before);
  context.add(word.line, "missing-key",
              fmt::format("{0}: '{1}' alone is incomplete; state {{{2}: {1}, {3}: ...}}", path,
                          word.text, key, fmt::join(map.missing(), ": ..., ")));
  return false;
}

/// A JSON value as the tree that readers take.
Node node_of(const Json& json) {
  Node node;
  switch (json.kind()) {
    case Json::Kind::Null:
      break;
    case Json::Kind::Array:
    case Json::Kind::Object:
      node.kind = json.is_array() ? Node::Kind::Sequence : Node::Kind::Map;
      node.keys = json.keys();
      node.key_lines.resize(node.keys.size());
      for (const Json& item : json) node.items.push_back(node_of(item));
      break;
    case Json::Kind::Text:
      node.kind = Node::Kind::Quoted;
      node.text = json.get<std::string>();
      break;
    default:
      node.kind = Node::Kind::Plain;
      node.text = json.dump();
  }
  return node;
}

bool is_map(const Node& node) { return node.kind == Node::Kind::Map; }

bool holds_null(const Node& node) {
  return node.kind == Node::Kind::Null || (node.kind == Node::Kind::Plain && node.text == "null");
}

}  // namespace

About needed(std::string unit, std::string frame) {
  return {.need = Need::Required, .unit = std::move(unit), .frame = std::move(frame)};
}

void TableWriter::operator()(const std::string& key, const Value& value, std::string_view,
                             const About& about) {
  if (about.is_used && about.when.value_or(true) && value.is_written) json[key] = value.write();
}

Json written(const TableBody& body) {
  TableWriter writer;
  body(writer);
  return std::move(writer.json);
}

void read_map(std::string_view text, const std::string& source, const TableBody& body,
              const DocumentLimits& limits) {
  ReadContext context{source, {}, {}};
  read_fields(body, context, parse_document(text, context, limits), "");
  context.throw_if_any();
}

void read_json(std::string_view text, const std::string& source, const TableBody& body) {
  ReadContext context{source, {}, {}};
  try {
    read_fields(body, context, node_of(Json::parse(text)), "");
  } catch (const JsonError& error) {
    context.add(0, "syntax", error.what());
  }
  context.throw_if_any();
}

Map::Map(const TableBody& body, const MapOptions& options) {
  read = [body, key = options.alone](ReadContext& context, const Node& node,
                                     const std::string& path) {
    return key.empty() || !is_scalar(node) ? read_fields(body, context, node, path)
                                           : read_alone(body, key, context, node, path);
  };
  write = [body] { return written(body); };
  is_written = options.is_written;
  fits = is_map;
  if (options.is_section) {
    leave_out = [body](ReadContext& context, const std::string& path, int line) {
      Node empty;
      empty.kind = Node::Kind::Map;
      empty.line = line;
      read_fields(body, context, empty, path);
      return true;
    };
  }
  shape = [body, options](Definitions& definitions) -> Shape {
    const auto described = [&] {
      return TableDescriber(definitions).describe(body, options.alone);
    };
    if (options.name.empty()) return described();
    if (!definitions.contains(options.name)) {
      definitions[options.name] = nullptr;  // definitions may refer to themselves
      Json schema = described().schema;
      definitions[options.name] = std::move(schema);
    }
    return {{{"$ref", "#/definitions/" + options.name}}};
  };
}

ListValue::ListValue(const Items& items, const ListLimits& limits) {
  read = [items, limits](ReadContext& context, const Node& node, const std::string& path) {
    const std::size_t before = context.findings.size();
    if (node.kind != Node::Kind::Sequence || node.items.size() < limits.least) {
      context.add(
          node.line, "wrong-type",
          fmt::format("{}: must be a list{}{}", path, limits.of.empty() ? "" : " of " + limits.of,
                      limits.least > 0 ? ", with at least one element" : ""));
      return false;
    }
    items.clear();
    std::vector<Json> earlier;
    for (std::size_t i = 0; i < node.items.size(); ++i) {
      const std::string item_path = fmt::format("{}[{}]", path, i);
      items.append();
      const Value value = items.at(items.size() - 1);
      if (!value.read(context, node.items[i], item_path)) continue;
      if (!limits.is_unique && limits.unique_key.empty()) continue;
      Json key = value.write();
      if (!limits.unique_key.empty()) key = Json(key.at(limits.unique_key));
      if (std::find(earlier.begin(), earlier.end(), key) != earlier.end()) {
        const std::string text = key.is_text() ? key.get<std::string>() : key.dump();
        context.add(node.items[i].line, "duplicate-name",
                    limits.is_unique ? fmt::format("{}: '{}' is named twice", item_path, text)
                                     : fmt::format("{}: there is already one with the {} '{}'",
                                                   item_path, limits.unique_key, text));
      }
      earlier.push_back(std::move(key));
    }
    return context.findings.size() == before;
  };
  write = [items] {
    Json json = Json::array();
    json.reserve(items.size());
    for (std::size_t i = 0; i < items.size(); ++i) json.push_back(items.at(i).write());
    return json;
  };
  shape = [items, limits](Definitions& definitions) {
    const bool is_empty = items.size() == 0;
    if (is_empty) items.append();
    Shape out = items.at(0).shape(definitions);
    if (is_empty) items.clear();
    out.schema = {{"type", "array"}, {"items", out.schema}};
    out.extents = out.extents.empty() ? "k" : "k x " + out.extents;
    for (FieldRow& row : out.rows) row.name = "[]" + row.name;
    if (limits.least > 0) out.schema["minItems"] = limits.least;
    if (limits.is_unique) out.schema["uniqueItems"] = true;
    return out;
  };
  fits = [](const Node& node) { return node.kind == Node::Kind::Sequence; };
}

DictionaryValue::DictionaryValue(const std::function<std::vector<std::string>()>& keys,
                                 const std::function<Value(const std::string&)>& at,
                                 const std::function<Value()>& sample) {
  read = [at](ReadContext& context, const Node& node, const std::string& path) {
    const std::size_t before = context.findings.size();
    MapReader fields(context, node, path);
    for (const std::string& key : node.keys) {
      const Node* item = fields.child(key);
      if (item != nullptr) at(key).read(context, *item, fields.path_of(key));
    }
    return context.findings.size() == before;
  };
  write = [keys, at] {
    Json json = Json::object();
    for (const std::string& key : keys()) json[key] = at(key).write();
    return json;
  };
  shape = [sample](Definitions& definitions) -> Shape {
    const Shape item = sample().shape(definitions);
    return {{{"type", "object"}, {"additionalProperties", item.schema}}};
  };
  fits = is_map;
}

namespace {

/// ", or `auto`" for each alternative that is a word.
std::string or_words(const std::vector<Value>& values) {
  std::string out;
  for (const Value& value : values) {
    Definitions unused;
    const Shape shape = value.shape(unused);
    const Json* const word = shape.schema.find("const");
    if (word != nullptr && word->is_text()) out += ", or `" + word->get<std::string>() + "`";
  }
  return out;
}

}  // namespace

Either::Either(const std::vector<Value>& values) {
  read = [values](ReadContext& context, const Node& node, const std::string& path) {
    const auto fitting = std::find_if(values.begin(), values.end(),
                                      [&](const Value& value) { return value.fits(node); });
    const Value& value = fitting == values.end() ? values.back() : *fitting;
    const std::size_t before = context.findings.size();
    const bool is_read = value.read(context, node, path);
    // One alternative speaks for itself alone.
    const bool is_refused = context.findings.size() > before;
    if (is_refused && context.findings.back().rule == "wrong-type") {
      context.findings.back().message += or_words(values);
    }
    return is_read;
  };
  const auto first = std::find_if(values.begin(), values.end(),
                                  [](const Value& value) { return value.is_written; });
  is_written = first != values.end();
  if (is_written) write = first->write;
  shape = [values](Definitions& definitions) {
    Shape out;
    Json schemas = Json::array();
    for (const Value& value : values) {
      Shape part = value.shape(definitions);
      schemas.push_back(part.schema);
      if (out.unit.empty()) out.unit = part.unit;
      if (out.range.empty()) out.range = part.range;
      if (out.extents.empty()) out.extents = part.extents;
      out.rows.insert(out.rows.end(), part.rows.begin(), part.rows.end());
    }
    out.schema = {{"anyOf", schemas}};
    return out;
  };
  fits = [values](const Node& node) {
    return std::any_of(values.begin(), values.end(), [&](const Value& v) { return v.fits(node); });
  };
}

Instead::Instead(const std::string& word, bool is_now, const std::function<void()>& make) {
  read = [make](ReadContext&, const Node&, const std::string&) {
    make();
    return true;
  };
  write = [word]() -> Json { return word; };
  is_written = is_now;
  shape = [word](Definitions&) -> Shape { return {{{"const", word}}}; };
  fits = [word](const Node& node) { return is_scalar(node) && node.text == word; };
}

Shorthand::Shorthand(const Value& value, const std::function<void()>& then) : Value(value) {
  read = [value, then](ReadContext& context, const Node& node, const std::string& path) {
    if (!value.read(context, node, path)) return false;
    then();
    return true;
  };
  is_written = false;
}

OrNull::OrNull(const Value& value, bool is_null, const std::function<void()>& make_null)
    : Value(value) {
  read = [value, make_null](ReadContext& context, const Node& node, const std::string& path) {
    if (!holds_null(node)) return value.read(context, node, path);
    make_null();
    return true;
  };
  write = [value, is_null] { return is_null ? Json() : value.write(); };
  is_written = true;
  shape = [value](Definitions& definitions) {
    Shape out = value.shape(definitions);
    out.schema = {{"anyOf", Json::array({out.schema, {{"type", "null"}}})}};
    return out;
  };
}

}  // namespace stillbase::io
