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

/// The fields of all files that people write, and of plans, as tables in Markdown: what each means,
/// its unit and frame, its range, and what holds when it is not stated.
std::string field_reference();

}  // namespace stillbase
