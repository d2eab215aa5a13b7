/// robios_host PROGRAM.so [ARGUMENTS]: runs a RoBIOS program that is a shared library. The library robios6 or robios7 that it was
/// linked with is loaded first, so that it stands in front of the C library as in an executable.
#include <dlfcn.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace {

namespace fs = std::filesystem;
constexpr const char* loaded = "SANDLOT_ROBIOS_HOST";  // of the second start

[[noreturn]] void fail(const std::string& sentence) {
  std::fprintf(stderr, "robios_host: %s\n", sentence.c_str());
  std::exit(2);
}

/// Library of the generation that the program is linked with.
fs::path library_of(const std::string& program, const fs::path& own) {
  std::ifstream file(program, std::ios::binary);
  if (!file) fail("cannot read " + program);
  const std::string bytes{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  for (const char* name : {"librobios6.so", "librobios7.so"}) {
    if (bytes.find(name) == std::string::npos) continue;
    for (const char* folder : {"robios", "../lib"}) {  // of the build, of an installation
      const fs::path path = own / folder / name;
      if (fs::exists(path)) return fs::canonical(path);
    }
    fail(std::string(name) + " is neither in robios/ nor in ../lib/ from robios_host");
  }
  fail(program + " is linked with neither -lrobios6 nor -lrobios7");
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) fail("usage: robios_host PROGRAM.so [ARGUMENTS]");
  if (!getenv(loaded)) {
    std::error_code error;
    const fs::path self = fs::read_symlink("/proc/self/exe", error);
    if (error) fail("cannot find itself: /proc is missing");
    const fs::path library = library_of(argv[1], self.parent_path());
    setenv("LD_PRELOAD", library.c_str(), 1);
    setenv(loaded, "1", 1);
    execv(self.c_str(), argv);
    fail("cannot start again");
  }
  unsetenv("LD_PRELOAD");
  unsetenv(loaded);
  void* const program = dlopen(fs::absolute(argv[1]).c_str(), RTLD_NOW | RTLD_GLOBAL);
  if (!program) fail(dlerror());
  const auto entry = reinterpret_cast<int (*)(int, char**)>(dlsym(program, "main"));
  if (!entry) fail(std::string(argv[1]) + " has no function `main`");
  return entry(argc - 1, argv + 1);
}
