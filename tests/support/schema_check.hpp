// JSON documents against JSON Schemas, by a validator that others wrote (valijson), and what a
// schema says at a place.
#pragma once

#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace stillbase::test {

using nlohmann::json;

class SchemaCheck {
 public:
  explicit SchemaCheck(const json& schema);
  ~SchemaCheck();

  bool accepts(const json& document);

  /// What is wrong with a document, a line each; empty when it is accepted.
  std::string complaints(const json& document);

 private:
  struct Validator;
  std::unique_ptr<Validator> validator_;
};

/// What a schema says about every place, all alternatives taken together. Places are named as
/// "a.b[].c", "a.*" for keys that the schema leaves open.
struct SchemaPlaces {
  std::set<std::string> all;
  std::map<std::string, std::set<std::string>> words;         ///< of enum and const
  std::map<std::string, std::set<std::string>> descriptions;  ///< where there are any
};

SchemaPlaces places_of(const json& schema);

/// The part of a schema that the reference in a node names.
const json& referenced(const json& root, const json& node);

/// Name of the place of a key in the object at `path`.
std::string joined(const std::string& path, const std::string& key);

/// Keys that a schema allows in one object of a document that it accepts.
struct AllowedKeys {
  std::set<std::string> names;
  bool any = false;  ///< other names, too
};

AllowedKeys keys_at(const json& schema, const json& document,
                    const std::vector<std::string>& place);

/// A value of a document: the keys that lead to it, and its name with "[]" for every element of a
/// list.
struct Place {
  std::vector<std::string> way;
  std::string name;
};

std::vector<Place> values_of(const json& document);

json& at_place(json& document, const std::vector<std::string>& way);

}  // namespace stillbase::test
