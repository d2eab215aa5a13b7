#include "record/mcap/file.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "files/text.h"

namespace sandlot::mcap {
namespace {

Error failed(const char* what, const std::string& path, const std::string& fix = "") {
  return Error{std::string(what) + " '" + path + "': " + std::strerror(errno), fix};
}

}  // namespace

Result<OutputFile> OutputFile::create(const std::string& path) {
  // Not blocking: a pipe without a reader is an error at once, and a full one can be waited for with a limit.
  const int fd = ::open(path.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC | O_NONBLOCK, 0666);
  if (fd < 0) return failed("cannot write", path, errno == ENXIO ? "it is a pipe that nobody reads" : "");
  OutputFile file(fd, path);
  if (::flock(fd, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK)
    return Error{"cannot write '" + path + "': another program is writing it", "choose another name"};
  struct stat info {};
  if (::fstat(fd, &info) != 0 || (S_ISREG(info.st_mode) && ::ftruncate(fd, 0) != 0))
    return failed("cannot write", path);
  return file;
}

OutputFile::OutputFile(OutputFile&& other) noexcept
    : patience(other.patience), fd_(std::exchange(other.fd_, -1)), path_(std::move(other.path_)) {}

OutputFile::~OutputFile() {
  if (fd_ >= 0) ::close(fd_);
}

Status OutputFile::write(std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t n = ::write(fd_, bytes.data(), bytes.size());
    if (n > 0) {
      bytes = bytes.subspan(static_cast<std::size_t>(n));
    } else if (n < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) {
      pollfd ready{fd_, POLLOUT, 0};
      if (::poll(&ready, 1, static_cast<int>(patience.count())) == 0)
        return Error{"cannot write '" + path_ + "': it took no data for " +
                     std::to_string(patience.count() / 1000) + " s"};
    } else if (n == 0 || errno != EINTR) {
      return failed("cannot write", path_);
    }
  }
  return {};
}

Status OutputFile::cut(std::uint64_t size) {
  if (::ftruncate(fd_, static_cast<off_t>(size)) != 0 || ::lseek(fd_, static_cast<off_t>(size), SEEK_SET) < 0)
    return failed("cannot write", path_);
  return {};
}

Status OutputFile::sync() {
  if (::fsync(fd_) != 0 && errno != EINVAL && errno != EROFS) return failed("cannot write", path_);
  return {};
}

Status OutputFile::close() {
  const int fd = std::exchange(fd_, -1);
  if (fd >= 0 && ::close(fd) != 0) return failed("cannot write", path_);
  return {};
}

Result<InputFile> InputFile::open(const std::string& path) {
  const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (fd < 0) {
    const bool missing = errno == ENOENT;
    Error error = failed("cannot read", path);
    if (missing) error.fix = nearest_file(path);
    return error;
  }
  InputFile file(fd, 0, path);
  struct stat info {};
  if (::fstat(fd, &info) != 0) return failed("cannot read", path);
  if (!S_ISREG(info.st_mode)) return Error{"cannot read '" + path + "': it is not an ordinary file"};
  file.size_ = static_cast<std::uint64_t>(info.st_size);
  return file;
}

InputFile::InputFile(int fd, std::uint64_t size, const std::string& path)
    : fd_(fd), size_(size), path_(std::make_shared<const std::string>(path)) {}

InputFile::InputFile(InputFile&& other) noexcept
    : fd_(std::exchange(other.fd_, -1)), size_(other.size_), path_(std::move(other.path_)) {}

InputFile::~InputFile() {
  if (fd_ >= 0) ::close(fd_);
}

Status InputFile::read(std::uint64_t offset, std::span<std::byte> bytes) const {
  if (offset > size_ || bytes.size() > size_ - offset) return damaged(size_, "the file ends too early");
  while (!bytes.empty()) {
    const ssize_t n = ::pread(fd_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return failed("cannot read", *path_);
    if (n == 0) return damaged(offset, "the file became shorter while it was read");
    bytes = bytes.subspan(static_cast<std::size_t>(n));
    offset += static_cast<std::uint64_t>(n);
  }
  return {};
}

bool InputFile::at_rest() const {
  if (::flock(fd_, LOCK_SH | LOCK_NB) != 0) return errno != EWOULDBLOCK;
  ::flock(fd_, LOCK_UN);
  return true;
}

Error InputFile::damaged(std::uint64_t offset, const std::string& what) const {
  return Error{"damaged at byte " + std::to_string(offset) + ": " + what, "", Place{path_, 0, 0}};
}

void block_signals() {
  sigset_t all;
  sigfillset(&all);
  // Faults of our own must still be reported where they happen.
  for (const int fault : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGTRAP}) sigdelset(&all, fault);
  pthread_sigmask(SIG_BLOCK, &all, nullptr);
}

}  // namespace sandlot::mcap
