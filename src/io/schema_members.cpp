#include <algorithm>
#include <cstring>

#include <fmt/format.h>

#include <stillbase/io/schema.hpp>

#include "io/json.hpp"

namespace stillbase {

namespace {

using io::Json;

class MemberList {
 public:
  explicit MemberList(const Json& document) : definitions_(document.value("definitions", Json())) {}

  /// @param outer frame of the field that holds this one, for those that state none
  void add(const Json& schema, const std::string& path, const Json& field, std::string frame) {
    frame = field.value("x-frame", frame);
    if (schema.contains("$ref")) {
      const std::string name =
          schema.at("$ref").get<std::string>().substr(std::strlen("#/definitions/"));
      return add(definitions_.at(name), path, field, frame);
    }
    bool has_inner = false;
    for (const char* parts : {"anyOf", "allOf"}) {
      for (const Json& part : schema.value(parts, Json::array())) {
        add(part, path, field, frame);
        has_inner = true;
      }
    }
    if (has_inner && !schema.contains("properties")) return;
    if (const Json* items = schema.find("items"); items != nullptr && holds_objects(*items)) {
      return add(*items, path + "[]", field, frame);
    }
    const Json* properties = schema.find("properties");
    if (properties == nullptr) return add_member(path, field, frame);
    for (const auto& [key, property] : properties->items()) {
      add(property, path.empty() ? key : fmt::format("{}.{}", path, key), property, frame);
    }
  }

  std::vector<Member> take() { return std::move(members_); }

 private:
  bool holds_objects(const Json& schema) const {
    if (schema.contains("properties")) return true;
    if (const Json* reference = schema.find("$ref")) {
      return holds_objects(
          definitions_.at(reference->get<std::string>().substr(std::strlen("#/definitions/"))));
    }
    const auto parts_hold = [&](const char* key) {
      const Json parts = schema.value(key, Json::array());
      return std::any_of(parts.begin(), parts.end(),
                         [&](const Json& part) { return holds_objects(part); });
    };
    return parts_hold("anyOf") || parts_hold("allOf");
  }

  void add_member(const std::string& path, const Json& field, const std::string& frame) {
    if (path.empty() || std::any_of(members_.begin(), members_.end(),
                                    [&](const Member& m) { return m.path == path; })) {
      return;
    }
    const bool is_numeric = field.contains("x-unit");
    members_.push_back({path, field.value("x-unit", ""), is_numeric ? frame : "",
                        field.value("x-shape", ""), field.value("description", "")});
  }

  Json definitions_;
  std::vector<Member> members_;
};

}  // namespace

std::vector<Member> members_of(const std::string& format) {
  const Json document = Json::parse(schema_of(format));
  MemberList list(document);
  list.add(document, "", document, "");
  return list.take();
}

}  // namespace stillbase
