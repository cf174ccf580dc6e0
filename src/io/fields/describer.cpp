#include "io/fields/describer.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include <fmt/format.h>

#include "io/fields/values.hpp"

namespace stillbase::io {

std::string default_text(const Value& value) {
  if (!value.is_written) return "none";
  const Json json = value.write();
  switch (json.kind()) {
    case Json::Kind::Object:
      return "";
    case Json::Kind::Text:
      return "`" + json.get<std::string>() + "`";
    case Json::Kind::Real:
      return fmt::format("{}", json.get<double>());
    case Json::Kind::Array: {
      std::vector<std::string> parts;
      for (const Json& item : json) {
        parts.push_back(item.is_number() ? fmt::format("{}", item.get<double>()) : item.dump());
      }
      return fmt::format("[{}]", fmt::join(parts, ", "));
    }
    default:
      return json.dump();
  }
}

namespace {

/// Whether a value is a number, or a list or dictionary of numbers.
bool holds_numbers(const Json& schema, const Definitions& definitions) {
  if (const Json* reference = schema.find("$ref")) {
    const Json* definition =
        definitions.find(reference->get<std::string>().substr(std::strlen("#/definitions/")));
    return definition != nullptr && definition->is_object() &&
           holds_numbers(*definition, definitions);
  }
  for (const char* inner : {"items", "additionalProperties"}) {
    const Json* item = schema.find(inner);
    if (item != nullptr && item->is_object()) return holds_numbers(*item, definitions);
  }
  for (const char* parts : {"anyOf", "allOf"}) {
    for (const Json& part : schema.value(parts, Json::array())) {
      if (holds_numbers(part, definitions)) return true;
    }
  }
  const Json type = schema.value("type", Json());
  return type == Json("number") || type == Json("integer");
}

/// The schema of a field with its unit, frame and shape for programs.
Json annotated(Json schema, const Shape& shape, const About& about,
               const Definitions& definitions) {
  const bool is_numeric = holds_numbers(schema, definitions);
  if (!is_numeric && about.frame.empty()) return schema;
  if (schema.contains("$ref")) schema = {{"allOf", Json::array({schema})}};
  if (is_numeric) {
    const std::string unit = about.unit.empty() ? shape.unit : about.unit;
    schema["x-unit"] = unit.empty() ? "1" : unit;
    if (!shape.extents.empty()) schema["x-shape"] = shape.extents;
  }
  if (!about.frame.empty()) schema["x-frame"] = about.frame;
  return schema;
}

}  // namespace

std::string description_of(const FieldRow& row) {
  std::string words = row.text;
  if (!row.unit.empty()) words += (words.empty() ? "[" : " [") + row.unit + "]";
  if (!row.without.empty() && row.without != "required") {
    const bool is_condition = row.without.rfind("required", 0) == 0;
    words +=
        (words.empty() ? "" : "; ") + std::string(is_condition ? "" : "default: ") + row.without;
  }
  return words;
}

Json described(const Json& schema, const std::string& description) {
  if (description.empty()) return schema;
  Json out{{"description", description}};
  if (schema.contains("$ref")) {
    out["allOf"] = Json::array({schema});
  } else {
    out.update(schema);
  }
  return out;
}

void add_bounds(Json& schema, const Range& range) {
  if (schema.contains("$ref")) schema = {{"allOf", Json::array({schema})}};
  if (std::isfinite(range.lower)) {
    schema[range.is_lower_open ? "exclusiveMinimum" : "minimum"] = range.lower;
  }
  if (std::isfinite(range.upper)) schema["maximum"] = range.upper;
}

Json quantity(const std::string& name, const std::string& units, Definitions& definitions) {
  std::string pattern;
  for (const char c : units) {
    if (c == ' ') {
      pattern += pattern.back() == '|' ? "" : " +";
    } else {
      pattern += c == ',' ? "|" : c == '^' ? "\\^" : std::string(1, c);
    }
  }
  const bool is_of_joint = name.rfind("joint_", 0) == 0;
  definitions[name] = {
      {"description",
       fmt::format("a number in {}, or a text with one of: {}",
                   is_of_joint ? "SI units" : units.substr(0, units.find(',')), units)},
      {"anyOf",
       Json::array(
           {{{"type", "number"}},
            {{"type", "string"},
             {"pattern", "^[-+]?((0|[1-9][0-9]*)(\\.[0-9]*)?|\\.[0-9]+)([eE][-+]?[0-9]+)? +(" +
                             pattern + ") *$"}}})}};
  return {{"$ref", "#/definitions/" + name}};
}

std::size_t TableDescriber::choose(std::size_t count) {
  if (depth_ == choices_.size()) {
    choices_.push_back(0);
    counts_.push_back(count);
  }
  return choices_[depth_++];
}

bool TableDescriber::next_run() {
  while (!choices_.empty() && choices_.back() + 1 == counts_.back()) {
    choices_.pop_back();
    counts_.pop_back();
  }
  if (choices_.empty()) return false;
  ++choices_.back();
  return true;
}

bool TableDescriber::states(const std::string&, bool) { return choose(2) == 0; }

int TableDescriber::one_of(const std::vector<std::string>& keys, int, const std::string&) {
  is_one_of_ = true;
  return static_cast<int>(choose(keys.size()));
}

void TableDescriber::not_both(const std::string& a, const std::string& b) {
  variants_.back().exclusive.emplace_back(a, b);
}

/// New rows of a run stand before the next row that an earlier run had as well.
void TableDescriber::add_row(const FieldRow& row) {
  const auto has_name = [&row](const FieldRow& other) { return other.name == row.name; };
  const auto known = std::find_if(rows_.begin(), rows_.end(), has_name);
  if (known != rows_.end()) {
    place_new_rows(static_cast<std::size_t>(known - rows_.begin()));
  } else if (std::none_of(new_rows_.begin(), new_rows_.end(), has_name)) {
    new_rows_.push_back(row);
  }
}

void TableDescriber::place_new_rows(std::size_t at) {
  rows_.insert(rows_.begin() + static_cast<long>(at), new_rows_.begin(), new_rows_.end());
  new_rows_.clear();
}

void TableDescriber::operator()(const std::string& key, const Value& value, std::string_view text,
                                const About& about) {
  Variant& variant = variants_.back();
  const bool is_required = about.need == Need::Required && !about.when;
  FieldRow row{.name = key,
               .text = std::string(text),
               .shape = {},
               .unit = {},
               .range = {},
               .without = about.without};
  if (row.without.empty() && !about.when) {
    row.without = is_required ? "required" : default_text(value);
  }
  if (about.decides && !is_required) {
    default_words_.emplace(key, value.write().get<std::string>());
  }
  const Shape shape = value.shape(definitions_);
  row.unit = about.unit.empty() ? shape.unit : about.unit;
  if (!about.frame.empty()) row.unit += (row.unit.empty() ? "" : ", ") + about.frame;
  row.range = shape.range;
  row.shape = shape.extents;
  add_row(row);
  for (FieldRow inner : shape.rows) {
    inner.name = key + inner.name;
    add_row(inner);
  }
  if (about.decides) {
    const std::size_t i = choose(value.words.size());
    value.choose(i);
    variant.words[key] = {value.words[i]};
  }
  if (!about.is_used) return;
  if (is_required) variant.required.insert(key);
  variant.properties[key] =
      annotated(described(shape.schema, description_of(row)), shape, about, definitions_);
}

void TableDescriber::merge_variants() {
  const auto without_words = [](Variant variant, const std::string& key) {
    variant.words.erase(key);
    return variant;
  };
  const auto merge_into = [&](Variant& a, const Variant& b) {
    for (const auto& [key, words] : b.words) {
      if (a.words.count(key) == 0 || !(without_words(a, key) == without_words(b, key))) continue;
      std::vector<std::string>& known = a.words[key];
      for (const std::string& word : words) {
        if (std::find(known.begin(), known.end(), word) == known.end()) known.push_back(word);
      }
      return true;
    }
    return a == b;
  };
  for (bool changed = true; changed;) {
    changed = false;
    for (std::size_t i = 0; i < variants_.size(); ++i) {
      for (std::size_t j = i + 1; j < variants_.size(); ++j) {
        if (!merge_into(variants_[i], variants_[j])) continue;
        variants_.erase(variants_.begin() + static_cast<long>(j--));
        changed = true;
      }
    }
  }
}

Json TableDescriber::schema_of(const Variant& variant) const {
  Json schema{{"type", "object"}};
  Json required = Json::array(), properties = variant.properties;
  for (const auto& [key, words] : variant.words) {
    properties[key]["enum"] = Json(words);
    const auto default_word = default_words_.find(key);
    const bool may_be_absent =
        default_word != default_words_.end() &&
        std::find(words.begin(), words.end(), default_word->second) != words.end();
    if (!may_be_absent && variant.required.count(key) == 0) required.push_back(key);
  }
  for (const std::string& key : variant.required) required.push_back(key);
  if (!required.empty()) schema["required"] = required;
  schema["additionalProperties"] = false;
  schema["properties"] = properties;
  for (const auto& [a, b] : variant.exclusive) {
    if (!properties.contains(a) || !properties.contains(b)) continue;
    schema["not"] = {{"required", Json::array({a, b})}};
  }
  return schema;
}

Shape TableDescriber::describe(const TableBody& body, const std::string& alone) {
  do {
    depth_ = 0;
    variants_.emplace_back();
    body(*this);
    place_new_rows(rows_.size());
  } while (next_run());
  merge_variants();
  if (is_one_of_) {
    for (std::size_t i = 1; i < variants_.size(); ++i) {
      variants_[0].properties.update(variants_[i].properties);
    }
    variants_.resize(1);
    variants_[0].required.clear();
  }
  Json alternatives = Json::array(), words = Json::array();
  for (const Variant& variant : variants_) {
    Json schema = schema_of(variant);
    if (is_one_of_) schema.update({{"minProperties", 1}, {"maxProperties", 1}});
    const auto leading = variant.words.find(alone);
    const Json* required = schema.find("required");
    const bool needs_more = required != nullptr &&
                            (required->size() > 1 || required->at(std::size_t{0}) != Json(alone));
    if (leading != variant.words.end() && !needs_more) {
      for (const std::string& word : leading->second) {
        if (std::find(words.begin(), words.end(), Json(word)) == words.end()) words.push_back(word);
      }
    }
    alternatives.push_back(std::move(schema));
  }
  Shape shape{{}, {}, {}, rows_};
  for (FieldRow& row : shape.rows) row.name = "." + row.name;
  Json all = Json::array();
  if (!words.empty()) all.push_back({{"enum", words}});
  for (const Json& alternative : alternatives) all.push_back(alternative);
  shape.schema = all.size() == 1 ? all.at(std::size_t{0}) : Json{{"anyOf", all}};
  return shape;
}

}  // namespace stillbase::io
