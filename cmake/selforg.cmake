# libselforg: the layers selforg and base in a shared library of their own, for programs without a simulator. It has its own CMake
# package, selforg; libsandlot holds the same layers again.
add_library(selforg_library SHARED $<TARGET_OBJECTS:sandlot_selforg> $<TARGET_OBJECTS:sandlot_base>)
set_target_properties(selforg_library PROPERTIES OUTPUT_NAME selforg LINKER_LANGUAGE CXX VERSION ${PROJECT_VERSION}
  SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
foreach(name IN ITEMS fmt spdlog sleef json)
  target_link_libraries(selforg_library PRIVATE ${sandlot_third_party_${name}})
endforeach()
target_include_directories(selforg_library INTERFACE src)

# The plain program of examples/selforg, as the tests run it.
add_executable(selforg_wheels EXCLUDE_FROM_ALL examples/selforg/wheels.cpp)
target_link_libraries(selforg_wheels PRIVATE selforg_library)
