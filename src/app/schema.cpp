// stillbase schema: the JSON Schema of a file format.
#include <algorithm>
#include <memory>

#include <fmt/format.h>

#include <stillbase/io/schema.hpp>

#include "app/command_line.hpp"
#include "io/scalars.hpp"

namespace stillbase::app {

namespace {

struct SchemaRequest {
  std::string name;
  bool fields = false;
  OutputFile output;
};

std::vector<std::string> format_names() {
  std::vector<std::string> names;
  for (const FileFormat& format : file_formats()) names.push_back(format.name);
  return names;
}

std::string list_of_formats(const std::vector<FileFormat>& formats) {
  std::string text;
  for (const FileFormat& format : formats) {
    // The first sentence is enough here.
    const std::string about = format.description.substr(0, format.description.find(". "));
    text += fmt::format("{:<16} {}{}\n", format.name, about, about.back() == '.' ? "" : ".");
  }
  return text;
}

int write_schema(const SchemaRequest& request) {
  const std::vector<std::string> names = format_names();
  const bool is_known = std::find(names.begin(), names.end(), request.name) != names.end();
  if (!request.name.empty() && !is_known) {
    throw CommandLineError(fmt::format("schema: there is no format '{}'; there are {}{}",
                                       request.name, fmt::join(names, ", "),
                                       io::did_you_mean(request.name, names)));
  }
  if (request.fields) {
    request.output.check({".md"});
    request.output.write(field_reference(request.name));
    return kDone;
  }
  if (request.name.empty()) {
    if (request.output.is_given()) throw CommandLineError("schema: -o needs the name of a format");
    write_stdout(list_of_formats(file_formats()));
    return kDone;
  }
  request.output.check({".json"});
  request.output.write(schema_of(request.name));
  return kDone;
}

}  // namespace

Command schema_command() {
  auto request = std::make_shared<SchemaRequest>();
  return {"schema", "the JSON Schema of a file format, for editors and programs",
          std::vector<Option>{
              {.name = "format",
               .value = "FORMAT",
               .about = "problem, target, state, campaign, suite, plan, verification, ...; "
                        "without it a list of all",
               .target = &request->name,
               .words = format_names()},
              {"--fields", "",
               "instead: the fields of FORMAT, or of all files that people write, as Markdown",
               &request->fields}} +
              output_options(request->output, "-o,--output", "schema (JSON); without it stdout"),
          [request] { return write_schema(*request); }};
}

}  // namespace stillbase::app
