#include "programs/robios/compile.h"

#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <utility>

#include "base/hash.h"
#include "base/program.h"
#include "base/text.h"

namespace sandlot::programs::robios {
namespace {

namespace fs = std::filesystem;

constexpr int compile_wall_s = 60;
constexpr std::size_t most_lines = 30;
constexpr const char* team_folder = "/team/";          // as sandbox.h shows the folder
constexpr const char* temporary_files = "/tmp/files";  // gone with the process
constexpr const char* output_inside = "/run/sandlot";  // and the folder that can be written

std::string contents(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::string without(std::string text, std::string_view part) {
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at))
    text.erase(at, part.size());
  return text;
}

std::string hex(std::uint64_t value) {
  std::string out;
  for (int shift = 60; shift >= 0; shift -= 4) out += "0123456789abcdef"[value >> shift & 15];
  return out;
}

enum class Language { none, c, cpp };

Language language_of(const fs::path& file) {
  const std::string end = file.extension().string();
  if (end == ".c") return Language::c;
  return end == ".cpp" || end == ".cc" || end == ".cxx" || end == ".C" ? Language::cpp : Language::none;
}

struct Library {
  std::string folder;   ///< of librobios7.so
  std::string headers;  ///< of eyebot.h
  std::string host;     ///< the file that runs programs that are libraries
  std::string python;   ///< of eye.py
};

/// Empty where there is none.
Library find_library(int api) {
  const std::string generation = "robios" + std::to_string(api);
  Library out;
  std::error_code none;
  for (const std::string& each : folders_above_program()) {
    const fs::path above = each;
    for (const fs::path& at : {above / "robios", above / "lib"})
      if (out.folder.empty() && fs::exists(at / ("lib" + generation + ".so"), none)) out.folder = at.string();
    for (const fs::path& at : {above / "robios" / "include" / generation, above / "include" / generation})
      if (out.headers.empty() && fs::exists(at / "eyebot.h", none)) out.headers = at.string();
    for (const fs::path& at : {above / "robios_host", above / "bin" / "robios_host"})
      if (out.host.empty() && fs::exists(at, none)) out.host = at.string();
    for (const fs::path& at : {above / "robios" / "python", above / "lib" / "robios"})
      if (out.python.empty() && fs::exists(at / "eye.py", none)) out.python = at.string();
  }
  return out;
}

Result<fs::path> cache_folder() {
  const char* const given = std::getenv("XDG_CACHE_HOME");
  const char* const home = std::getenv("HOME");
  fs::path folder = given && *given == '/' ? fs::path(given)
                    : home && *home        ? fs::path(home) / ".cache"
                                           : fs::path("/var/tmp/sandlot-" + std::to_string(getuid()));
  std::error_code failed;
  const auto make = [&](const fs::path& at) {
    fs::create_directories(at, failed);
    struct stat info {};
    return !failed && ::stat(at.c_str(), &info) == 0 && info.st_uid == geteuid() && (info.st_mode & 022) == 0;
  };
  folder = folder / "sandlot" / "robios";
  bool made = make(folder);
  if (const auto user = program_user(); user && (!made || !can_read(*user, folder.string()))) {
    folder = "/var/cache/sandlot/robios";
    made = make(folder);
  }
  // As the sandbox compares it, and shows it.
  if (made) return fs::canonical(folder, failed);
  return Error{"cannot keep compiled programs in '" + folder.string() + "'",
               "let XDG_CACHE_HOME name a folder that is yours and that you alone can write"};
}

/// Texts that a compiled program depends on, whole.
std::string key_of(const Source& source, const std::string& text, const Library& library,
                   const std::string& compiler) {
  std::string key = compiler + "\n";
  std::error_code none;
  key += std::to_string(fs::last_write_time(compiler, none).time_since_epoch().count()) + "\n";
  for (const std::string& each : source.flags) key += each + "\n";
  std::vector<fs::path> headers;
  for (const auto& each : fs::directory_iterator(library.headers, none)) headers.push_back(each.path());
  std::sort(headers.begin(), headers.end());
  for (const fs::path& each : headers) key += each.string() + " " + hex(hash64(contents(each))) + "\n";
  return key + source.folder + "\n" + source.program + "\n" + text;
}

/// What a rule of make depends on, with paths of the sandbox translated.
std::vector<std::string> dependencies(std::string rule, const std::string& folder) {
  std::vector<std::string> out;
  std::string word;
  rule += ' ';
  for (std::size_t i = 0; i < rule.size(); ++i) {
    if (rule[i] == '\\' && i + 1 < rule.size()) {
      if (rule[++i] == ' ') word += ' ';
    } else if (rule[i] == ' ' || rule[i] == '\n') {
      if (!word.empty() && word.back() != ':') {
        if (word.rfind(team_folder, 0) == 0) word = folder + "/" + word.substr(6);
        out.push_back(word.front() == '/' ? word : folder + "/" + word);
      }
      word.clear();
    } else {
      word += rule[i];
    }
  }
  return out;
}

/// Files that a source includes by their names in quotation marks, and that those include; where they are there.
std::vector<fs::path> included_by(const fs::path& source) {
  constexpr std::size_t most_files = 200, most_bytes = std::size_t{1} << 20;
  std::vector<fs::path> out{source};
  std::error_code failed;
  for (std::size_t i = 0; i < out.size() && out.size() < most_files; ++i) {
    if (fs::file_size(out[i], failed) > most_bytes || failed) continue;
    const std::string text = contents(out[i]);
    for (std::string_view line : split(text, '\n')) {
      line = trim(line);
      if (!starts_with(line, "#")) continue;
      line = trim(line.substr(1));
      const std::size_t open = line.find('"');
      if (!starts_with(line, "include") || open == std::string_view::npos) continue;
      const std::size_t close = line.find('"', open + 1);
      if (close == std::string_view::npos) continue;
      const fs::path named = out[i].parent_path() / line.substr(open + 1, close - open - 1);
      if (!fs::is_regular_file(named, failed)) continue;
      const fs::path file = fs::canonical(named, failed);
      if (!failed && std::find(out.begin(), out.end(), file) == out.end()) out.push_back(file);
    }
  }
  out.erase(out.begin());
  return out;
}

/// Lets the compiler see files above the program's folder that it includes, up to three folders up.
void show_above(const std::vector<fs::path>& files, ProgramLaunch& compiler) {
  constexpr int most_above = 3;
  const fs::path folder = compiler.folder;
  fs::path top = folder;
  for (int i = 0; i < most_above && top.has_relative_path(); ++i) {
    top = top.parent_path();
    for (const fs::path& each : files)
      if (each.lexically_relative(top).native().rfind("..", 0) != 0 &&
          each.lexically_relative(folder).native().rfind("..", 0) == 0 && top.has_relative_path()) {
        const std::string below = folder.lexically_relative(top).string();
        if (below.size() > compiler.below.size()) compiler.below = below;
        if (std::find(compiler.read_files.begin(), compiler.read_files.end(), each.string()) ==
            compiler.read_files.end())
          compiler.read_files.push_back(each.string());
      }
  }
}

/// Whether the kept program was made of the same texts.
bool is_current(const fs::path& kept, const std::string& key) {
  if (contents(kept / "key") != key) return false;
  const std::string all = contents(kept / "includes");
  for (const std::string_view line : split(all, '\n')) {
    const std::size_t space = line.find(' ');
    if (space == std::string_view::npos) continue;
    if (hex(hash64(contents(std::string(line.substr(space + 1))))) != line.substr(0, space)) return false;
  }
  return access((kept / "program").c_str(), X_OK) == 0;
}

/// Runs the compiler. @return its output, if it failed
Result<std::string> run_compiler(const ProgramLaunch& program) {
  SL_ASSIGN(const Launch launch, launch_of(program));
  SL_ASSIGN(Child child, Child::start(launch));
  using Clock = std::chrono::steady_clock;
  const auto end = Clock::now() +
                   std::chrono::seconds(compile_wall_s);  // lint-ok: the wait for a process, not the run
  std::string output;
  std::size_t lines = 0;
  while (Clock::now() < end) {  // lint-ok: see above
    child.move();
    const auto take = [&](const std::string& line) {
      if (++lines <= most_lines) output += "\n  " + without(line, team_folder);
    };
    while (auto line = child.take_line()) take(*line);
    while (auto note = child.take_note()) take(*note);
    if (const auto status = child.exit_status(); status && child.output() < 0 && child.error() < 0) {
      if (lines > most_lines) output += "\n  (" + std::to_string(lines - most_lines) + " more lines)";
      if (*status == 0) return std::string();
      return output.empty() ? "\n  the compiler " + text_of_exit(*status) : output;
    }
    pollfd either[2] = {{child.output(), POLLIN, 0}, {child.error(), POLLIN, 0}};
    poll(either, 2, 10);
  }
  return "\n  the compiler does not end within " + std::to_string(compile_wall_s) + " s";
}

/// @return folder of the compiled `program`
Result<fs::path> compile(const Source& source, const fs::path& file, const std::string& shown,
                         const Library& library, int api, ProgramLaunch program) {
  const bool is_c = language_of(file) == Language::c;
  const char* const name = is_c ? "cc" : "c++";
  const char* const path = std::getenv("PATH");
  const std::string compiler = find_program(name, "", path ? path : "/usr/local/bin:/usr/bin:/bin");
  if (compiler.empty())
    return Error{std::string("there is no ") + (is_c ? "C" : "C++") + " compiler (" + name +
                     ") to compile '" + source.program + "'",
                 std::string("install one (apt install ") + (is_c ? "gcc" : "g++") +
                     "), or name a program that is compiled already"};
  SL_ASSIGN(const fs::path cache, cache_folder());
  const std::string text = contents(file);
  const std::string key = key_of(source, text, library, compiler);
  const fs::path kept = cache / hex(hash64(key));
  if (is_current(kept, key)) return kept;

  SL_ASSIGN(PrivateFolder made, PrivateFolder::make(program_user()));
  const std::string out = program.budget.sandbox ? output_inside : made.path();
  program.socket_folder = made.path();
  program.budget.memory_bytes = std::max(program.budget.memory_bytes, 2e9);
  program.command = {name, "-O2", "-g", "-w", "-pthread"};
  const auto add = [&](std::initializer_list<std::string> words) {
    program.command.insert(program.command.end(), words.begin(), words.end());
  };
  if (is_c)
    add({"-std=gnu17", "-fcommon", "-Wno-implicit-function-declaration", "-Wno-implicit-int",
         "-Wno-int-conversion", "-Wno-incompatible-pointer-types", "-Wno-return-type", "-fpermissive"});
  else add({"-std=gnu++20"});
  add({"-I" + library.headers, "-MMD", "-MF", out + "/includes", "-o", out + "/program", shown});
  program.command.insert(program.command.end(), source.flags.begin(), source.flags.end());
  add({"-L" + library.folder, "-Wl,--no-as-needed", "-lrobios" + std::to_string(api), "-lm"});
  SL_ASSIGN(const std::string failure, run_compiler(program));
  if (!failure.empty()) return Error{"'" + source.program + "' does not compile:" + failure};

  // Beside its name first, so that it is there whole or not at all.
  const fs::path part = cache / (hex(hash64(key)) + "." + std::to_string(getpid()));
  std::error_code failed;
  fs::remove_all(part, failed);
  fs::create_directory(part, failed);
  if (!failed) fs::copy_file(fs::path(made.path()) / "program", part / "program", failed);
  if (!failed) fs::permissions(part / "program", fs::perms(0755), failed);
  std::ofstream includes(part / "includes");
  for (const std::string& each : dependencies(contents(fs::path(made.path()) / "includes"), program.folder))
    includes << hex(hash64(contents(each))) << ' ' << each << '\n';
  includes.close();
  std::ofstream whole(part / "key", std::ios::binary);
  whole << key;
  whole.close();
  if (failed || !includes || !whole)
    return Error{"cannot keep the compiled program in '" + part.string() + "'"};
  fs::remove_all(kept, failed);
  fs::rename(part, kept, failed);
  if (failed) {  // another run has put the same there
    fs::remove_all(part, failed);
    if (!is_current(kept, key)) return Error{"cannot keep the compiled program in '" + kept.string() + "'"};
  }
  return kept;
}

/// The folder for what the program writes; without one it has a temporary one in the sandbox.
Status open_output(const std::string& output, ProgramLaunch& out) {
  if (output.empty()) {
    if (out.budget.sandbox) out.environment.push_back(std::string("SANDLOT_ROBIOS_FILES=") + temporary_files);
    return {};
  }
  const fs::path named = fs::path(out.folder) / output;
  const Error refused{"the program cannot write into its output folder '" + named.string() + "'",
                      "output: names a folder that is made when it is not there"};
  std::error_code failed;
  const bool made = fs::create_directories(named, failed);
  out.write_folder = fs::canonical(named, failed).string();
  struct stat info {};
  if (failed || ::stat(out.write_folder.c_str(), &info) != 0 || !S_ISDIR(info.st_mode)) return refused;
  if (const auto user = program_user()) {
    if (made && ::chown(out.write_folder.c_str(), user->user, user->group) != 0) return refused;
    if (!made && info.st_uid != user->user && (info.st_mode & S_IWOTH) == 0) return refused;
  }
  out.environment.push_back("SANDLOT_ROBIOS_FILES=" +
                            (out.budget.sandbox ? std::string(written_inside) : out.write_folder));
  return {};
}

}  // namespace

int api_of(std::string_view text) {
  for (const char* const word :
       {"robios6/", "hdt_sem.h", "VWHandle", "PSDHandle", "DeviceSemantics", "OSMTInit", "MotorHandle",
        "ServoHandle", "PositionType", "CAMGetColFrame", "CAMGetFrame", "OSSpawn", "colimage"})
    if (text.find(word) != std::string_view::npos && text.find("robios7/") == std::string_view::npos)
      return 6;
  return 7;
}

Result<ProgramLaunch> prepare(const Source& source) {
  ProgramLaunch out;
  out.budget = source.budget;
  std::error_code none;
  out.folder = fs::canonical(source.folder.empty() ? fs::path(".") : fs::path(source.folder), none).string();
  if (out.folder.empty())
    return Error{"there is no folder '" + source.folder + "' for the program to work in",
                 "folder: is relative to the scenario's file; by default it is that file's own"};
  SL_TRY(open_output(source.output, out));
  const fs::path named = fs::path(out.folder) / source.program;
  if (!fs::is_regular_file(named, none))
    return Error{"there is no program '" + source.program + "' in '" + out.folder + "'",
                 "program: names a .c, .cpp or .py file, a library (.so) or an executable"};
  const fs::path file = fs::canonical(named, none);
  // By its place in the folder, as the sandbox shows it; else by its whole path.
  const fs::path relative = file.lexically_relative(out.folder);
  const bool within = !relative.empty() && *relative.begin() != "..";
  if (!within) out.read_folders.push_back(file.parent_path().string());
  const std::string shown = within ? "./" + relative.string() : file.string();

  const Language language = language_of(file);
  const std::vector<fs::path> included = language == Language::none ? std::vector<fs::path>()
                                                                    : included_by(file);
  int api = source.api;
  if (api == 0) {
    api = language == Language::none ? 7 : api_of(contents(file));
    for (const fs::path& each : included) api = std::min(api, api_of(contents(each)));
  }
  const Library library = find_library(api);
  if (!library.folder.empty()) {
    out.read_folders.push_back(library.folder);
    out.environment.push_back("LD_LIBRARY_PATH=" + library.folder);
  }
  if (const auto user = program_user(); user && !out.budget.sandbox)
    for (const fs::path& each : {file, fs::path(library.folder) / ("librobios" + std::to_string(api) + ".so"),
                                 fs::path(library.headers) / "eyebot.h"})
      if (fs::exists(each, none) && !can_read(*user, each.string()))
        return Error{
            "programs of root run as the user nobody, who cannot read '" + each.string() + "'",
            "let others read it and pass the folders above it (chmod o+rx), or put it outside of /root"};
  const std::string missing = "this Sandlot has no library of RoBIOS " + std::to_string(api);
  if (language != Language::none) {
    if (library.folder.empty() || library.headers.empty())
      return Error{missing, "install it whole, or build the target robios" + std::to_string(api)};
    ProgramLaunch compiler = out;
    compiler.read_folders.push_back(library.headers);
    show_above(included, compiler);
    SL_ASSIGN(const fs::path made,
              compile(source, file, within ? relative.string() : shown, library, api, compiler));
    out.read_folders.push_back(made.string());
    out.command = {(made / "program").string()};
  } else if (file.extension() == ".so") {
    if (library.folder.empty() || library.host.empty()) return Error{missing, "install it whole"};
    out.read_folders.push_back(fs::path(library.host).parent_path().string());
    out.command = {library.host, shown};
  } else if (file.extension() == ".py") {
    if (library.folder.empty() || library.python.empty()) return Error{missing, "install it whole"};
    // Its threads and clocks are the library's, too; those of the sandbox are not.
    const std::string preload = "LD_PRELOAD=" + library.folder + "/librobios" + std::to_string(api) + ".so";
    out.python_folders.push_back(library.python);
    out.command = {"env", preload, "python3", "-m", "robios_main", shown};
  } else if (access(file.c_str(), X_OK) == 0) {
    out.command = {shown};
  } else {
    return Error{"'" + source.program + "' is not a program",
                 "program: names a .c, .cpp or .py file, a library (.so) or an executable (chmod +x)"};
  }
  return out;
}

}  // namespace sandlot::programs::robios
