# The libraries robios6 and robios7 that RoBIOS programs are linked with. They use the C library alone and show only the programs'
# header and what stands in front of functions of the C library.
# gcc prog.c -IPREFIX/include/robios7 -LPREFIX/lib -lrobios7

# Without a sanitizer: programs are compiled by whatever compiler their machine has, which knows nothing of it.
function(sandlot_robios_plain target)
  if(SANDLOT_SANITIZE)
    target_compile_options(${target} PRIVATE -fno-sanitize=all)
    target_link_options(${target} PRIVATE -fno-sanitize=all)
  endif()
endfunction()

file(GLOB robios_common CONFIGURE_DEPENDS robios/src/*.cpp)
foreach(generation 6 7)
  file(GLOB sources CONFIGURE_DEPENDS robios/src/robios${generation}/*.cpp)
  add_library(robios${generation} SHARED ${robios_common} ${sources})
  target_include_directories(robios${generation} PRIVATE src robios/include/robios${generation})
  set_target_properties(robios${generation} PROPERTIES CXX_VISIBILITY_PRESET hidden DISABLE_PRECOMPILE_HEADERS ON
    LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/robios)
  sandlot_unity(robios${generation})
  target_link_libraries(robios${generation} PRIVATE ${CMAKE_DL_LIBS})
  target_link_options(robios${generation} PRIVATE -static-libstdc++ LINKER:--exclude-libs,ALL LINKER:-z,nodelete)
  sandlot_robios_plain(robios${generation})
endforeach()

# Runs programs that are shared libraries.
add_executable(robios_host robios/host/host.cpp)
set_target_properties(robios_host PROPERTIES DISABLE_PRECOMPILE_HEADERS ON)
target_link_libraries(robios_host PRIVATE ${CMAKE_DL_LIBS})
target_link_options(robios_host PRIVATE -static-libstdc++)
sandlot_robios_plain(robios_host)

# Part of cmake/install.cmake.
macro(sandlot_robios_install)
  install(TARGETS robios6 robios7 LIBRARY DESTINATION lib)
  install(TARGETS robios_host RUNTIME DESTINATION bin)
  install(FILES robios/python/eye.py robios/python/robios_main.py DESTINATION lib/robios)
  install(DIRECTORY robios/include/robios6 robios/include/robios7 DESTINATION include)
endmacro()

# Included by cmake/tests.cmake: programs in C run against a fake simulator.
function(sandlot_robios_tests)
  file(GLOB sources CONFIGURE_DEPENDS robios/tests/*.cpp)
  sandlot_test_executable(robios_tests "${sources}" "")
  add_dependencies(robios_tests robios6 robios7 robios_host)
  file(RELATIVE_PATH libraries ${CMAKE_SOURCE_DIR} ${CMAKE_BINARY_DIR}/robios)
  file(RELATIVE_PATH host ${CMAKE_SOURCE_DIR} ${CMAKE_BINARY_DIR}/robios_host)
  target_compile_definitions(robios_tests PRIVATE SANDLOT_ROBIOS_LIBRARIES="${libraries}" SANDLOT_ROBIOS_HOST="${host}")
endfunction()
