# Tests: src/<layer>/**/*_test.cpp become <layer>_tests, tests/*_test.cpp become scenario_tests. One executable per
# layer keeps the number of links small. A layer's tests link that layer and what it may use; a test that needs more
# belongs into tests/, where everything is at hand.

# Tests are compiled once and run once: -O0 takes a third less time for the former than -O2, and what it adds to the latter is
# a tenth of that: most of a test's time is spent in the libraries. With the address sanitizer it takes less than half the time.
# The thread sanitizer makes code so slow already that tests of the server would run out of patience.
function(sandlot_test_options target)
  if(CMAKE_BUILD_TYPE STREQUAL "Release" OR SANDLOT_SANITIZE MATCHES "address")
    target_compile_options(${target} PRIVATE -O0)
  endif()
endfunction()

# Labels: a suite named Slow* is `slow`, one named Long* is `long`. Every other one is a `unit` test, or `system` where the tests
# are of whole programs (tests/) or talk by sockets.
function(sandlot_test_executable name sources libraries)
  if(NOT sources)
    return()
  endif()
  set(label unit)
  if(ARGC GREATER 3)
    set(label ${ARGV3})
  endif()
  add_executable(${name} ${sources})
  target_include_directories(${name} PRIVATE src)
  target_link_libraries(${name} PRIVATE ${libraries} GTest::gmock GTest::gtest_main)
  sandlot_test_options(${name})
  sandlot_precompile(${name} TEST)
  sandlot_unity(${name})
  # Tests run in the source root; from there this is the command that those in tests/ try.
  file(RELATIVE_PATH command ${CMAKE_SOURCE_DIR} ${CMAKE_BINARY_DIR}/sandlot)
  target_compile_definitions(${name} PRIVATE SANDLOT_BIN="${command}")
  set(timeout 240)
  if(SANDLOT_SANITIZE)
    set(timeout 600)  # what takes seconds takes minutes there
  endif()
  file(WRITE ${CMAKE_BINARY_DIR}/suites/${name}.cmake "set(program \"${CMAKE_BINARY_DIR}/${name}\")
set(folder \"${CMAKE_SOURCE_DIR}\")
set(label ${label})
set(timeout ${timeout})
set(environment \"${SANDLOT_TEST_ENVIRONMENT}\")
include(\"${CMAKE_SOURCE_DIR}/cmake/discover_suites.cmake\")
")
  set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES ${CMAKE_BINARY_DIR}/suites/${name}.cmake)
endfunction()

# The precompiled headers of g++ 12 define __OPTIMIZE__ at -O0, too, since fmt optimises some of its functions; the large products
# of Eigen in this test do not compile then.
set_source_files_properties(src/navigation/estimation/ekf_clones_test.cpp PROPERTIES
  SKIP_PRECOMPILE_HEADERS ON SKIP_UNITY_BUILD_INCLUSION ON)

set(layers ${sandlot_layers})
list(REVERSE layers)  # long batches first, as the layers themselves (layers.cmake)
foreach(layer IN LISTS layers)
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS src/${layer}/*_test.cpp)
  set(label unit)
  if(layer STREQUAL "server")
    set(label system)  # most of their time they wait for sockets
  endif()
  sandlot_test_executable(${layer}_tests "${sources}" sandlot_${layer} ${label})
  if(sources)
    list(APPEND layer_tests ${layer}_tests)
  endif()
endforeach()
add_custom_target(layer_tests DEPENDS ${layer_tests})
# The planar engine is held against Chipmunk. The program itself does without.
if(NOT sandlot_third_party_chipmunk)
  message(FATAL_ERROR "The tests need Chipmunk (Debian: libchipmunk-dev)")
endif()
target_link_libraries(physics_tests PRIVATE ${sandlot_third_party_chipmunk})
set_target_properties(sim_tests PROPERTIES ENABLE_EXPORTS ON)  # sim/world/heap_test.cpp asks for the names of functions
target_link_libraries(formats_tests PRIVATE sandlot_sdformat)
target_link_libraries(console_tests PRIVATE sandlot_record)  # what a script did is recorded and replayed
# tests/plugins/x.cpp become shared libraries beside the command: some fit, each of the others is wrong in one way.
file(GLOB sources CONFIGURE_DEPENDS tests/plugins/*.cpp)
set(plugins "")
foreach(source IN LISTS sources)
  get_filename_component(name ${source} NAME_WE)
  add_library(plugin_${name} MODULE ${source})
  target_link_libraries(plugin_${name} PRIVATE sandlot_library)
  target_compile_definitions(plugin_${name} PRIVATE SANDLOT_CONTROL_FLAGS)
  set_target_properties(plugin_${name} PROPERTIES PREFIX "" OUTPUT_NAME ${name} CXX_VISIBILITY_PRESET hidden
    LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/test_plugins)
  list(APPEND plugins plugin_${name})
endforeach()
# The example that has the same law as a controller of ours.
add_library(plugin_clearing MODULE examples/clearing_plugin/plugin.cpp examples/clearing_plugin/clearing.cpp)
target_link_libraries(plugin_clearing PRIVATE sandlot_library)
target_compile_definitions(plugin_clearing PRIVATE SANDLOT_CONTROL_FLAGS)
set_target_properties(plugin_clearing PROPERTIES PREFIX "" OUTPUT_NAME clearing_plugin CXX_VISIBILITY_PRESET hidden
  LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/test_plugins)
list(APPEND plugins plugin_clearing)
# And the client in C++ that has it.
add_executable(client_clearing examples/clients/clearing.cpp)
target_include_directories(client_clearing PRIVATE clients/cpp)
target_link_libraries(client_clearing PRIVATE nlohmann_json::nlohmann_json)
set_target_properties(client_clearing PROPERTIES CXX_STANDARD 17)
target_compile_options(plugin_other_build PRIVATE -ffast-math)
file(GLOB sources CONFIGURE_DEPENDS tests/*_test.cpp)
set(libraries ${sandlot_layers})
list(REMOVE_ITEM libraries bench)  # a program of its own
list(TRANSFORM libraries PREPEND sandlot_)
list(REVERSE libraries)
sandlot_test_executable(scenario_tests "${sources}" "${libraries}" system)
target_include_directories(scenario_tests PRIVATE clients/cpp)
add_dependencies(scenario_tests sandlot client_clearing selforg_wheels robios6 robios7 robios_host ${plugins})
add_custom_target(program_tests DEPENDS scenario_tests)
sandlot_robios_tests()
# tests/vision: what software written for real cameras makes of our pictures.
if(TARGET sandlot_opencv)
  file(GLOB sources CONFIGURE_DEPENDS tests/vision/*_test.cpp)
  sandlot_test_executable(vision_tests "${sources}" "${libraries};sandlot_opencv" system)
  add_dependencies(program_tests vision_tests)
else()
  message(STATUS "No OpenCV (Debian: libopencv-calib3d-dev, libopencv-video-dev): the tests in tests/vision are left out")
endif()

# Fuzz targets are built by a preset of their own, seldom: `./dev lint --alone` finds them here and looks at their syntax.
file(GLOB sources CONFIGURE_DEPENDS fuzz/*_fuzz.cpp)
add_library(fuzz_targets OBJECT EXCLUDE_FROM_ALL ${sources})
target_include_directories(fuzz_targets PRIVATE src)
target_link_libraries(fuzz_targets PRIVATE sandlot_server sandlot_record sandlot_navigation)

find_package(Python3 COMPONENTS Interpreter REQUIRED)
if(CMAKE_SYSTEM_PROCESSOR STREQUAL "x86_64" AND CMAKE_BUILD_TYPE STREQUAL "Release")
  add_test(NAME fused COMMAND Python3::Interpreter tests/fused_test.py $<TARGET_FILE:sandlot_library> WORKING_DIRECTORY ${CMAKE_SOURCE_DIR})
  set_tests_properties(fused PROPERTIES LABELS system)
endif()
add_test(NAME check_layers COMMAND Python3::Interpreter tools/check_layers.py WORKING_DIRECTORY ${CMAKE_SOURCE_DIR})
file(GLOB sources CONFIGURE_DEPENDS tools/*_test.py)
foreach(source IN LISTS sources)
  get_filename_component(name ${source} NAME_WE)
  add_test(NAME ${name} COMMAND Python3::Interpreter ${source} WORKING_DIRECTORY ${CMAKE_SOURCE_DIR})
  set_tests_properties(${name} PROPERTIES LABELS unit)
endforeach()
set_tests_properties(check_layers PROPERTIES LABELS unit)

# The tutorials, followed to the letter. One of them builds a plugin against what the build installs.
add_test(NAME tutorials COMMAND Python3::Interpreter tests/tutorials_test.py WORKING_DIRECTORY ${CMAKE_SOURCE_DIR})
set_tests_properties(tutorials PROPERTIES LABELS slow TIMEOUT 600
  ENVIRONMENT "SANDLOT_BIN=${CMAKE_BINARY_DIR}/sandlot;${SANDLOT_TEST_ENVIRONMENT}")

# Clients in Python, as docs/clients.md says.
add_test(NAME client_clock COMMAND Python3::Interpreter tests/clock_test.py WORKING_DIRECTORY ${CMAKE_SOURCE_DIR})
set_tests_properties(client_clock PROPERTIES LABELS unit)
add_test(NAME soccer_team COMMAND Python3::Interpreter tests/soccer_team_test.py WORKING_DIRECTORY ${CMAKE_SOURCE_DIR})
set_tests_properties(soccer_team PROPERTIES LABELS unit)
add_test(NAME clients COMMAND Python3::Interpreter tests/clients_test.py WORKING_DIRECTORY ${CMAKE_SOURCE_DIR})
set_tests_properties(clients PROPERTIES LABELS system TIMEOUT 300
  ENVIRONMENT "SANDLOT_BIN=${CMAKE_BINARY_DIR}/sandlot;${SANDLOT_TEST_ENVIRONMENT}")

# Programs that a run starts itself.
add_test(NAME started_programs COMMAND Python3::Interpreter tests/started_programs_test.py WORKING_DIRECTORY ${CMAKE_SOURCE_DIR})
set_tests_properties(started_programs PROPERTIES LABELS system TIMEOUT 300
  ENVIRONMENT "SANDLOT_BIN=${CMAKE_BINARY_DIR}/sandlot;${SANDLOT_TEST_ENVIRONMENT}")

# Matches and tournaments of teams, as people use them.
add_test(NAME match COMMAND Python3::Interpreter tests/match_test.py WORKING_DIRECTORY ${CMAKE_SOURCE_DIR})
set_tests_properties(match PROPERTIES LABELS system TIMEOUT 300
  ENVIRONMENT "SANDLOT_BIN=${CMAKE_BINARY_DIR}/sandlot;${SANDLOT_TEST_ENVIRONMENT}")

# A base station of the middle-size league at the referee box, as docs/referee_box.md says.
add_test(NAME refbox COMMAND Python3::Interpreter tests/refbox_test.py WORKING_DIRECTORY ${CMAKE_SOURCE_DIR})
set_tests_properties(refbox PROPERTIES LABELS system TIMEOUT 300
  ENVIRONMENT "SANDLOT_BIN=${CMAKE_BINARY_DIR}/sandlot;${SANDLOT_TEST_ENVIRONMENT}")

add_test(NAME match_lockstep COMMAND Python3::Interpreter tests/match_lockstep_test.py WORKING_DIRECTORY ${CMAKE_SOURCE_DIR})
set_tests_properties(match_lockstep PROPERTIES LABELS system TIMEOUT 300
  ENVIRONMENT "SANDLOT_BIN=${CMAKE_BINARY_DIR}/sandlot;${SANDLOT_TEST_ENVIRONMENT}")

# RoBIOS programs in examples/robios.
add_test(NAME robios_programs COMMAND Python3::Interpreter tests/robios_programs_test.py WORKING_DIRECTORY ${CMAKE_SOURCE_DIR})
set_tests_properties(robios_programs PROPERTIES LABELS slow TIMEOUT 600
  ENVIRONMENT "SANDLOT_BIN=${CMAKE_BINARY_DIR}/sandlot;${SANDLOT_TEST_ENVIRONMENT}")

# Programs and files for EyeSim as they are found elsewhere.
add_test(NAME robios_wild COMMAND Python3::Interpreter tests/robios_wild_test.py WORKING_DIRECTORY ${CMAKE_SOURCE_DIR})
set_tests_properties(robios_wild PROPERTIES LABELS system TIMEOUT 300
  ENVIRONMENT "SANDLOT_BIN=${CMAKE_BINARY_DIR}/sandlot;${SANDLOT_TEST_ENVIRONMENT}")

# The same law in four places.
add_test(NAME clearing COMMAND Python3::Interpreter tests/clearing_test.py WORKING_DIRECTORY ${CMAKE_SOURCE_DIR})
set_tests_properties(clearing PROPERTIES LABELS slow TIMEOUT 600
  ENVIRONMENT "SANDLOT_BIN=${CMAKE_BINARY_DIR}/sandlot;${SANDLOT_TEST_ENVIRONMENT}")

# What takes longest begins first, also where nothing has been measured yet.
set_tests_properties(robios_programs clients started_programs tutorials PROPERTIES COST 60)

# The page's own tests, and the check of its types, for which nothing has to run.
if(SANDLOT_PAGE)
  add_test(NAME page_types COMMAND ${SANDLOT_NODE} node_modules/typescript/bin/tsc --noEmit
    WORKING_DIRECTORY ${CMAKE_SOURCE_DIR}/web)
  file(GLOB sources CONFIGURE_DEPENDS web/test/*.test.mjs)
  add_test(NAME page_units COMMAND ${SANDLOT_NODE} --test ${sources} WORKING_DIRECTORY ${CMAKE_SOURCE_DIR}/web)
  set_tests_properties(page_types page_units PROPERTIES LABELS system TIMEOUT 120)
endif()

# tests/js/*_test.mjs hold messages and recordings against readers that others wrote. `./dev test` installs those.
if(SANDLOT_NODE AND EXISTS ${CMAKE_SOURCE_DIR}/tests/js/node_modules)
  file(GLOB sources CONFIGURE_DEPENDS tests/js/*_test.mjs)
  foreach(source IN LISTS sources)
    get_filename_component(name ${source} NAME_WE)
    add_test(NAME js_${name} COMMAND ${SANDLOT_NODE} ${source} WORKING_DIRECTORY ${CMAKE_SOURCE_DIR})
    set_tests_properties(js_${name} PROPERTIES LABELS system TIMEOUT 120
      ENVIRONMENT "SANDLOT_BUILD=${CMAKE_BINARY_DIR};SANDLOT_BIN=${CMAKE_BINARY_DIR}/sandlot")
  endforeach()
  # A browser that draws with the processor takes its time; beside other tests it would wait in vain.
  set_tests_properties(js_page_test js_layers_test js_panel_test js_agents_test js_match_page_test PROPERTIES LABELS slow TIMEOUT 600 RUN_SERIAL ON)
else()
  message(STATUS "No node or no tests/js/node_modules (npm ci --prefix tests/js): the tests in tests/js are left out")
endif()
