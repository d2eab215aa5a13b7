# control/border.h: the hash of the headers that controllers are compiled against. A plugin carries the hash it was built
# with and is refused by a simulator with another one, since messages cross the border as C++ objects.
#
# Included by CMakeLists.txt it declares the rule; run by that rule (cmake -P, with OUT and SOURCE) it writes the header.
if(CMAKE_SCRIPT_MODE_FILE)
  cmake_minimum_required(VERSION 3.25)
  set(all "")
  foreach(layer base geometry messages control)
    file(GLOB_RECURSE headers RELATIVE ${SOURCE} ${SOURCE}/${layer}/*.h)
    list(SORT headers)
    foreach(header IN LISTS headers)
      file(SHA256 ${SOURCE}/${header} hash)
      string(APPEND all "${header} ${hash}\n")
    endforeach()
  endforeach()
  string(SHA256 hash "${all}")
  string(SUBSTRING ${hash} 0 16 hash)
  set(text "#pragma once\n/// Made by cmake/border.cmake: the hash of all headers of base, geometry, messages and control.\n")
  file(CONFIGURE OUTPUT ${OUT} CONTENT "${text}#define SANDLOT_BORDER_HASH \"${hash}\"\n")
  return()
endif()

set(SANDLOT_GENERATED ${CMAKE_BINARY_DIR}/generated)
set(border_rule ${CMAKE_COMMAND} -DOUT=${SANDLOT_GENERATED}/control/border.h -DSOURCE=${CMAKE_SOURCE_DIR}/src
  -P ${CMAKE_CURRENT_LIST_FILE})
# At once, for tools that read the code without building it; and whenever a header has changed.
execute_process(COMMAND ${border_rule} COMMAND_ERROR_IS_FATAL ANY)
file(GLOB_RECURSE headers CONFIGURE_DEPENDS src/base/*.h src/geometry/*.h src/messages/*.h src/control/*.h)
add_custom_command(OUTPUT ${SANDLOT_GENERATED}/border.stamp
  BYPRODUCTS ${SANDLOT_GENERATED}/control/border.h  # so that what includes it is built again at once
  COMMAND ${border_rule}
  COMMAND ${CMAKE_COMMAND} -E touch ${SANDLOT_GENERATED}/border.stamp
  DEPENDS ${headers} ${CMAKE_CURRENT_LIST_FILE})
add_custom_target(sandlot_border DEPENDS ${SANDLOT_GENERATED}/border.stamp)
