#include "base/program.h"

#include <dlfcn.h>

#include <filesystem>

namespace sandlot {

std::vector<std::string> program_files() {
  namespace fs = std::filesystem;
  std::vector<std::string> out;
  std::error_code failed;
  const auto add = [&](const fs::path& file) {
    const fs::path real = fs::canonical(file, failed);
    if (!failed && (out.empty() || out.front() != real)) out.push_back(real.string());
  };
  add("/proc/self/exe");
  Dl_info info{};
  if (dladdr(reinterpret_cast<const void*>(&program_files), &info) != 0 && info.dli_fname)
    add(info.dli_fname);
  return out;
}

std::vector<std::string> folders_above_program() {
  namespace fs = std::filesystem;
  std::vector<std::string> out;
  for (const std::string& program : program_files())
    for (fs::path folder = fs::path(program).parent_path();; folder = folder.parent_path()) {
      out.push_back(folder.string());
      if (folder == folder.root_path()) break;
    }
  return out;
}

}  // namespace sandlot
