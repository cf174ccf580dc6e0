// JSON Schemas (draft-07) of the files, for editors and for programs that write or read them.
//
// A schema knows keys, types, units, words and ranges. Names of joints and files, and fields that
// contradict each other, are for the readers alone.
#pragma once

#include <string>
#include <vector>

namespace stillbase {

struct FileFormat {
  std::string name;         ///< "problem": what schema_of() takes
  std::string description;  ///< what such a file is
};

/// Every format that has a schema, by name.
std::vector<FileFormat> file_formats();

/// The schema of a format as one JSON document that refers to no other.
/// @throws std::invalid_argument for a name that is not among file_formats()
std::string schema_of(const std::string& name);

/// A member of a file that holds a number, a text or a flag, or lists of those.
struct Member {
  std::string path;   ///< "approach.base_poses[].position"; the key of a dictionary is not named
  std::string unit;   ///< of numbers; "1" without a dimension
  std::string frame;  ///< of vectors; empty: none
  std::string shape;  ///< of arrays: "k x n", k any number, n the number of joints
  std::string meaning;
};

/// Every member that the schema of a format allows, in its order.
/// @throws std::invalid_argument as schema_of()
std::vector<Member> members_of(const std::string& format);

/// The fields of a format, or without a name of all files that people write, as tables in Markdown:
/// what each means, its shape, unit and frame, its range, and what holds when it is not stated.
/// @throws std::invalid_argument as schema_of()
std::string field_reference(const std::string& format = "");

}  // namespace stillbase
