# The libraries robios6 and robios7 that RoBIOS programs are linked with. They use the C library alone and show only the programs'
# header and what stands in front of functions of the C library.
# lib/sandlot/librobios7.so and include/robios7/eyebot.h of an installation: gcc prog.c -I<include>/robios7 -L<lib>/sandlot -lrobios7
file(GLOB robios_common CONFIGURE_DEPENDS robios/src/*.cpp)
foreach(generation 6 7)
  file(GLOB sources CONFIGURE_DEPENDS robios/src/robios${generation}/*.cpp)
  add_library(robios${generation} SHARED ${robios_common} ${sources})
  target_include_directories(robios${generation} PRIVATE src robios/include/robios${generation})
  set_target_properties(robios${generation} PROPERTIES CXX_VISIBILITY_PRESET hidden DISABLE_PRECOMPILE_HEADERS ON
    UNITY_BUILD OFF LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/robios)
  target_link_libraries(robios${generation} PRIVATE ${CMAKE_DL_LIBS})
  target_link_options(robios${generation} PRIVATE -static-libstdc++ LINKER:--exclude-libs,ALL LINKER:-z,nodelete)
endforeach()

# Included by cmake/tests.cmake: programs in C run against a fake simulator.
function(sandlot_robios_tests)
  file(GLOB sources CONFIGURE_DEPENDS robios/tests/*.cpp)
  sandlot_test_executable(robios_tests "${sources}" "")
  add_dependencies(robios_tests robios6 robios7)
  file(RELATIVE_PATH libraries ${CMAKE_SOURCE_DIR} ${CMAKE_BINARY_DIR}/robios)
  target_compile_definitions(robios_tests PRIVATE SANDLOT_ROBIOS_LIBRARIES="${libraries}")
endfunction()
