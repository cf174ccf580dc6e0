# Installs, then configures, builds and runs the consumer; the first failure ends it.
file(REMOVE_RECURSE ${WORK_DIR})

execute_process(COMMAND ${CMAKE_COMMAND} --install ${BUILD_DIR} --config ${CONFIG} --prefix ${WORK_DIR}/prefix
  OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)

# A package that still points into the build or source tree works only on this machine.
file(GLOB_RECURSE package_files ${WORK_DIR}/prefix/*.cmake)
foreach(package_file IN LISTS package_files)
  file(READ ${package_file} text)
  string(FIND "${text}" "${BUILD_DIR}" position)
  if(NOT position EQUAL -1)
    message(FATAL_ERROR "${package_file} names the build folder")
  endif()
endforeach()

execute_process(
  COMMAND ${CMAKE_COMMAND} -S ${CONSUMER_SOURCE_DIR} -B ${WORK_DIR}/build -G ${GENERATOR}
    -D CMAKE_BUILD_TYPE=${CONFIG} -D CMAKE_PREFIX_PATH=${WORK_DIR}/prefix
    -D CMAKE_CXX_COMPILER=${CXX_COMPILER} -D "CMAKE_CXX_FLAGS=${CXX_FLAGS}"
    -D EXAMPLES_DIR=${EXAMPLES_DIR}
  COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${CMAKE_COMMAND} --build ${WORK_DIR}/build --config ${CONFIG}
  COMMAND_ERROR_IS_FATAL ANY)
find_program(consumer consumer PATHS ${WORK_DIR}/build ${WORK_DIR}/build/${CONFIG} REQUIRED NO_DEFAULT_PATH)
execute_process(COMMAND ${consumer} COMMAND_ERROR_IS_FATAL ANY)

# All read problems/ from the working directory. The library of proofs may be left out of a build.
set(programs readme example without_proof)
if(EXISTS ${WORK_DIR}/prefix/include/stillbase/proof)
  list(APPEND programs with_proof)
endif()
foreach(program IN LISTS programs)
  find_program(${program} ${program} PATHS ${WORK_DIR}/build ${WORK_DIR}/build/${CONFIG} REQUIRED NO_DEFAULT_PATH)
  execute_process(COMMAND ${${program}} WORKING_DIRECTORY ${WORK_DIR}/prefix/share/stillbase
    COMMAND_ERROR_IS_FATAL ANY)
endforeach()

# A build without CMake: pkg-config says how.
find_program(pkg_config pkg-config)
if(pkg_config)
  file(GLOB_RECURSE pc_file ${WORK_DIR}/prefix/*/stillbase.pc)
  get_filename_component(pc_folder ${pc_file} DIRECTORY)
  set(ENV{PKG_CONFIG_PATH} ${pc_folder})
  foreach(part IN ITEMS cflags libs)
    execute_process(COMMAND ${pkg_config} --${part} stillbase OUTPUT_VARIABLE ${part}
      OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
    separate_arguments(${part} UNIX_COMMAND "${${part}}")
  endforeach()
  separate_arguments(flags UNIX_COMMAND "${CXX_FLAGS}")
  execute_process(COMMAND ${CXX_COMPILER} ${flags} ${CONSUMER_SOURCE_DIR}/readme.cpp ${cflags}
    -o ${WORK_DIR}/by_pkg_config ${libs} COMMAND_ERROR_IS_FATAL ANY)
  execute_process(COMMAND ${WORK_DIR}/by_pkg_config
    WORKING_DIRECTORY ${WORK_DIR}/prefix/share/stillbase COMMAND_ERROR_IS_FATAL ANY)

  # The user's own -march: Eigen would align otherwise than the library, and objects that cross the
  # border would be freed in another way than they were allocated.
  if(CMAKE_HOST_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
    execute_process(COMMAND ${CXX_COMPILER} ${flags} -march=native ${CONSUMER_SOURCE_DIR}/readme.cpp
      ${cflags} -o ${WORK_DIR}/with_march ${libs} COMMAND_ERROR_IS_FATAL ANY)
    execute_process(COMMAND ${WORK_DIR}/with_march
      WORKING_DIRECTORY ${WORK_DIR}/prefix/share/stillbase COMMAND_ERROR_IS_FATAL ANY)
    set(own_flags ${cflags})
    list(FILTER own_flags EXCLUDE REGEX "-DEIGEN_")
    execute_process(COMMAND ${CXX_COMPILER} -fsyntax-only -mavx2
      ${CONSUMER_SOURCE_DIR}/readme.cpp ${own_flags} ERROR_VARIABLE message RESULT_VARIABLE result)
    if(result EQUAL 0 OR NOT message MATCHES "EIGEN_MAX_ALIGN_BYTES=16")
      message(FATAL_ERROR "without the flags of the package -mavx2 is not refused:\n${message}")
    endif()
  endif()
else()
  message(STATUS "no pkg-config here: stillbase.pc is not tried")
endif()

# The tool is part of the package where it is part of the build.
if(EXISTS ${WORK_DIR}/prefix/bin/stillbase)
  execute_process(COMMAND ${WORK_DIR}/prefix/bin/stillbase --version COMMAND_ERROR_IS_FATAL ANY)
  # Far from the source tree it finds the suite that was installed with it.
  execute_process(
    COMMAND ${WORK_DIR}/prefix/bin/stillbase bench --select planar_two_link/case/0
      --optimizers nlopt-slsqp --seeds 1 --budget 50
    WORKING_DIRECTORY ${WORK_DIR} OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
  foreach(page IN ITEMS man/man1/stillbase.1 bash-completion/completions/stillbase
                        zsh/site-functions/_stillbase)
    file(READ ${WORK_DIR}/prefix/share/${page} text)
    if(NOT text MATCHES "campaign")
      message(FATAL_ERROR "share/${page} lacks the commands")
    endif()
  endforeach()
endif()
