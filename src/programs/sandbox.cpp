#include "programs/sandbox.h"

#include <poll.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include "base/text.h"
#include "programs/process_tree.h"

namespace sandlot::programs {
namespace {

namespace fs = std::filesystem;

constexpr const char* sandbox_path = "/usr/local/bin:/usr/bin:/bin";
constexpr const char* team_folder = "/team";
constexpr const char* socket_inside = "/run/sandlot";
constexpr std::uint64_t most_temporary_bytes = 64u << 20;

struct Bubblewrap {
  std::string file;
  bool forbids_namespaces = false;  ///< it can keep those within from making further ones
};

/// What all sandboxes have.
std::vector<std::string> walls(const Bubblewrap& bwrap) {
  std::vector<std::string> out{bwrap.file,      "--unshare-all", "--unshare-user", "--die-with-parent",
                               "--new-session", "--hostname",    "sandlot"};
  if (bwrap.forbids_namespaces) out.emplace_back("--disable-userns");
  const auto add = [&](std::initializer_list<const char*> words) {
    out.insert(out.end(), words.begin(), words.end());
  };
  add({"--ro-bind", "/usr", "/usr"});
  // Where these are folders of their own, not links into /usr, they are bound as they are.
  for (const char* const name : {"bin", "sbin", "lib", "lib32", "lib64", "libx32"}) {
    const std::string at = std::string("/") + name;
    std::error_code none;
    if (fs::is_symlink(at, none)) {
      out.insert(out.end(), {"--symlink", "usr/" + std::string(name), at});
    } else if (fs::is_directory(at, none)) {
      out.insert(out.end(), {"--ro-bind", at, at});
    }
  }
  add({"--ro-bind-try", "/etc/alternatives", "/etc/alternatives"});
  add({"--ro-bind-try", "/etc/ld.so.cache", "/etc/ld.so.cache"});
  const std::string size = std::to_string(most_temporary_bytes);
  add({"--proc", "/proc", "--dev", "/dev", "--size", size.c_str(), "--tmpfs", "/dev/shm"});
  add({"--remount-ro", "/dev", "--size", size.c_str(), "--tmpfs", "/tmp"});
  return out;
}

/// Runs it in a sandbox; @return what it has to complain about, "" if it ended well.
std::string complaint_of(std::vector<std::string> command, std::string& output) {
  Launch launch{std::move(command), "/"};
  launch.environment.emplace({"PATH=" + std::string(sandbox_path)});
  launch.user = program_user();
  launch.answers = false;
  auto child = Child::start(launch);
  if (!child) return child.error().text();
  std::string words;
  using Clock = std::chrono::steady_clock;
  const auto end = Clock::now() + std::chrono::seconds(10);  // lint-ok: the wait for a process, not the run
  while (Clock::now() < end) {                               // lint-ok: see above
    child->move();
    while (auto line = child->take_line()) output = *line;
    while (auto note = child->take_note()) words = *note;
    if (const auto status = child->exit_status(); status && child->output() < 0 && child->error() < 0)
      return *status == 0 ? "" : words.empty() ? "bwrap " + text_of_exit(*status) : words;
    pollfd either[2] = {{child->output(), POLLIN, 0}, {child->error(), POLLIN, 0}};
    poll(either, 2, 10);
  }
  return "bwrap does not end";
}

Result<Bubblewrap> find_bubblewrap() {
  const char* const path = std::getenv("PATH");
  Bubblewrap out{find_program("bwrap", "", path ? path : sandbox_path), true};
  if (out.file.empty())
    return Error{
        "there is no bubblewrap (bwrap), which makes the sandbox of a program",
        "install it (apt install bubblewrap), or give `sandbox: off` to run the program with your rights"};
  std::string complaint, ignored;
  for (const bool forbids : {true, false}) {
    out.forbids_namespaces = forbids;
    std::vector<std::string> command = walls(out);
    command.insert(command.end(), {"--", "/usr/bin/true"});
    complaint = complaint_of(std::move(command), ignored);
    if (complaint.empty()) return out;
  }
  return Error{"this system does not let bubblewrap make a sandbox (" + complaint + ")",
               "allow user namespaces, or give `sandbox: off` to run the program with your rights"};
}

const std::vector<std::string> shown_folders{"/usr", "/bin", "/sbin", "/lib", "/lib64"};

bool is_below_any(const std::string& file, const std::vector<std::string>& folders) {
  return std::any_of(folders.begin(), folders.end(), [&](const std::string& top) {
    return file.compare(0, top.size(), top) == 0 && (file.size() == top.size() || file[top.size()] == '/');
  });
}

/// Where the sandbox shows a file of the machine; "": nowhere.
std::string inside(const std::string& file, const std::string& folder,
                   const std::vector<std::string>& read_folders) {
  if (is_below_any(file, shown_folders) || is_below_any(file, read_folders)) return file;
  return is_below_any(file, {folder}) ? team_folder + file.substr(folder.size()) : "";
}

/// The folder without "." and a slash at its end.
std::string plain(const std::string& folder) {
  std::string out = fs::absolute(folder).lexically_normal().string();
  while (out.size() > 1 && out.back() == '/') out.pop_back();
  return out;
}

/// The file that a command of `user` runs: root finds some that others cannot reach.
std::string program_of(const User& user, const std::string& name, const std::string& folder) {
  if (name.find('/') != std::string::npos) return find_program(name, folder, "");
  const char* const path = std::getenv("PATH");
  for (const std::string_view each : split(path ? path : sandbox_path, ':'))
    if (std::string file = find_program(name, "", each); !file.empty() && can_read(user, file)) return file;
  return "";
}

std::string variable(const char* name, const std::string& value) { return name + ("=" + value); }

Error unreadable(const std::string& path) {
  return Error{
      "'" + path + "' cannot be read by 'nobody', whom programs run as when Sandlot runs as root",
      "let others read it and enter the folders above it: chmod -R o+rX, or run Sandlot as an ordinary user"};
}

}  // namespace

std::optional<User> program_user() {
  constexpr uid_t nobody = 65534;
  if (geteuid() != 0) return std::nullopt;
  return User{nobody, nobody};
}

bool can_read(const User& user, const std::string& path) {
  const auto allows = [&](const std::string& at, unsigned bits) {
    struct stat info {};
    if (::stat(at.c_str(), &info) != 0) return false;
    const unsigned shift = info.st_uid == user.user ? 6u : info.st_gid == user.group ? 3u : 0u;
    const unsigned wanted = bits | (S_ISDIR(info.st_mode) ? 1u : 0u);
    return (info.st_mode >> shift & wanted) == wanted;
  };
  constexpr unsigned read = 4, none = 0;
  const fs::path whole = plain(path);
  for (fs::path above = whole.parent_path(); !above.empty(); above = above.parent_path()) {
    if (!allows(above.string(), none)) return false;
    if (above == above.root_path()) break;
  }
  return allows(whole.string(), read);
}

Result<PrivateFolder> PrivateFolder::make(const std::optional<User>& user) {
  // Not in a deep TMPDIR: the address of a socket has at most 107 bytes.
  std::string path = "/tmp/sandlot-XXXXXX";
  if (!::mkdtemp(path.data()))
    return Error{std::string("cannot make a folder in /tmp for a socket: ") + std::strerror(errno)};
  PrivateFolder out(path);
  if (user && ::chown(path.c_str(), user->user, user->group) != 0)
    return Error{"cannot give '" + path + "' to another user: " + std::strerror(errno)};
  return out;
}

PrivateFolder::~PrivateFolder() {
  std::error_code ignored;
  if (!path_.empty()) fs::remove_all(path_, ignored);
}

Result<std::string> make_secret() {
  std::array<unsigned char, 16> bytes;
  if (getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size()))
    return Error{"the system has no random numbers for a token"};
  std::string out;
  for (const unsigned char byte : bytes) {
    out += "0123456789abcdef"[byte >> 4];
    out += "0123456789abcdef"[byte & 15];
  }
  return out;
}

Result<Launch> launch_of(const ProgramLaunch& program) {
  Launch out;
  out.user = program_user();
  out.answers = false;
  out.inherited = program.inherited;
  out.limits.emplace();
  out.limits->memory_bytes = static_cast<std::uint64_t>(program.budget.memory_bytes);
  const std::string folder = plain(program.folder.empty() ? "." : program.folder);
  std::error_code none;
  if (!fs::is_directory(folder, none))
    return Error{"there is no folder '" + folder + "' for the program to work in",
                 "folder: is relative to the scenario's file; by default it is that file's own"};
  if (out.user && !can_read(*out.user, folder)) return unreadable(folder);
  if (program.command.empty() || program.command.front().empty())
    return Error{"the command is empty", "name a program and its arguments: command: [python3, team.py]"};
  for (const std::string& word : program.command)
    if (const fs::path file = fs::path(folder) / word; fs::is_regular_file(file, none))
      if (out.user && !can_read(*out.user, file.string())) return unreadable(file.string());

  std::string modules;
  const auto count = static_cast<std::uint64_t>(program.budget.processes);
  const std::string python_hint = "PYTHONDONTWRITEBYTECODE=1";
  if (!program.budget.sandbox) {
    out.command = program.command;
    out.folder = folder;
    if (out.user) {
      const std::string file = program_of(*out.user, program.command.front(), folder);
      if (file.empty())
        return Error{"cannot start '" + program.command.front() + "': there is no such program for 'nobody'",
                     "whom programs run as when Sandlot runs as root: install it for all users"};
      out.command.front() = file;
    }
    out.may_gain_rights = false;
    // The kernel counts what the user runs already.
    out.limits->processes = threads_of_user(out.user ? out.user->user : getuid()) + count;
    out.environment.emplace();
    for (char** each = environ; *each; ++each)
      if (std::strncmp(*each, "SANDLOT_", 8) != 0 && std::strncmp(*each, "PYTHONPATH=", 11) != 0)
        out.environment->emplace_back(*each);
    for (const std::string& each : program.python_folders) modules += each + ":";
    if (const char* const own = std::getenv("PYTHONPATH")) modules += own;
    if (!program.socket_folder.empty())
      out.environment->push_back(
          variable("SANDLOT_URL", "unix:" + program.socket_folder + "/" + socket_name));
  } else {
    SL_ASSIGN(const Bubblewrap bwrap, find_bubblewrap());
    const std::string& name = program.command.front();
    const std::string file = find_program(name, folder, sandbox_path);
    const std::string shown = name.find('/') == std::string::npos || name.front() != '/'
                                  ? name
                                  : inside(plain(name), folder, program.read_folders);
    if (file.empty() || shown.empty())
      return Error{"cannot start '" + name +
                       "': " + (file.empty() ? "there is no such program" : "the sandbox does not show it") +
                       "; of this machine's files a sandbox has /usr and the program's own folder",
                   "put it there, or give `sandbox: off` to run it with your rights"};
    out.ends_with_child = true;
    out.command = walls(bwrap);
    const auto add = [&](std::initializer_list<std::string> words) {
      out.command.insert(out.command.end(), words.begin(), words.end());
    };
    const std::string at = program.below.empty() ? team_folder : team_folder + ("/" + program.below);
    add({"--ro-bind", folder, at});
    const std::string top = folder.substr(0, folder.size() - (at.size() - std::strlen(team_folder)));
    for (const std::string& each : program.read_files) {
      if (out.user && !can_read(*out.user, each)) return unreadable(each);
      if (is_below_any(each, {top}) && !is_below_any(each, {folder}))
        add({"--ro-bind", each, team_folder + each.substr(top.size())});
    }
    if (!program.write_folder.empty()) add({"--bind", program.write_folder, written_inside});
    if (!program.socket_folder.empty()) add({"--bind", program.socket_folder, socket_inside});
    for (const std::string& each : program.read_folders) {
      if (out.user && !can_read(*out.user, each)) return unreadable(each);
      if (!is_below_any(each, shown_folders)) add({"--ro-bind", each, each});
    }
    int number = 0;
    for (const std::string& each : program.python_folders) {
      if (out.user && !can_read(*out.user, each)) continue;
      const std::string shown_at = "/run/python" + std::to_string(number++);
      add({"--ro-bind", each, shown_at});
      modules += shown_at + ":";
    }
    add({"--chdir", at, "--"});
    // Within the sandbox the kernel counts its processes alone, with bubblewrap's own first one.
    const std::string most = std::to_string(count + 1);
    add({"/usr/bin/prlimit", "--nproc=" + most + ":" + most, "--", shown});
    out.command.insert(out.command.end(), program.command.begin() + 1, program.command.end());
    out.folder = "/";
    out.environment = std::vector<std::string>{variable("PATH", sandbox_path), "HOME=/tmp", "LANG=C.UTF-8"};
    if (!program.socket_folder.empty())
      out.environment->push_back(
          variable("SANDLOT_URL", std::string("unix:") + socket_inside + "/" + socket_name));
  }
  if (!modules.empty()) {
    if (modules.back() == ':') modules.pop_back();
    out.environment->push_back(variable("PYTHONPATH", modules));
  }
  out.environment->push_back(python_hint);
  out.environment->emplace_back("PYTHONUNBUFFERED=1");
  out.environment->insert(out.environment->end(), program.environment.begin(), program.environment.end());
  return out;
}

Result<std::string> sandbox_version() {
  SL_ASSIGN(const Bubblewrap bwrap, find_bubblewrap());
  std::string version;
  if (const std::string complaint = complaint_of({bwrap.file, "--version"}, version); !complaint.empty())
    return Error{complaint};
  return version;
}

}  // namespace sandlot::programs
