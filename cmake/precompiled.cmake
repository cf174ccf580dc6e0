# Headers that nearly every file reads, parsed once. Three fifths of a file's compile time is reading
# headers and instantiating Eigen's expression classes; plan.hpp brings the common ones.
# CMAKE_DISABLE_PRECOMPILE_HEADERS shows whether each file still names what it needs.
set(STILLBASE_PRECOMPILED <algorithm> <array> <cmath> <functional> <limits> <map> <memory> <numeric>
  <optional> <set> <stdexcept> <string> <string_view> <utility> <vector> <Eigen/Dense>
  <fmt/format.h> <stillbase/plan/plan.hpp>)
foreach(part IN ITEMS stillbase stillbase_cold)
  target_precompile_headers(${part} PRIVATE ${STILLBASE_PRECOMPILED})
endforeach()
# Other options than the library's, other precompiled headers.
file(GLOB files_with_own_options ${PROJECT_SOURCE_DIR}/src/impact/batch_two_lanes.cpp
  ${PROJECT_SOURCE_DIR}/src/impact/batch_avx*.cpp ${PROJECT_SOURCE_DIR}/src/simulation/lanes_*.cpp
  ${PROJECT_SOURCE_DIR}/src/core/sines_*.cpp ${PROJECT_SOURCE_DIR}/src/dynamics/wide_avx*.cpp)
set_source_files_properties(${files_with_own_options} PROPERTIES SKIP_PRECOMPILE_HEADERS ON)
