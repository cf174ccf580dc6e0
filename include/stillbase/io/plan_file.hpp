// Plan files: JSON that holds everything a plan says and everything it was made from.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include <stillbase/plan/plan.hpp>

namespace stillbase {

/// Program or library name -> version.
using ToolVersions = std::map<std::string, std::string>;

/// A file that a plan was made from.
struct InputFile {
  std::string role;    ///< "problem", "robot" or "target"
  std::string path;    ///< the problem's as it was named; the others' as the problem names them
  std::string sha256;  ///< of the whole file
};

/// The problem file and the files that it names, as they are now.
/// @throws InputError, FileError as read_problem() for files that are missing or no YAML
std::vector<InputFile> input_files(const std::string& problem_path);

/// A plan as it was read, with the fingerprints that it states and those of what was read. They
/// differ when somebody has changed the file: that is for `verify` to say, not an error of reading.
struct PlanFile {
  Plan plan;
  ToolVersions tool;
  std::vector<InputFile> inputs;      ///< empty: it was not made from files
  std::string stated_sha256;          ///< `content_sha256`
  std::string computed_sha256;        ///< of the content that was read
  std::string stated_robot_sha256;    ///< `robot.sha256`
  std::string computed_robot_sha256;  ///< of `robot.urdf`
  bool is_as_written() const {
    return stated_sha256 == computed_sha256 && stated_robot_sha256 == computed_robot_sha256;
  }
};

/// Text of a plan file (`format: stillbase.plan`).
///
/// Numbers read back exactly. A constraint without lower or upper bound, and a clearance where
/// nothing is near, say null. `content_sha256` is the SHA-256 of the document without `tool`,
/// `timing`, `verification` and itself, written with sorted keys and without white space.
/// @param verification_json an object to be put under `verification`; empty: none
/// @param inputs the files that the plan was made from
/// @throws std::invalid_argument for any other number that is not finite
std::string plan_to_json(const Plan& plan, const ToolVersions& tool,
                         const std::string& verification_json = {},
                         const std::vector<InputFile>& inputs = {});

/// Reads a plan file: the inverse of plan_to_json(). The robot and the problem come from the text
/// alone.
///
/// Strict: unknown, duplicate or missing keys, wrong types and lengths, and fields that must agree
/// with each other but do not. `verification` is allowed and not looked at.
/// @param source name of the text for messages
/// @throws InputError with every finding
PlanFile read_plan(std::string_view text, const std::string& source);

/// Versions of stillbase, of Eigen and of the compiler.
ToolVersions tool_versions();

/// Reads a plan file that is as it was written.
/// @throws InputError as read_plan(), and where a fingerprint does not fit; FileError
PlanFile load_plan(const std::string& path);

/// Writes a plan file, whole or not at all.
/// @param replace false: an existing file is an error
/// @throws FileError
void write_plan(const Plan& plan, const std::string& path, bool replace = false);

}  // namespace stillbase
