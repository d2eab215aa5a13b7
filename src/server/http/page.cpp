#include "server/server.h"

// Each file of the page as it is, between two symbols; the list is made by cmake/page.cmake.
#define SANDLOT_PAGE_FILE(number, path, type, hash, file)                                         \
  __asm__(                                                                                        \
      ".pushsection .rodata\n"                                                                    \
      ".hidden sandlot_page_" #number "\n.global sandlot_page_" #number "\nsandlot_page_" #number \
      ":\n.incbin \"" file                                                                        \
      "\"\n"                                                                                      \
      ".hidden sandlot_page_end_" #number "\n.global sandlot_page_end_" #number                   \
      "\nsandlot_page_end_" #number ":\n.byte 0\n.popsection\n");                                 \
  extern "C" const std::byte sandlot_page_##number[], sandlot_page_end_##number[];
#include "server/page_list.h"
#undef SANDLOT_PAGE_FILE

namespace sandlot::server {

std::span<const PageFile> page_files() {
#define SANDLOT_PAGE_FILE(number, path, type, hash, file) \
  PageFile{path, type, {sandlot_page_##number, sandlot_page_end_##number}, hash},
  static const PageFile files[] = {
#include "server/page_list.h"
  };
#undef SANDLOT_PAGE_FILE
  return files;
}

bool has_page() {
  for (const PageFile& file : page_files())
    if (file.path == "/main.js") return true;
  return false;
}

}  // namespace sandlot::server
