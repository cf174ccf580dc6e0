# 64-bit ARM with Debian's cross compiler (g++-aarch64-linux-gnu) and the libraries of a Debian root
# of that architecture, where `tools/test-arm64` puts them. Programs of the build run under qemu-user
# where it is installed.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_C_COMPILER aarch64-linux-gnu-gcc)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)
set(CMAKE_LIBRARY_ARCHITECTURE aarch64-linux-gnu)

get_filename_component(STILLBASE_ARM64_ROOT ${CMAKE_CURRENT_LIST_DIR}/../../build/root-arm64 ABSOLUTE)
set(CMAKE_SYSROOT ${STILLBASE_ARM64_ROOT})
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)

find_program(STILLBASE_QEMU_AARCH64 NAMES qemu-aarch64-static qemu-aarch64)
if(STILLBASE_QEMU_AARCH64)
  set(CMAKE_CROSSCOMPILING_EMULATOR ${STILLBASE_QEMU_AARCH64} -L ${STILLBASE_ARM64_ROOT})
endif()
