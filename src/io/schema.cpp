#include <stillbase/io/schema.hpp>

#include <map>
#include <stdexcept>

#include "io/json.hpp"
#include "io/schema_texts.hpp"

namespace stillbase {

namespace {

using io::Json;

constexpr std::string_view kEnding = ".schema.json";

std::map<std::string, Json> read_documents() {
  std::map<std::string, Json> documents;
  for (const io::SchemaText& entry : io::schema_texts()) {
    documents[std::string(entry.file)] = Json::parse(entry.text);
  }
  return documents;
}

/// The value at "/a/b" in a document.
const Json& at_pointer(const Json& document, std::string_view pointer) {
  if (pointer.empty()) return document;
  const std::size_t end = std::min(pointer.find('/', 1), pointer.size());
  return at_pointer(document.at(pointer.substr(1, end - 1)), pointer.substr(end));
}

/// The files refer to each other. Here what one of them uses becomes a definition of its own.
class Bundle {
 public:
  Json of(const std::string& file) {
    Json out = rewritten(without_definitions(documents_.at(file)), file);
    if (!definitions_.empty()) out["definitions"] = definitions_;
    return out;
  }

 private:
  static Json without_definitions(Json document) {
    document.erase("definitions");
    return document;
  }

  /// A copy whose references lead into the definitions.
  Json rewritten(const Json& json, const std::string& file) {
    Json out = json;
    if (out.is_object() && out.contains("$ref")) {
      out["$ref"] = "#/definitions/" + defined(out["$ref"].get<std::string>(), file);
    } else {
      for (Json& part : out) {
        if (part.is_structured()) part = rewritten(part, file);
      }
    }
    return out;
  }

  /// Makes a definition of "file#/pointer" ("file" may be empty) and gives its name.
  std::string defined(const std::string& reference, const std::string& here) {
    const std::size_t hash = reference.find('#');
    const std::string file = hash == 0 ? here : reference.substr(0, hash);
    const std::string pointer = hash == std::string::npos ? "" : reference.substr(hash + 1);
    const std::string name =
        pointer.empty() ? file.substr(0, file.find('.')) : pointer.substr(pointer.rfind('/') + 1);
    const auto [place, is_new] = places_.emplace(name, file + "#" + pointer);
    if (place->second != file + "#" + pointer) {
      throw std::logic_error("two definitions of the name " + name);
    }
    if (!is_new) return name;
    Json piece = at_pointer(documents_.at(file), pointer);
    if (pointer.empty()) {
      piece = without_definitions(piece);
      piece.erase("$schema");
    }
    Json definition = rewritten(piece, file);
    definitions_[name] = std::move(definition);
    return name;
  }

  const std::map<std::string, Json> documents_ = read_documents();
  std::map<std::string, std::string> places_;
  Json definitions_ = Json::object();
};

}  // namespace

std::vector<FileFormat> file_formats() {
  std::vector<FileFormat> formats;
  for (const auto& [file, document] : read_documents()) {
    const std::size_t ending = file.find(kEnding);
    if (ending == std::string::npos) continue;  // what several share
    formats.push_back({file.substr(0, ending), document.at("description").get<std::string>()});
  }
  return formats;
}

std::string schema_of(const std::string& name) {
  for (const FileFormat& format : file_formats()) {
    if (format.name == name) return io::pretty(Bundle().of(name + std::string(kEnding)));
  }
  throw std::invalid_argument("no schema named " + name);
}

}  // namespace stillbase
