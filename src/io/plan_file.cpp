#include <stillbase/io/plan_file.hpp>

#include <algorithm>

#include <fmt/format.h>

#include <stillbase/core/sha256.hpp>

#include "io/fields/plan.hpp"

namespace stillbase {

namespace io {

namespace {

/// SHA-256 of a plan document without `tool`, `timing`, `verification` and `content_sha256`.
std::string content_sha256(Json document) {
  for (const char* key : {"tool", "timing", "verification", "content_sha256"}) document.erase(key);
  return sha256_hex(canonical(document));
}

/// Of a file that says that it is something else, nothing more is said than that.
void refuse_other_format(MapReader map) {
  const Node* format = map.find("format");
  if (format == nullptr || format->text.rfind("stillbase.", 0) != 0 ||
      format->text == "stillbase.plan") {
    return;
  }
  ReadContext only{map.context().source, {}, {}};
  only.add(format->line, "format",
           format->text == "stillbase.problem"
               ? "this is a problem file; make a plan of it first (stillbase plan)"
               : fmt::format("is '{}'; must be 'stillbase.plan'", format->text));
  only.throw_if_any();
}

/// The text as JSON, for its fingerprint. YAML that is not JSON is refused.
std::string fingerprint(std::string_view text, ReadContext& context) {
  try {
    return content_sha256(Json::parse(text));
  } catch (const JsonError& error) {
    const std::size_t end = std::min(error.byte, text.size());
    const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<long>(end), '\n');
    context.add(static_cast<int>(line), "syntax", "the file is not JSON");
    throw InputError(context.findings);
  }
}

}  // namespace

}  // namespace io

PlanFile read_plan(std::string_view text, const std::string& source) {
  io::ReadContext context{source, {}, {}};
  const io::Node root =
      io::parse_document(text, context, {.bytes = 64u << 20, .depth = 32, .nodes = 1'000'000});
  PlanFile file;
  std::string verification;
  if (root.kind == io::Node::Kind::Map) io::refuse_other_format(io::MapReader(context, root, ""));
  io::Map([&](io::Table& t) { io::plan_fields(t, file, verification); }).read(context, root, "");
  context.throw_if_any();
  file.computed_sha256 = io::fingerprint(text, context);
  return file;
}

std::string plan_to_json(const Plan& plan, const ToolVersions& tool,
                         const std::string& verification_json,
                         const std::vector<InputFile>& inputs) {
  PlanFile file;
  file.plan = plan;
  file.tool = tool;
  file.inputs = inputs;
  std::string verification = verification_json;
  io::TableWriter writer;
  io::plan_fields(writer, file, verification);
  writer.json["content_sha256"] = io::content_sha256(writer.json);
  return io::pretty(writer.json);
}

}  // namespace stillbase
