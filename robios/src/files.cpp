/// Files that a program writes. The sandbox shows the program's folder read-only, but programs keep logs, curves and pictures beside
/// themselves, and many do not look whether the file could be opened. What cannot be written in its place goes into the folder of
/// SANDLOT_ROBIOS_FILES, under the same name, and is found there again.
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <string_view>

#include "interpose.h"

namespace robios {
namespace {

constexpr mode_t usual_mode = 0666, folder_mode = 0777;

template <class F>
F real(const char* name) {
  return reinterpret_cast<F>(dlsym(RTLD_NEXT, name));
}
using Open = int (*)(const char*, int, ...);
using OpenStream = FILE* (*)(const char*, const char*);
using OfPath = int (*)(const char*);

/// Where a file of the name is written instead; empty: nowhere.
std::string elsewhere(const char* name) {
  const char* const folder = std::getenv("SANDLOT_ROBIOS_FILES");
  if (!folder || !*folder || !name || !*name) return {};
  for (const char* const own : {"/dev/", "/proc/", "/sys/", "/tmp/", "/run/"})
    if (std::strncmp(name, own, std::strlen(own)) == 0) return {};
  std::string out = folder;
  for (std::string_view rest = name; !rest.empty();) {
    const std::size_t end = std::min(rest.find('/'), rest.size());
    const std::string_view part = rest.substr(0, end);
    if (!part.empty() && part != "." && part != "..") out.append("/").append(part);
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  return out;
}

bool is_there(const std::string& file) {
  struct stat info {};
  return !file.empty() && ::stat(file.c_str(), &info) == 0 && S_ISREG(info.st_mode);
}

/// Makes room for the file; what there is of it in its first place is kept, unless it is written from the start.
void prepare(const char* name, const std::string& file, bool from_start) {
  for (std::size_t at = file.find('/', 1); at != std::string::npos; at = file.find('/', at + 1))
    ::mkdir(file.substr(0, at).c_str(), folder_mode);
  if (from_start) return;
  const Open open_real = real<Open>("open");
  const int from = open_real(name, O_RDONLY | O_CLOEXEC);
  if (from < 0) return;
  if (const int to = open_real(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, usual_mode); to >= 0) {
    char bytes[4096];
    for (ssize_t n = 0; (n = ::read(from, bytes, sizeof bytes)) > 0;)
      if (::write(to, bytes, static_cast<std::size_t>(n)) != n) break;
    ::close(to);
  }
  ::close(from);
}

bool cannot_write() { return errno == EROFS || errno == EACCES || errno == EPERM || errno == ENOENT; }

int open_file(const char* function, const char* name, int flags, mode_t mode) {
  const Open open_real = real<Open>(function);
  const bool writes = (flags & O_ACCMODE) != O_RDONLY;
  const int before = errno;
  const std::string file = elsewhere(name);
  if (is_there(file)) return open_real(file.c_str(), flags, mode);
  errno = before;
  const int out = open_real(name, flags, mode);
  if (out >= 0 || !writes || file.empty() || !cannot_write()) return out;
  if (errno == ENOENT && (flags & O_CREAT) == 0) return out;
  const int why = errno;
  prepare(name, file, (flags & O_TRUNC) != 0);
  const int instead = open_real(file.c_str(), flags, mode);
  errno = instead < 0 ? why : before;
  return instead;
}

FILE* open_stream(const char* function, const char* name, const char* mode) {
  const OpenStream open_real = real<OpenStream>(function);
  const bool writes = mode && (*mode == 'w' || *mode == 'a' || std::strchr(mode, '+'));
  const int before = errno;
  const std::string file = elsewhere(name);
  if (is_there(file)) return open_real(file.c_str(), mode);
  errno = before;
  FILE* const out = open_real(name, mode);
  if (out || !writes || file.empty() || !cannot_write()) return out;
  if (errno == ENOENT && *mode == 'r') return out;
  const int why = errno;
  prepare(name, file, *mode == 'w');
  FILE* const instead = open_real(file.c_str(), mode);
  errno = instead ? before : why;
  return instead;
}

int remove_file(const char* function, const char* name) {
  const std::string file = elsewhere(name);
  return real<OfPath>(function)(is_there(file) ? file.c_str() : name);
}

}  // namespace
}  // namespace robios

using namespace robios;

// The C library reads a mode where the flags ask for one alone; passing it always is the same call.
ROBIOS_INTERPOSE(int, open, const char* name, int flags, mode_t mode) {
  return open_file("open", name, flags, mode);
}
ROBIOS_INTERPOSE(int, open64, const char* name, int flags, mode_t mode) {
  return open_file("open64", name, flags, mode);
}
ROBIOS_INTERPOSE(int, creat, const char* name, mode_t mode) {
  return open_file("open", name, O_CREAT | O_WRONLY | O_TRUNC, mode);
}
ROBIOS_INTERPOSE(FILE*, fopen, const char* name, const char* mode) {
  return open_stream("fopen", name, mode);
}
ROBIOS_INTERPOSE(FILE*, fopen64, const char* name, const char* mode) {
  return open_stream("fopen64", name, mode);
}
ROBIOS_INTERPOSE(int, remove, const char* name) { return remove_file("remove", name); }
ROBIOS_INTERPOSE(int, unlink, const char* name) { return remove_file("unlink", name); }

// Old programs are linked with X11, and call this before their first thread.
ROBIOS_INTERPOSE(int, XInitThreads) { return 1; }
