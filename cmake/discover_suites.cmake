# Included by ctest when it begins: each suite of a test program is a test, whose tests run in one process. A process per test would
# cost more than most of the tests themselves. The file that includes this sets, for one program:
#   program, folder      what to run, and where
#   label                of suites that are neither slow nor long
#   environment, timeout
execute_process(COMMAND ${program} --gtest_list_tests WORKING_DIRECTORY ${folder} OUTPUT_VARIABLE listed RESULT_VARIABLE failed)
if(failed)
  add_test("${program}" "${program}" --gtest_list_tests)  # not built, or it does not start: an error of its own
  return()
endif()
string(REGEX REPLACE "[^\n]*Running main[^\n]*\n" "" listed "${listed}")
string(REGEX REPLACE "  #[^\n]*" "" listed "${listed}")  # values of parameters, which may hold anything
string(REPLACE "\n" ";" lines "${listed}")

set(suite "")
set(count 0)
macro(add_suite)
  if(suite AND count)
    set(of ${label})
    set(patience ${timeout})
    if(suite MATCHES "(^|/)Slow")
      set(of slow)
      set(patience 1200)
    elseif(suite MATCHES "(^|/)Long")
      set(of long)
      set(patience 3600)
    endif()
    get_filename_component(test ${program} NAME)
    string(APPEND test "/${suite}")  # two programs may have suites of one name
    add_test("${test}" "${program}" "--gtest_filter=${suite}.*" --gtest_brief=1)
    # What has many tests begins first where nothing has been measured yet.
    set_tests_properties("${test}" PROPERTIES LABELS ${of} TIMEOUT ${patience} COST ${count}
      WORKING_DIRECTORY "${folder}" ENVIRONMENT "${environment}")
  endif()
  set(count 0)
endmacro()
foreach(line IN LISTS lines)
  if(line MATCHES "^ ")
    if(NOT line MATCHES "DISABLED_")
      math(EXPR count "${count} + 1")
    endif()
  elseif(line MATCHES "^([^ ]+)\\.$")
    set(next "${CMAKE_MATCH_1}")
    add_suite()
    set(suite "${next}")
  endif()
endforeach()
add_suite()
