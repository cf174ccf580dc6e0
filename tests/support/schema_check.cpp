#include "support/schema_check.hpp"

#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validation_results.hpp>
#include <valijson/validator.hpp>

namespace stillbase::test {

struct SchemaCheck::Validator {
  valijson::Schema schema;
  valijson::Validator validator;

  bool validate(const json& document, valijson::ValidationResults* results) {
    return validator.validate(schema, valijson::adapters::NlohmannJsonAdapter(document), results);
  }
};

SchemaCheck::SchemaCheck(const json& schema) : validator_(std::make_unique<Validator>()) {
  valijson::SchemaParser(valijson::SchemaParser::kDraft7)
      .populateSchema(valijson::adapters::NlohmannJsonAdapter(schema), validator_->schema);
}

SchemaCheck::~SchemaCheck() = default;

bool SchemaCheck::accepts(const json& document) { return validator_->validate(document, nullptr); }

std::string SchemaCheck::complaints(const json& document) {
  valijson::ValidationResults results;
  std::string text;
  if (validator_->validate(document, &results)) return text;
  for (valijson::ValidationResults::Error error; results.popError(error);) {
    for (const std::string& part : error.context) text += part;
    text += ": " + error.description + "\n";
  }
  return text + "refused\n";
}

const json& referenced(const json& root, const json& node) {
  return root.at(json::json_pointer(node.at("$ref").get<std::string>().substr(1)));
}

std::string joined(const std::string& path, const std::string& key) {
  return path.empty() ? key : path + "." + key;
}

namespace {

void collect_places(const json& root, const json& node, const std::string& path,
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

void collect_keys(const json& root, const json& node, const json& document,
                  const std::vector<std::string>& place, std::size_t depth, AllowedKeys& out) {
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

void collect_values(const json& node, const Place& here, std::vector<Place>& out) {
  out.push_back(here);
  for (const auto& [key, value] : node.items()) {
    if (!node.is_structured()) break;
    Place below = here;
    below.way.push_back(key);
    below.name = node.is_array() ? here.name + "[]" : joined(here.name, key);
    collect_values(value, below, out);
  }
}

}  // namespace

SchemaPlaces places_of(const json& schema) {
  SchemaPlaces out;
  collect_places(schema, schema, "", out);
  return out;
}

AllowedKeys keys_at(const json& schema, const json& document,
                    const std::vector<std::string>& place) {
  AllowedKeys out;
  collect_keys(schema, schema, document, place, 0, out);
  return out;
}

std::vector<Place> values_of(const json& document) {
  std::vector<Place> out;
  collect_values(document, {}, out);
  return out;
}

json& at_place(json& document, const std::vector<std::string>& way) {
  json* node = &document;
  for (const std::string& step : way) {
    node = node->is_array() ? &node->at(std::stoul(step)) : &node->at(step);
  }
  return *node;
}

}  // namespace stillbase::test
