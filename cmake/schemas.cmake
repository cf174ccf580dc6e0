# The JSON Schemas of src/io/schema as text in the library: src/io/schema_texts.hpp.
file(GLOB schema_files CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/io/schema/*.json)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${schema_files})
set(schema_entries "")
foreach(schema_file IN LISTS schema_files)
  file(READ ${schema_file} schema_text)
  get_filename_component(schema_name ${schema_file} NAME)
  string(APPEND schema_entries "    {\"${schema_name}\",\n     R\"schema(${schema_text})schema\"},\n")
endforeach()
set(schema_source ${PROJECT_BINARY_DIR}/schema_texts.cpp)
file(GENERATE OUTPUT ${schema_source} CONTENT "// Made by cmake/schemas.cmake.
#include \"io/schema_texts.hpp\"

namespace stillbase::io {

std::vector<SchemaText> schema_texts() {
  return {
${schema_entries}  };
}

}  // namespace stillbase::io
")
target_sources(stillbase PRIVATE ${schema_source})
