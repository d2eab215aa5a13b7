#pragma once
/// File of what a program prints, 16 MB at most. What it prints before the file begins is kept, 64 KB at most: a program has its
/// first turn while its run is being made.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>

#include "base/result.h"

namespace sandlot::programs {

class OutputFile {
 public:
  static constexpr std::size_t most_bytes = 16u << 20, most_early_bytes = 64u << 10;

  /// Begins "red1.controller.log" of the program "red1/controller" in the folder, which is made if need be.
  Status open(const std::string& folder, const std::string& program) {
    std::string name = program + ".log";
    std::replace(name.begin(), name.end(), '/', '.');
    const std::filesystem::path file = std::filesystem::path(folder) / name;
    std::error_code failed;
    std::filesystem::create_directories(folder, failed);
    out_.open(file, std::ios::binary);
    if (out_) {
      out_ << std::exchange(early_, {}) << std::flush;
      return {};
    }
    return Error{"--program-logs: '" + file.string() + "' cannot be written",
                 "name a folder in which you may write"};
  }
  void write(const std::string& line) {
    if (bytes_ >= (out_.is_open() ? most_bytes : most_early_bytes)) return;
    bytes_ += line.size() + 1;
    if (out_.is_open()) out_ << line << '\n' << std::flush;
    else early_ += line + '\n';
  }

 private:
  std::ofstream out_;
  std::string early_;
  std::size_t bytes_ = 0;
};

}  // namespace sandlot::programs
