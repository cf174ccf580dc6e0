// The files of src/io/schema, put into the library by cmake/schemas.cmake.
#pragma once

#include <string_view>
#include <vector>

namespace stillbase::io {

struct SchemaText {
  std::string_view file;  ///< "problem.schema.json"
  std::string_view text;
};

std::vector<SchemaText> schema_texts();

}  // namespace stillbase::io
