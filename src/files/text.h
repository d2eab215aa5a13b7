#pragma once
/// Text files as the readers take them: bounded in size, valid UTF-8, nothing hidden in them.
#include <memory>
#include <string>
#include <string_view>

#include "base/result.h"

namespace sandlot {

/// Reads a whole file.
/// Errors   missing, a directory or another thing that is not a regular file, unreadable, over the limit: each its own,
///          and each answered before anything is read.
Result<std::string> read_text_file(const std::string& path, std::size_t max_bytes);

/// Refuses bytes that no text has (NUL, control characters, invalid UTF-8), with the line of the first one.
Status check_text(std::string_view text, const std::string& file);

/// Remedy for a file that does not exist: the nearest name in its folder, or the folder that does not exist; "" when no
/// name is near.
std::string nearest_file(const std::string& path);

/// The folder of a file: "worlds" for "worlds/indoor.sdf", "" for "indoor.sdf".
std::string folder_of(std::string_view path);
/// `path` as seen from `folder`; absolute paths stay what they are.
std::string beside(const std::string& folder, const std::string& path);
/// The same text for all spellings of a path (links resolved, no `..`), to recognise a file that includes itself.
std::string canonical_path(const std::string& path);

inline Place place_in(std::shared_ptr<const std::string> file, int line = 0, int column = 0) {
  return {std::move(file), line, column};
}
inline Place place_in(const std::string& file, int line = 0, int column = 0) {
  return {std::make_shared<const std::string>(file), line, column};
}

}  // namespace sandlot
