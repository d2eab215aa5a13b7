#pragma once
/// Files as recordings need them: written in whole pieces, read at any offset, never by two writers.
///
/// Errors   name the file and the system's reason.
#include <chrono>
#include <cstdint>
#include <span>
#include <string>

#include "base/result.h"

namespace sandlot::mcap {

/// Replaces what is at `path`. While it is open nobody else opens it for writing or repair.
class OutputFile {
 public:
  static Result<OutputFile> create(const std::string& path);
  OutputFile(OutputFile&& other) noexcept;
  OutputFile& operator=(OutputFile&&) = delete;
  ~OutputFile();

  /// Hands all bytes to the kernel, with one call if the kernel takes them. A pipe that takes nothing for
  /// `patience` is an error; a disk is waited for as long as it takes.
  Status write(std::span<const std::byte> bytes);
  /// Ends the file after `size` bytes; further writes go there.
  Status cut(std::uint64_t size);
  Status sync();
  Status close();
  const std::string& path() const { return path_; }

  std::chrono::milliseconds patience{10'000};

 private:
  OutputFile(int fd, std::string path) : fd_(fd), path_(std::move(path)) {}
  int fd_;
  std::string path_;
};

class InputFile {
 public:
  static Result<InputFile> open(const std::string& path);
  InputFile(InputFile&& other) noexcept;
  InputFile& operator=(InputFile&&) = delete;
  ~InputFile();

  std::uint64_t size() const { return size_; }
  /// Fills `bytes` from `offset`; an error when the file ends before.
  Status read(std::uint64_t offset, std::span<std::byte> bytes) const;
  /// False while an OutputFile, of any process, writes to it.
  bool at_rest() const;
  const std::string& path() const { return *path_; }
  /// "damaged at byte N: what" with the file's name.
  Error damaged(std::uint64_t offset, const std::string& what) const;

 private:
  InputFile(int fd, std::uint64_t size, const std::string& path);
  int fd_;
  std::uint64_t size_;
  std::shared_ptr<const std::string> path_;
};

/// For a thread that writes: a broken pipe or a limit on file sizes becomes an error of write() instead of the end
/// of the process, and interrupts go to the other threads.
void block_signals();

}  // namespace sandlot::mcap
