#include "base/atomic_file.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <utility>

namespace sandlot {

AtomicFile::AtomicFile(const std::string& path) : path_(path) {
  namespace fs = std::filesystem;
  std::error_code code;
  const fs::path real = fs::canonical(path, code);
  target_ = code ? path : real.string();
  // A rename would put a plain file in the place of a pipe or device.
  const fs::file_type type = fs::status(target_, code).type();
  const bool replaceable = type == fs::file_type::not_found || type == fs::file_type::regular;
  temporary_ = replaceable ? target_ + ".part" : target_;
  out_.open(temporary_, std::ios::binary | std::ios::trunc);
  if (!out_) open_error_ = errno ? errno : EIO;
}

Status AtomicFile::failed() {
  const std::string reason = std::strerror(open_error_ ? open_error_ : errno);
  discard();
  return Error{"cannot write '" + path_ + "': " + reason};
}

Status AtomicFile::write(std::string_view bytes) {
  if (!open_error_) out_.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  return out_ ? Status() : failed();
}

Status AtomicFile::commit() {
  if (open_error_) return failed();
  out_.close();
  if (!out_ || (temporary_ != target_ && std::rename(temporary_.c_str(), target_.c_str()) != 0))
    return failed();
  open_ = false;
  return {};
}

void AtomicFile::discard() {
  if (!std::exchange(open_, false)) return;
  out_.close();
  // What could not be opened is not ours to remove.
  if (temporary_ != target_ && !open_error_) std::remove(temporary_.c_str());
}

Status write_file(const std::string& path, std::string_view content) {
  AtomicFile file(path);
  SL_TRY(file.write(content));
  return file.commit();
}

}  // namespace sandlot
