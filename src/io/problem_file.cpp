#include <filesystem>

#include <stillbase/core/file.hpp>
#include <stillbase/io/problem_file.hpp>

#include "io/problem_reader.hpp"

namespace stillbase {

namespace {

CaptureProblem read(std::string_view text, const std::string& source,
                    const io::ProblemSources& sources) {
  io::ReadContext context{source, {}, {}};
  const io::Node root = io::parse_document(text, context);
  CaptureProblem problem = io::read_problem_map(root, context, "", sources);
  context.throw_if_any();
  return problem;
}

}  // namespace

CaptureProblem read_problem(const std::string& path) {
  const std::string text = read_text_file(path, io::DocumentLimits{}.bytes);
  return read(text, path, {.folder = std::filesystem::path(path).parent_path().string()});
}

CaptureProblem read_problem_text(std::string_view text, const std::string& source,
                                 const std::string& urdf) {
  return read(text, source, {.urdf = urdf});
}

}  // namespace stillbase
