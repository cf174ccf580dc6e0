# Whether this Ipopt takes the routines of a linear solver from outside, as releases before 3.14 do.
include(CheckCXXSymbolExists)
set(CMAKE_REQUIRED_LIBRARIES Ipopt::Ipopt)
check_cxx_symbol_exists(LSL_setMA27 HSLLoader.h STILLBASE_IPOPT_TAKES_MA27)
unset(CMAKE_REQUIRED_LIBRARIES)
if(STILLBASE_IPOPT_TAKES_MA27)
  set_source_files_properties(${PROJECT_SOURCE_DIR}/src/nlp/ipopt_linear_solver.cpp
    PROPERTIES COMPILE_DEFINITIONS STILLBASE_IPOPT_TAKES_MA27 SKIP_PRECOMPILE_HEADERS ON)
endif()
