#pragma once
/// Names of files as EyeSim's own files have them: with \ and drive letters of Windows, in other letters than the file has, absolute on the
/// machine of their author, or below %sim%, the folder of EyeSim.
#include <string>

#include "files/resources.h"

namespace sandlot::formats::eyesim {

/// The name with / between its parts.
std::string path_of(const std::string& written);

/// The file that a file in `folder` means by a name: as it is written; else the longest end of the name that is there, beside that
/// file or, with a folder in it, in up to three folders above and in those of the search path. Large and small letters count only
/// where two names differ in nothing else.
/// @return an absolute path; path_of(written) when the name is right as it stands, or when nothing is there
std::string located(const std::string& written, const std::string& folder, const SearchPath& path);

/// As located(), for a program: where a compiled one (.x, .exe, .dll) is not there, its source beside it.
std::string located_program(const std::string& written, const std::string& folder, const SearchPath& path);

}  // namespace sandlot::formats::eyesim
