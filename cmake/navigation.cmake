# libsandlot_navigation: the layer navigation and what it is made of in a shared library of their own, for programs on real robots,
# without a simulator. It has its own CMake package, sandlot_navigation; libsandlot holds the same layers again.
set(objects "")
foreach(layer IN ITEMS navigation perception messages geometry files base)
  list(APPEND objects $<TARGET_OBJECTS:sandlot_${layer}>)
endforeach()
add_library(navigation_library SHARED ${objects})
set_target_properties(navigation_library PROPERTIES OUTPUT_NAME sandlot_navigation LINKER_LANGUAGE CXX VERSION ${PROJECT_VERSION}
  SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
foreach(name IN ITEMS fmt spdlog sleef json yaml-cpp tinyxml2)
  target_link_libraries(navigation_library PRIVATE ${sandlot_third_party_${name}})
endforeach()
target_include_directories(navigation_library INTERFACE src)
