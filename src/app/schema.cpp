// stillbase schema: the JSON Schema of a file format.
#include <algorithm>
#include <memory>

#include <fmt/format.h>

#include <stillbase/io/schema.hpp>

#include "app/commands.hpp"
#include "app/exit_code.hpp"
#include "app/output.hpp"

namespace stillbase::app {

namespace {

struct Options {
  std::string name;
  bool fields = false;
  OutputFile output;
};

std::string list_of_formats(const std::vector<FileFormat>& formats) {
  std::string text;
  for (const FileFormat& format : formats) {
    // The first sentence is enough here.
    const std::string about = format.description.substr(0, format.description.find(". "));
    text += fmt::format("{:<16} {}{}\n", format.name, about, about.back() == '.' ? "" : ".");
  }
  return text;
}

int run(const Options& options) {
  if (options.fields) {
    if (!options.name.empty()) throw CommandLineError("schema: --fields is about all formats");
    options.output.check();
    options.output.write(field_reference());
    return kDone;
  }
  const std::vector<FileFormat> formats = file_formats();
  if (options.name.empty()) {
    if (options.output.is_given()) throw CommandLineError("schema: -o needs the name of a format");
    write_stdout(list_of_formats(formats));
    return kDone;
  }
  std::vector<std::string> names;
  for (const FileFormat& format : formats) names.push_back(format.name);
  if (std::find(names.begin(), names.end(), options.name) == names.end()) {
    throw CommandLineError(fmt::format("schema: there is no format '{}'; there are {}",
                                       options.name, fmt::join(names, ", ")));
  }
  options.output.check();
  options.output.write(schema_of(options.name));
  return kDone;
}

}  // namespace

void add_schema(CLI::App& app, Action& action) {
  auto options = std::make_shared<Options>();
  CLI::App* command =
      app.add_subcommand("schema", "the JSON Schema of a file format, for editors and programs");
  command
      ->add_option("format", options->name,
                   "problem, target, state, campaign, suite, plan, verification, ...; without it a "
                   "list of all")
      ->type_name("FORMAT");
  command->add_flag("--fields", options->fields,
                    "the fields of all files that people write, and of plans, as Markdown");
  add_output(*command, options->output, "-o,--output", "schema (JSON); without it stdout");
  command->callback([options, &action] { action = [options] { return run(*options); }; });
}

}  // namespace stillbase::app
