#include <Eigen/Core>

#include <fmt/format.h>

#include <stillbase/core/error.hpp>
#include <stillbase/core/file.hpp>
#include <stillbase/io/plan_file.hpp>

namespace stillbase {

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
