# find_package(sandlot_client) gives sandlot::client: #include <sandlot_client/client.h>, a header that needs C++17 and nlohmann/json
# (Debian: nlohmann-json3-dev) and nothing of the simulator.
include(CMakeFindDependencyMacro)
find_dependency(nlohmann_json 3)
if(NOT TARGET sandlot::client)
  get_filename_component(sandlot_client_prefix "${CMAKE_CURRENT_LIST_DIR}/../../.." ABSOLUTE)
  add_library(sandlot::client INTERFACE IMPORTED)
  set_target_properties(sandlot::client PROPERTIES
    INTERFACE_INCLUDE_DIRECTORIES "${sandlot_client_prefix}/include"
    INTERFACE_COMPILE_FEATURES cxx_std_17
    INTERFACE_LINK_LIBRARIES nlohmann_json::nlohmann_json)
endif()
