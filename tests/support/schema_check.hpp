// JSON documents against JSON Schemas, by a validator that others wrote (valijson), and what a
// schema says at a place.
#pragma once

#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>
#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validation_results.hpp>
#include <valijson/validator.hpp>

namespace stillbase::test {

using nlohmann::json;

class SchemaCheck {
 public:
  explicit SchemaCheck(const json& schema) : schema_(std::make_unique<valijson::Schema>()) {
    valijson::SchemaParser(valijson::SchemaParser::kDraft7)
        .populateSchema(valijson::adapters::NlohmannJsonAdapter(schema), *schema_);
  }

  bool accepts(const json& document) { return validate(document, nullptr); }

  /// What is wrong with a document, a line each; empty when it is accepted.
  std::string complaints(const json& document) {
    valijson::ValidationResults results;
    std::string text;
    if (validate(document, &results)) return text;
    for (valijson::ValidationResults::Error error; results.popError(error);) {
      for (const std::string& part : error.context) text += part;
      text += ": " + error.description + "\n";
    }
    return text + "refused\n";
  }

 private:
  bool validate(const json& document, valijson::ValidationResults* results) {
    return validator_.validate(*schema_, valijson::adapters::NlohmannJsonAdapter(document),
                               results);
  }

  std::unique_ptr<valijson::Schema> schema_;
  valijson::Validator validator_;
};

/// What a schema says about every place, all alternatives taken together. Places are named as
/// "a.b[].c", "a.*" for keys that the schema leaves open.
struct SchemaPlaces {
  std::set<std::string> all;
  std::map<std::string, std::set<std::string>> words;         ///< of enum and const
  std::map<std::string, std::set<std::string>> descriptions;  ///< where there are any
};

inline const json& referenced(const json& root, const json& node) {
  return root.at(json::json_pointer(node.at("$ref").get<std::string>().substr(1)));
}

inline std::string joined(const std::string& path, const std::string& key) {
  return path.empty() ? key : path + "." + key;
}

inline void collect_places(const json& root, const json& node, const std::string& path,
                           SchemaPlaces& out) {
  if (node.contains("$ref")) return collect_places(root, referenced(root, node), path, out);
  if (node.contains("description")) {
    // The outermost description of a place is its own; those below belong to shared values.
    out.descriptions[path].insert(node.at("description").get<std::string>());
  }
  if (node.contains("const") && node.at("const").is_string()) {
    out.words[path].insert(node.at("const").get<std::string>());
  }
  for (const json& word : node.value("enum", json::array())) out.words[path].insert(word);
  for (const char* several : {"allOf", "anyOf", "oneOf"}) {
    for (const json& part : node.value(several, json::array())) {
      collect_places(root, part, path, out);
    }
  }
  const json properties = node.value("properties", json::object());
  for (const auto& [key, value] : properties.items()) {
    out.all.insert(joined(path, key));
    collect_places(root, value, joined(path, key), out);
  }
  if (node.contains("items")) collect_places(root, node.at("items"), path + "[]", out);
  const json others = node.value("additionalProperties", json());
  if (others.is_object()) {
    out.all.insert(joined(path, "*"));
    collect_places(root, others, joined(path, "*"), out);
  }
}

inline SchemaPlaces places_of(const json& schema) {
  SchemaPlaces out;
  collect_places(schema, schema, "", out);
  return out;
}

/// Keys that a schema allows in one object of a document that it accepts.
struct AllowedKeys {
  std::set<std::string> names;
  bool any = false;  ///< other names, too
};

inline void collect_keys(const json& root, const json& node, const json& document,
                         const std::vector<std::string>& place, std::size_t depth,
                         AllowedKeys& out) {
  if (node.contains("$ref")) {
    return collect_keys(root, referenced(root, node), document, place, depth, out);
  }
  for (const json& part : node.value("allOf", json::array())) {
    collect_keys(root, part, document, place, depth, out);
  }
  for (const char* several : {"anyOf", "oneOf"}) {
    for (const json& part : node.value(several, json::array())) {
      const json alone = {{"definitions", root.value("definitions", json::object())},
                          {"allOf", json::array({part})}};
      if (SchemaCheck(alone).accepts(document)) {
        collect_keys(root, part, document, place, depth, out);
      }
    }
  }
  const json properties = node.value("properties", json::object());
  const json others = node.value("additionalProperties", json());
  if (depth == place.size()) {
    for (const auto& [key, value] : properties.items()) out.names.insert(key);
    out.any = out.any || others.is_object();
    return;
  }
  const std::string& step = place[depth];
  if (document.is_array()) {
    if (node.contains("items")) {
      collect_keys(root, node.at("items"), document.at(std::stoul(step)), place, depth + 1, out);
    }
  } else if (properties.contains(step)) {
    collect_keys(root, properties.at(step), document.at(step), place, depth + 1, out);
  } else if (others.is_object()) {
    collect_keys(root, others, document.at(step), place, depth + 1, out);
  }
}

inline AllowedKeys keys_at(const json& schema, const json& document,
                           const std::vector<std::string>& place) {
  AllowedKeys out;
  collect_keys(schema, schema, document, place, 0, out);
  return out;
}

/// A value of a document: its way there, and its name with "[]" for every element of a list.
struct Place {
  std::vector<std::string> way;
  std::string name;
};

inline void collect_values(const json& node, const Place& here, std::vector<Place>& out) {
  out.push_back(here);
  for (const auto& [key, value] : node.items()) {
    if (!node.is_structured()) break;
    Place below = here;
    below.way.push_back(key);
    below.name = node.is_array() ? here.name + "[]" : joined(here.name, key);
    collect_values(value, below, out);
  }
}

inline std::vector<Place> values_of(const json& document) {
  std::vector<Place> out;
  collect_values(document, {}, out);
  return out;
}

inline json& at_place(json& document, const std::vector<std::string>& way) {
  json* node = &document;
  for (const std::string& step : way) {
    node = node->is_array() ? &node->at(std::stoul(step)) : &node->at(step);
  }
  return *node;
}

}  // namespace stillbase::test
