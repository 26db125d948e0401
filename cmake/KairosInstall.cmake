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
