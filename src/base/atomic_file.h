#pragma once
/// File that appears under its name when it is whole: a full disk, or the end of the process, leaves what was
/// there before.
///
///   AtomicFile file("run.csv");
///   SL_TRY(file.write(text));     // as often as needed
///   return file.commit();         // without it, the destructor discards what was written
///
/// The bytes go to `PATH.part` beside the target, which commit() renames. A link stays a link: the file it
/// leads to is replaced. Pipes and devices such as /dev/stdout are written to directly.
/// Errors   name the path as it was given, and the system's reason.
/// Limits   no fsync: after a power failure the target may be empty. Two writers of one path disturb each
///          other.
#include <fstream>
#include <string>
#include <string_view>

#include "base/result.h"

namespace sandlot {

class AtomicFile {
 public:
  /// Opens the file; when that fails, write() and commit() return the reason.
  explicit AtomicFile(const std::string& path);
  ~AtomicFile() { discard(); }
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  Status write(std::string_view bytes);
  /// Puts the file in place. At most once.
  Status commit();
  /// Removes what was written; the target stays as it was. Nothing after commit().
  void discard();

  /// File that holds the bytes until commit(); the target itself for pipes and devices.
  const std::string& temporary_path() const { return temporary_; }

 private:
  Status failed();

  std::string path_;       ///< as given
  std::string target_;     ///< links followed
  std::string temporary_;  ///< equal to `target_` for pipes and devices
  std::ofstream out_;
  bool open_ = true;  ///< neither committed nor discarded
  int open_error_ = 0;
};

/// Writes a whole file atomically.
Status write_file(const std::string& path, std::string_view content);

}  // namespace sandlot
