#pragma once
/// Location of this program on disk, from which data, models and plugins are found.
#include <string>
#include <vector>

namespace sandlot {

/// Absolute paths of the program and, where that is another file, of the library that this code was linked
/// into; links resolved. A program of a user's own finds Sandlot's data by the second.
std::vector<std::string> program_files();

/// Folders above program_files(), the nearest first: data lies in one of them, or below its share/sandlot.
std::vector<std::string> folders_above_program();

}  // namespace sandlot
