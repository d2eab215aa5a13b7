#pragma once
/// RoBIOS programs as processes: what `program:` names, compiled if it is C or C++, with what it needs beside it.
///
/// Compiler  the system's cc, or c++; within the sandbox of the program and as its user, so that a program can include no more
///           than it could read. C is that of 2017 with what older programs need: functions without prototypes, common
///           variables.
/// Cache     $XDG_CACHE_HOME/sandlot/robios or ~/.cache/sandlot/robios (of root, if `nobody` cannot read there,
///           /var/cache/sandlot/robios): by the source, what it includes, flags, headers and compiler.
/// Library   robios6 or robios7: beside the build, or in lib and include of the installation.
/// Errors    no such file, no compiler, no library; what the compiler wrote, by the source's own lines.
#include <string>
#include <vector>

#include "base/result.h"
#include "programs/sandbox.h"

namespace sandlot::programs::robios {

struct Source {
  std::string program;  ///< a file relative to `folder`, or a whole path
  std::string folder;
  int api = 0;  ///< 6 or 7; 0: by the text of the program
  std::vector<std::string> flags;
  std::string output;  ///< folder for files that it writes; "": they go with its process
  Budget budget;
};

/// 6 if a text includes or uses what RoBIOS 6 alone has, else 7.
int api_of(std::string_view text);

/// Command, folder, budget and environment of the program's process; the caller adds what it inherits.
Result<ProgramLaunch> prepare(const Source& source);

}  // namespace sandlot::programs::robios
