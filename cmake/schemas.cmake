# The JSON Schemas of src/io/schema as text in the library: src/io/schema_texts.hpp. The build runs
# this file as a script whenever one of them has changed.
if(CMAKE_SCRIPT_MODE_FILE)
  file(GLOB schema_files ${SCHEMA_FOLDER}/*.json)
  set(schema_entries "")
  foreach(schema_file IN LISTS schema_files)
    file(READ ${schema_file} schema_text)
    get_filename_component(schema_name ${schema_file} NAME)
    string(APPEND schema_entries "    {\"${schema_name}\",\n     R\"schema(${schema_text})schema\"},\n")
  endforeach()
  file(WRITE ${SCHEMA_SOURCE} "// Made by cmake/schemas.cmake.
#include \"io/schema_texts.hpp\"

namespace stillbase::io {

std::vector<SchemaText> schema_texts() {
  return {
${schema_entries}  };
}

}  // namespace stillbase::io
")
  return()
endif()

file(GLOB schema_files CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/io/schema/*.json)
set(schema_source ${PROJECT_BINARY_DIR}/schema_texts.cpp)
add_custom_command(
  OUTPUT ${schema_source}
  COMMAND ${CMAKE_COMMAND} -D SCHEMA_FOLDER=${PROJECT_SOURCE_DIR}/src/io/schema -D SCHEMA_SOURCE=${schema_source}
          -P ${PROJECT_SOURCE_DIR}/cmake/schemas.cmake
  DEPENDS ${schema_files} ${PROJECT_SOURCE_DIR}/cmake/schemas.cmake
  COMMENT "Schemas of the file formats" VERBATIM)
target_sources(stillbase PRIVATE ${schema_source})
