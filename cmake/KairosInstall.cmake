# Installs the library, its headers, the program and a CMake package: find_package(kairos) then gives kairos::kairos.

include(CMakePackageConfigHelpers)

install(TARGETS kairos EXPORT kairos LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(TARGETS kairos_cli RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(DIRECTORY ${PROJECT_SOURCE_DIR}/include/kairos DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} FILES_MATCHING PATTERN *.h)

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/kairos)
install(EXPORT kairos NAMESPACE kairos:: DESTINATION ${package_dir} FILE kairos-targets.cmake)
configure_package_config_file(cmake/kairos-config.cmake.in ${CMAKE_CURRENT_BINARY_DIR}/kairos-config.cmake
  INSTALL_DESTINATION ${package_dir} NO_SET_AND_CHECK_MACRO NO_CHECK_REQUIRED_COMPONENTS_MACRO)
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/kairos-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/kairos-config.cmake ${CMAKE_CURRENT_BINARY_DIR}/kairos-config-version.cmake
  DESTINATION ${package_dir})

# For those who build with neither CMake nor Python. Paths are relative to the file: a prefix can be moved.
file(RELATIVE_PATH prefix_from_pc /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
string(REGEX REPLACE "/$" "" prefix_from_pc "${prefix_from_pc}")
configure_file(cmake/kairos.pc.in ${CMAKE_CURRENT_BINARY_DIR}/kairos.pc @ONLY)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/kairos.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)

# What the program says of itself: completions of shells and, where there is help2man, pages for man.
if(KAIROS_SANITIZE)
  return()
endif()
set(words_dir ${CMAKE_CURRENT_BINARY_DIR}/share)
set(made ${words_dir}/kairos.bash ${words_dir}/_kairos ${words_dir}/kairos.fish)
set(commands COMMAND kairos_cli completion bash > ${words_dir}/kairos.bash
  COMMAND kairos_cli completion zsh > ${words_dir}/_kairos COMMAND kairos_cli completion fish > ${words_dir}/kairos.fish)
install(FILES ${words_dir}/kairos.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME kairos)
install(FILES ${words_dir}/_kairos DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions)
install(FILES ${words_dir}/kairos.fish DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d)
find_program(HELP2MAN help2man)
if(HELP2MAN)
  file(STRINGS ${PROJECT_SOURCE_DIR}/apps/kairos/main.cpp subcommands REGEX "add_[a-z]+_command\\(app")
  list(TRANSFORM subcommands REPLACE ".*add_([a-z]+)_command.*" "\\1")
  foreach(subcommand IN ITEMS "" LISTS subcommands)
    string(JOIN - page kairos ${subcommand})
    list(APPEND commands COMMAND ${CMAKE_COMMAND} -DHELP2MAN=${HELP2MAN} -DPROGRAM=$<TARGET_FILE:kairos_cli>
      -DSUBCOMMAND=${subcommand} -DVERSION=${PROJECT_VERSION} -DOUT=${words_dir}/${page}.1
      -P ${PROJECT_SOURCE_DIR}/cmake/man_page.cmake)
    list(APPEND made ${words_dir}/${page}.1)
    install(FILES ${words_dir}/${page}.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
  endforeach()
endif()
file(MAKE_DIRECTORY ${words_dir})
add_custom_command(OUTPUT ${made} ${commands} DEPENDS kairos_cli ${PROJECT_SOURCE_DIR}/cmake/man_page.cmake VERBATIM)
add_custom_target(kairos_words ALL DEPENDS ${made})
