# Ipopt ships no CMake package and OMPL's names no target; both are linked by their shared library
# alone, so that none of the development packages behind them is needed.
find_path(IPOPT_INCLUDE_DIR IpTNLP.hpp PATH_SUFFIXES coin-or coin REQUIRED)
find_library(IPOPT_LIBRARY ipopt REQUIRED)
if(NOT TARGET Ipopt::Ipopt)
  add_library(Ipopt::Ipopt UNKNOWN IMPORTED)
  set_target_properties(Ipopt::Ipopt PROPERTIES
    IMPORTED_LOCATION "${IPOPT_LIBRARY}"
    INTERFACE_INCLUDE_DIRECTORIES "${IPOPT_INCLUDE_DIR}"
    INTERFACE_COMPILE_DEFINITIONS HAVE_CSTDDEF)  # IpSmartPtr.hpp stops without it
endif()

find_package(ompl 1.5 REQUIRED CONFIG)
find_library(OMPL_LIBRARY ompl REQUIRED)
if(NOT TARGET ompl::ompl)
  add_library(ompl::ompl UNKNOWN IMPORTED)
  set_target_properties(ompl::ompl PROPERTIES
    IMPORTED_LOCATION "${OMPL_LIBRARY}"
    INTERFACE_INCLUDE_DIRECTORIES "${OMPL_INCLUDE_DIR}"
    INTERFACE_LINK_LIBRARIES Eigen3::Eigen)
endif()
