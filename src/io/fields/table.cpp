#include "io/fields/table.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "io/field_reader.hpp"
#include "io/fields/describer.hpp"
#include "io/read_map.hpp"

namespace stillbase::io {

void TableWriter::add(const std::string& key, Value& value, const std::string&,
                      const About& about) {
  if (about.is_used && about.when.value_or(true) && value.is_written()) json[key] = value.write();
}

bool Map::read(ReadContext& context, const Node& node, const std::string& path) {
  const std::size_t before = context.findings.size();
  const bool is_word = node.kind == Node::Kind::Plain || node.kind == Node::Kind::Quoted;
  if (also_.alone.empty() || !is_word) {
    MapReader map(context, node, path);
    if (node.kind != Node::Kind::Map) return false;
    body_(map);
    map.finish();
    return context.findings.size() == before;
  }
  Node alone;
  alone.kind = Node::Kind::Map;
  alone.line = node.line;
  alone.keys = {also_.alone};
  alone.key_lines = {node.line};
  alone.items = {node};
  MapReader map(context, alone, path);
  body_(map);
  if (map.missing().empty()) return context.findings.size() == before;
  context.findings.resize(before);
  context.add(node.line, "missing-key",
              fmt::format("{0}: '{1}' alone leaves something open; state {{{2}: {1}, {3}: ...}}",
                          path, node.text, also_.alone, fmt::join(map.missing(), ": ..., ")));
  return false;
}

bool Map::leave_out(ReadContext& context, const std::string& path) {
  Node empty;
  empty.kind = Node::Kind::Map;
  if (also_.is_section) read(context, empty, path);
  return also_.is_section;
}

Json Map::write() const {
  TableWriter writer;
  body_(writer);
  return writer.json;
}

Shape Map::shape(Definitions& definitions) {
  if (also_.name.empty()) return TableDescriber(definitions).describe(body_, also_.alone);
  if (!definitions.contains(also_.name)) {
    definitions[also_.name] = TableDescriber(definitions).describe(body_, also_.alone).schema;
  }
  return {{{"$ref", "#/definitions/" + also_.name}}};
}

void read_map(std::string_view text, const std::string& source, TableBody body,
              const DocumentLimits& limits) {
  ReadContext context{source, {}, {}};
  Map(std::move(body)).read(context, parse_document(text, context, limits), "");
  context.throw_if_any();
}

bool ListValue::read(ReadContext& context, const Node& node, const std::string& path) {
  const std::size_t before = context.findings.size();
  if (node.kind != Node::Kind::Sequence || node.items.size() < limits_.least) {
    context.add(
        node.line, "wrong-type",
        fmt::format("{}: must be a list{}{}", path, limits_.of.empty() ? "" : " of " + limits_.of,
                    limits_.least > 0 ? ", with at least one element" : ""));
    return false;
  }
  clear();
  std::vector<Json> earlier;
  for (std::size_t i = 0; i < node.items.size(); ++i) {
    const std::string item_path = fmt::format("{}[{}]", path, i);
    append();
    use(size() - 1, [&](Value& value) {
      if (!value.read(context, node.items[i], item_path)) return;
      if (!limits_.is_unique && limits_.unique_key.empty()) return;
      Json key = value.write();
      if (!limits_.unique_key.empty()) key = Json(key.at(limits_.unique_key));
      if (std::find(earlier.begin(), earlier.end(), key) != earlier.end()) {
        const std::string text = key.is_text() ? key.get<std::string>() : key.dump();
        context.add(node.items[i].line, "duplicate-name",
                    limits_.is_unique ? fmt::format("{}: '{}' is named twice", item_path, text)
                                      : fmt::format("{}: there is already one with the {} '{}'",
                                                    item_path, limits_.unique_key, text));
      }
      earlier.push_back(std::move(key));
    });
  }
  return context.findings.size() == before;
}

Json ListValue::write() const {
  Json json = Json::array();
  for (std::size_t i = 0; i < size(); ++i) {
    use(i, [&json](const Value& value) { json.push_back(value.write()); });
  }
  return json;
}

Shape ListValue::shape(Definitions& definitions) {
  const bool is_empty = size() == 0;
  if (is_empty) append();
  Shape out{{{"type", "array"}}};
  use(0, [&](Value& value) {
    Shape inner = value.shape(definitions);
    out.unit = inner.unit;
    out.range = inner.range;
    out.schema["items"] = inner.schema;
    out.rows = std::move(inner.rows);
  });
  for (FieldRow& row : out.rows) row.name = "[]" + row.name;
  if (limits_.least > 0) out.schema["minItems"] = limits_.least;
  if (limits_.is_unique) out.schema["uniqueItems"] = true;
  if (is_empty) clear();
  return out;
}

bool Alternatives::read(ReadContext& context, const Node& node, const std::string& path) {
  const std::vector<Value*> all = values();
  for (Value* value : all) {
    if (value->fits(node)) return value->read(context, node, path);
  }
  return all.back()->read(context, node, path);
}

Json Alternatives::write() const {
  for (const Value* value : values()) {
    if (value->is_written()) return value->write();
  }
  return {};
}

bool Alternatives::is_written() const {
  const std::vector<Value*> all = values();
  return std::any_of(all.begin(), all.end(), [](const Value* v) { return v->is_written(); });
}

Shape Alternatives::shape(Definitions& definitions) {
  Shape out;
  Json schemas = Json::array();
  for (Value* value : values()) {
    Shape part = value->shape(definitions);
    schemas.push_back(part.schema);
    if (out.unit.empty()) out.unit = part.unit;
    if (out.range.empty()) out.range = part.range;
    out.rows.insert(out.rows.end(), part.rows.begin(), part.rows.end());
  }
  out.schema = {{"anyOf", schemas}};
  return out;
}

bool Alternatives::fits(const Node& node) const {
  const std::vector<Value*> all = values();
  return std::any_of(all.begin(), all.end(), [&node](const Value* v) { return v->fits(node); });
}

}  // namespace stillbase::io
