#include "io/problem_reader.hpp"

#include <algorithm>
#include <filesystem>

#include <stillbase/core/file.hpp>
#include <stillbase/io/problem_file.hpp>

namespace stillbase {

namespace io {

CaptureProblem read_problem_map(const Node& node, ReadContext& context, const std::string& path,
                                const ProblemSources& sources) {
  CaptureProblem problem;
  problem.source = context.source;
  problem.name = std::filesystem::path(context.source).stem().string();
  Map map([&](Table& t) { problem_fields(t, problem, sources); });
  // Contradictions between sections mean something only when the sections are good.
  if (!map.read(context, node, path) || !context.findings.empty()) return problem;
  MapReader sections(context, node, path);
  check_sections(sections, problem);
  return problem;
}

Json problem_json(const CaptureProblem& problem) {
  CaptureProblem copy = problem;  // tables name fields of data that may change
  return written([&](Table& t) { problem_fields(t, copy, {}); });
}

}  // namespace io

namespace {

CaptureProblem read(std::string_view text, const std::string& source,
                    const io::ProblemSources& sources, std::vector<Finding>* remarks = nullptr) {
  io::ReadContext context{source, {}, {}};
  const io::Node root = io::parse_document(text, context);
  io::refuse_other_format(root, source, "stillbase.problem");
  CaptureProblem problem = io::read_problem_map(root, context, "", sources);
  if (remarks != nullptr) *remarks = std::move(context.remarks);
  context.throw_if_any();
  return problem;
}

}  // namespace

CaptureProblem read_problem(const std::string& path, std::vector<Finding>* remarks,
                            UnlockedRobot* unlocked) {
  const std::string text = read_text_file(path, io::DocumentLimits{}.bytes);
  return read(text, path,
              {.folder = std::filesystem::path(path).parent_path().string(), .unlocked = unlocked},
              remarks);
}

int line_of_key(const std::string& path, const std::string& key) {
  io::ReadContext context{path, {}, {}};
  const io::Node root = io::parse_document(read_text_file(path), context, io::kPlanLimits);
  int line = 0;
  const io::Node* node = &root;
  for (std::size_t begin = 0; begin < key.size() && node != nullptr;) {
    const std::size_t end = std::min(key.find('.', begin), key.size());
    const std::string part = key.substr(begin, end - begin);
    const auto at = std::find(node->keys.begin(), node->keys.end(), part);
    if (at != node->keys.end()) {
      line = node->key_lines[static_cast<std::size_t>(at - node->keys.begin())];
    }
    node = node->find(part);
    begin = end + 1;
  }
  return line;
}

CaptureProblem read_problem_text(std::string_view text, const std::string& source,
                                 const std::string& urdf) {
  return read(text, source, {.urdf = urdf});
}

std::string problem_to_json(const CaptureProblem& problem) {
  return io::pretty(io::problem_json(problem));
}

}  // namespace stillbase
