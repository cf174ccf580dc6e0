# What `cmake --install` gives: headers, library with its CMake and pkg-config files, the tool, the
# problem files, the suite of the benchmark and the schemas of all files. Each belongs to a
# component, of which packages are made (cmake/packages.cmake): runtime (the shared C library),
# development, tool, python, doc.
include(CMakePackageConfigHelpers)

set(STILLBASE_CMAKE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/stillbase)
set(STILLBASE_PROBLEMS_DIR ${CMAKE_INSTALL_DATADIR}/stillbase/problems)

install(TARGETS stillbase EXPORT stillbaseTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
  COMPONENT development)
if(TARGET stillbase_proof)
  install(TARGETS stillbase_proof EXPORT stillbaseTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
    COMPONENT development)
endif()
if(TARGET stillbase_c)
  install(TARGETS stillbase_c EXPORT stillbaseTargets LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}
    COMPONENT runtime NAMELINK_COMPONENT development)
endif()
if(TARGET stillbase_tool)
  install(TARGETS stillbase_tool RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT tool)
  install(CODE "
    set(folder \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_DATADIR}/stillbase/schema\")
    file(MAKE_DIRECTORY \${folder})
    execute_process(COMMAND $<TARGET_FILE:stillbase_tool> schema OUTPUT_VARIABLE formats)
    string(REGEX MATCHALL \"\\n[a-z_]+ \" formats \"\\n\${formats}\")
    foreach(format IN LISTS formats)
      string(STRIP \"\${format}\" format)
      execute_process(COMMAND $<TARGET_FILE:stillbase_tool> schema \${format}
                      OUTPUT_FILE \${folder}/\${format}.schema.json)
    endforeach()
    set(share \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_DATADIR}\")
    file(MAKE_DIRECTORY \${share}/man/man1 \${share}/bash-completion/completions
         \${share}/zsh/site-functions)
    execute_process(COMMAND $<TARGET_FILE:stillbase_tool> help --man
                    OUTPUT_FILE \${share}/man/man1/stillbase.1)
    execute_process(COMMAND $<TARGET_FILE:stillbase_tool> help --completion bash
                    OUTPUT_FILE \${share}/bash-completion/completions/stillbase)
    execute_process(COMMAND $<TARGET_FILE:stillbase_tool> help --completion zsh
                    OUTPUT_FILE \${share}/zsh/site-functions/_stillbase)" COMPONENT tool)
endif()
if(NOT TARGET stillbase_proof)
  set(without_proof PATTERN "proof" EXCLUDE)
endif()
install(DIRECTORY ${PROJECT_SOURCE_DIR}/include/stillbase DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}
  COMPONENT development FILES_MATCHING PATTERN "*.hpp" PATTERN "*.h" ${without_proof})
install(DIRECTORY ${PROJECT_SOURCE_DIR}/problems/ DESTINATION ${STILLBASE_PROBLEMS_DIR} COMPONENT tool)
# The suite names ../problems.
install(FILES ${PROJECT_SOURCE_DIR}/bench/suite.yaml ${PROJECT_SOURCE_DIR}/bench/best_known.json
  DESTINATION ${CMAKE_INSTALL_DATADIR}/stillbase/bench COMPONENT tool)
install(FILES ${PROJECT_SOURCE_DIR}/README.md ${PROJECT_SOURCE_DIR}/CHANGELOG.md
  DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT doc)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/docs ${PROJECT_SOURCE_DIR}/examples
  DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT doc)

configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/stillbaseConfig.cmake.in
  ${PROJECT_BINARY_DIR}/stillbaseConfig.cmake
  INSTALL_DESTINATION ${STILLBASE_CMAKE_DIR} PATH_VARS STILLBASE_PROBLEMS_DIR)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/stillbaseConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/stillbaseConfig.cmake
  ${PROJECT_BINARY_DIR}/stillbaseConfigVersion.cmake
  ${PROJECT_SOURCE_DIR}/cmake/FindIpoptAndOmpl.cmake
  DESTINATION ${STILLBASE_CMAKE_DIR} COMPONENT development)
install(EXPORT stillbaseTargets NAMESPACE stillbase:: DESTINATION ${STILLBASE_CMAKE_DIR}
  COMPONENT development)

# For builds without CMake. The library is static and the packages that it is made of are not, so they
# are public: with `pkg-config --static` their own private libraries would have to be there, too.
file(RELATIVE_PATH path_to_prefix /prefix/${CMAKE_INSTALL_LIBDIR}/pkgconfig /prefix)
foreach(library IN ITEMS stillbase stillbase_c)
  if(TARGET ${library})
    configure_file(${PROJECT_SOURCE_DIR}/packaging/${library}.pc.in
      ${PROJECT_BINARY_DIR}/${library}.pc @ONLY)
    install(FILES ${PROJECT_BINARY_DIR}/${library}.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig
      COMPONENT development)
  endif()
endforeach()
include(cmake/packages.cmake)
