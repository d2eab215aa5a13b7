# What `cmake --install` leaves: bin/sandlot, lib/libsandlot.so, the headers for users' own controllers and programs, the CMake
# packages and the pkg-config file, clients for other programs, the models, worlds, scenarios and teams, documentation and examples. Everything finds everything relative to itself.
include(CMakePackageConfigHelpers)
set_target_properties(sandlot sandlot_bench_command PROPERTIES INSTALL_RPATH "$ORIGIN/../lib")
install(TARGETS sandlot RUNTIME DESTINATION bin)
install(TARGETS sandlot_bench_command RUNTIME DESTINATION bin OPTIONAL)  # `./dev bench` builds it
add_dependencies(sandlot selforg_library navigation_library robios6 robios7 robios_host)  # what builds the command can install
install(TARGETS sandlot_library selforg_library navigation_library LIBRARY DESTINATION lib)
set(headers ${CMAKE_BINARY_DIR}/public)
install(CODE "execute_process(COMMAND \"${CMAKE_COMMAND}\" -DSOURCE=${CMAKE_SOURCE_DIR}/src -DGENERATED=${SANDLOT_GENERATED}
  -DOUT=${headers} -P \"${CMAKE_SOURCE_DIR}/cmake/public_headers.cmake\" COMMAND_ERROR_IS_FATAL ANY)")
install(DIRECTORY ${headers}/sandlot DESTINATION include)
# What Python left beside a program that ran in this folder names the folder.
install(DIRECTORY models worlds scenarios teams templates DESTINATION share/sandlot USE_SOURCE_PERMISSIONS
  PATTERN "__pycache__" EXCLUDE)
install(DIRECTORY clients/python/ DESTINATION share/sandlot/python PATTERN "__pycache__" EXCLUDE)
install(DIRECTORY clients/cpp/sandlot_client DESTINATION include)
install(FILES cmake/sandlot_clientConfig.cmake DESTINATION lib/cmake/sandlot_client)
install(DIRECTORY clients/javascript/ DESTINATION share/sandlot/javascript)
sandlot_robios_install()
install(FILES LICENSE DESTINATION share/sandlot)
install(DIRECTORY docs/ examples DESTINATION share/doc/sandlot PATTERN "__pycache__" EXCLUDE)

# Users' inline copies of our functions must give the same bits as ours.
set(flags -ffp-contract=off)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  list(APPEND flags -fno-tree-slp-vectorize)
endif()
if(SANDLOT_MARCH)
  list(APPEND flags -march=${SANDLOT_MARCH})
endif()
if(SANDLOT_SANITIZE)
  list(APPEND flags -fsanitize=${SANDLOT_SANITIZE})
endif()
list(JOIN flags " " flags_text)
configure_file(cmake/sandlotConfig.cmake.in ${CMAKE_BINARY_DIR}/package/sandlotConfig.cmake @ONLY)
configure_file(cmake/sandlot.pc.in ${CMAKE_BINARY_DIR}/package/sandlot.pc @ONLY)
write_basic_package_version_file(${CMAKE_BINARY_DIR}/package/sandlotConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/package/sandlotConfig.cmake ${CMAKE_BINARY_DIR}/package/sandlotConfigVersion.cmake
  DESTINATION lib/cmake/sandlot)
install(FILES ${CMAKE_BINARY_DIR}/package/sandlot.pc DESTINATION lib/pkgconfig)
configure_file(cmake/selforgConfig.cmake.in ${CMAKE_BINARY_DIR}/package/selforgConfig.cmake @ONLY)
write_basic_package_version_file(${CMAKE_BINARY_DIR}/package/selforgConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/package/selforgConfig.cmake ${CMAKE_BINARY_DIR}/package/selforgConfigVersion.cmake
  DESTINATION lib/cmake/selforg)
configure_file(cmake/sandlot_navigationConfig.cmake.in ${CMAKE_BINARY_DIR}/package/sandlot_navigationConfig.cmake @ONLY)
write_basic_package_version_file(${CMAKE_BINARY_DIR}/package/sandlot_navigationConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/package/sandlot_navigationConfig.cmake
  ${CMAKE_BINARY_DIR}/package/sandlot_navigationConfigVersion.cmake DESTINATION lib/cmake/sandlot_navigation)
