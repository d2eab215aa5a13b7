# The page: web/ is bundled by node into build/PRESET/page and its files become part of the program (src/server/http/page.cpp).
# Without node or the packages that `./dev` installs into web/node_modules, the page says how to get it instead.
#
# Included by CMakeLists.txt this declares the rule; run by that rule (cmake -P, with FOLDER and OUT) it writes the list
# of files, with the hash of each, that page.cpp reads: so whatever changes in a file compiles page.cpp again.
if(CMAKE_SCRIPT_MODE_FILE)
  cmake_minimum_required(VERSION 3.25)
  set(types html text/html js text/javascript css text/css txt text/plain json application/json svg image/svg+xml
    png image/png jpg image/jpeg ico image/x-icon woff2 font/woff2 wasm application/wasm)
  file(GLOB_RECURSE files RELATIVE ${FOLDER} ${FOLDER}/*)
  list(SORT files)
  set(lines "")
  set(number 0)
  foreach(file IN LISTS files)
    cmake_path(GET file EXTENSION LAST_ONLY extension)
    string(REGEX REPLACE "^\\." "" extension "${extension}")
    list(FIND types "${extension}" at)
    if(at LESS 0)
      message(FATAL_ERROR "page.cmake: what is the media type of '${file}'? Add it to the list")
    endif()
    math(EXPR at "${at} + 1")
    list(GET types ${at} type)
    if(type MATCHES "^text/")
      string(APPEND type "; charset=utf-8")
    endif()
    file(SHA256 ${FOLDER}/${file} hash)
    string(SUBSTRING ${hash} 0 16 hash)
    set(path "/${file}")
    if(path STREQUAL "/index.html")
      set(path "/")
    endif()
    string(APPEND lines "SANDLOT_PAGE_FILE(${number}, \"${path}\", \"${type}\", \"${hash}\", \"${FOLDER}/${file}\")\n")
    math(EXPR number "${number} + 1")
  endforeach()
  # No #pragma once: it is read several times, with another SANDLOT_PAGE_FILE each.
  file(CONFIGURE OUTPUT ${OUT} CONTENT "// Made by cmake/page.cmake: number, path, type, hash, file.\n${lines}")
  return()
endif()

set(list_of_files ${SANDLOT_GENERATED}/server/page_list.h)
set(no_page ${CMAKE_SOURCE_DIR}/cmake/no_page)
find_program(SANDLOT_NODE node)
set(SANDLOT_PAGE OFF)
if(SANDLOT_NODE AND EXISTS ${CMAKE_SOURCE_DIR}/web/src/main.ts AND EXISTS ${CMAKE_SOURCE_DIR}/web/node_modules/.installed)
  execute_process(COMMAND ${SANDLOT_NODE} --version OUTPUT_VARIABLE version OUTPUT_STRIP_TRAILING_WHITESPACE)
  if(version MATCHES "^v(1[89]|[2-9][0-9])\\.")
    set(SANDLOT_PAGE ON)
  endif()
endif()
if(SANDLOT_PAGE)
  set(page ${CMAKE_BINARY_DIR}/page)
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS web/src/*)
  list(APPEND sources ${CMAKE_SOURCE_DIR}/web/build.mjs ${CMAKE_SOURCE_DIR}/web/tsconfig.json
    ${CMAKE_SOURCE_DIR}/web/node_modules/.installed)
  set(bundle COMMAND ${CMAKE_COMMAND} -E rm -rf ${page}
    COMMAND ${SANDLOT_NODE} ${CMAKE_SOURCE_DIR}/web/build.mjs --out ${page})
else()
  message(STATUS "No node 18 or no web/node_modules (./dev build installs both): the program has no page")
  set(page ${no_page})
  set(bundle "")
  file(GLOB sources ${no_page}/*)
endif()
# At once, for tools that read the code without building it.
if(NOT EXISTS ${list_of_files})
  execute_process(COMMAND ${CMAKE_COMMAND} -DFOLDER=${no_page} -DOUT=${list_of_files} -P ${CMAKE_CURRENT_LIST_FILE}
    COMMAND_ERROR_IS_FATAL ANY)
endif()
set(stamp ${SANDLOT_GENERATED}/page.stamp)
add_custom_command(OUTPUT ${stamp} BYPRODUCTS ${list_of_files}
  ${bundle}
  COMMAND ${CMAKE_COMMAND} -DFOLDER=${page} -DOUT=${list_of_files} -P ${CMAKE_CURRENT_LIST_FILE}
  COMMAND ${CMAKE_COMMAND} -E touch ${stamp}
  DEPENDS ${sources} ${CMAKE_CURRENT_LIST_FILE}
  COMMENT "The page" VERBATIM)
add_custom_target(sandlot_page DEPENDS ${stamp})
add_dependencies(sandlot_server sandlot_page)
target_include_directories(sandlot_server PRIVATE ${SANDLOT_GENERATED})
