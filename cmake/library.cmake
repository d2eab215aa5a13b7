# libsandlot: all layers in one shared library. The command, programs that embed Sandlot and plugins share it, so that
# there is one of everything in a process. Tests link the layers themselves.
set(objects "")
foreach(layer IN LISTS sandlot_layers)
  if(layer STREQUAL "bench")
    continue()  # a program of its own
  endif()
  get_target_property(type sandlot_${layer} TYPE)
  if(type STREQUAL "STATIC_LIBRARY")
    list(APPEND objects $<TARGET_OBJECTS:sandlot_${layer}>)
  endif()
endforeach()
add_library(sandlot_library SHARED ${objects})
set_target_properties(sandlot_library PROPERTIES
  OUTPUT_NAME sandlot LINKER_LANGUAGE CXX VERSION ${PROJECT_VERSION}
  SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
get_cmake_property(names VARIABLES)
list(FILTER names INCLUDE REGEX "^sandlot_third_party_")
foreach(name IN LISTS names)
  target_link_libraries(sandlot_library PRIVATE ${${name}})
endforeach()
target_include_directories(sandlot_library INTERFACE src ${SANDLOT_GENERATED})
# Calls within the library go straight to their functions, whatever a program or plugin calls its own. ODE's calls of
# dRandInt are bound by the loader, to ours: see physics/rigid/library.h.
target_link_options(sandlot_library PRIVATE LINKER:-Bsymbolic-functions)

# sandlot-bench, which `sandlot bench` runs: it carries the engines that ours are measured against.
add_executable(sandlot_bench_command src/bench/entry.cpp $<TARGET_OBJECTS:sandlot_bench>)
set_target_properties(sandlot_bench_command PROPERTIES OUTPUT_NAME sandlot-bench)
# Only `./dev bench` builds it.
set_target_properties(sandlot_bench sandlot_bench_command PROPERTIES EXCLUDE_FROM_ALL ON)
target_link_libraries(sandlot_bench_command PRIVATE sandlot_library sandlot_sdformat)
if(TARGET sandlot_opencv)
  target_link_libraries(sandlot_bench_command PRIVATE sandlot_opencv)
endif()
foreach(name IN LISTS names)
  target_link_libraries(sandlot_bench_command PRIVATE ${${name}})
endforeach()
