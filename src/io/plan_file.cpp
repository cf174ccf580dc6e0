#include <stillbase/io/plan_file.hpp>

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>
#include <Eigen/Core>

#include <stillbase/core/error.hpp>
#include <stillbase/core/file.hpp>
#include <stillbase/core/sha256.hpp>
#include <stillbase/io/target_file.hpp>

#include "io/fields/plan.hpp"

namespace stillbase {

namespace io {

namespace {

/// SHA-256 of a plan document without `tool`, `timing`, `verification` and `content_sha256`.
std::string content_sha256(const Json& document) {
  return sha256_hex(canonical(document, {"tool", "timing", "verification", "content_sha256"}));
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
  const io::Node root = io::parse_document(text, context, io::kPlanLimits);
  PlanFile file;
  io::refuse_other_format(root, source, "stillbase.plan");
  io::Map([&](io::Table& t) { io::plan_fields(t, file, ""); }).read(context, root, "");
  context.throw_if_any();
  file.computed_sha256 = io::fingerprint(text, context);
  return file;
}

std::string plan_to_json(const Plan& plan, const ToolVersions& tool,
                         const std::string& verification_json,
                         const std::vector<InputFile>& inputs) {
  PlanFile file{plan, tool, inputs, {}, {}, {}, {}};
  io::Json json = io::written([&](io::Table& t) { io::plan_fields(t, file, verification_json); });
  json["content_sha256"] = io::content_sha256(json);
  return io::pretty(json);
}

std::vector<InputFile> input_files(const std::string& problem_path) {
  const std::string text = read_text_file(problem_path, io::DocumentLimits{}.bytes);
  io::ReadContext context{problem_path, {}, {}};
  const io::Node root = io::parse_document(text, context);
  std::vector<InputFile> files{{"problem", problem_path, sha256_hex(text)}};
  const auto add = [&](const char* role, const io::Node* section) {
    const io::Node* name = section == nullptr ? nullptr : section->find("file");
    if (name == nullptr) return;
    const auto path = std::filesystem::path(problem_path).parent_path() / name->text;
    const std::string content = read_text_file(path.string(), io::DocumentLimits{}.bytes);
    files.push_back({role, name->text, sha256_hex(content)});
  };
  const io::Node* const robot = root.find("robot");
  add("robot", robot);
  const io::Node* const arms = robot == nullptr ? nullptr : robot->find("arms");
  if (arms != nullptr) {
    for (const io::Node& arm : arms->items) add("robot", &arm);
  }
  add("target", root.find("target"));
  return files;
}

std::string stated_format(std::string_view text, const std::string& source) {
  io::ReadContext context{source, {}, {}};
  const io::Node root = io::parse_document(text, context, io::kPlanLimits);
  const io::Node* format = root.find("format");
  return format == nullptr ? "" : format->text;
}

ToolVersions tool_versions() {
  ToolVersions versions{{"stillbase", STILLBASE_VERSION},
                        {"eigen", fmt::format("{}.{}.{}", EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION,
                                              EIGEN_MINOR_VERSION)}};
#if defined(__clang__)
  versions["compiler"] = fmt::format("clang {}.{}", __clang_major__, __clang_minor__);
#elif defined(__GNUC__)
  versions["compiler"] = fmt::format("g++ {}.{}", __GNUC__, __GNUC_MINOR__);
#endif
  return versions;
}

PlanFile load_plan(const std::string& path) {
  PlanFile file = read_plan(read_text_file(path), path);
  if (!file.is_as_written()) {
    throw InputError({{path, 0, "fingerprint",
                       "content_sha256: the plan was changed after it was written; `stillbase "
                       "verify` says what does not hold"}});
  }
  return file;
}

void write_plan(const Plan& plan, const std::string& path, bool replace) {
  write_file_atomically(path, plan_to_json(plan, tool_versions()), replace);
}

}  // namespace stillbase
