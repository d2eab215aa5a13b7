#pragma once
/// Sandbox of a program that Sandlot starts, made by bubblewrap (`bwrap`, found in PATH when the program is started).
///
/// Files     /usr, /etc/alternatives and /etc/ld.so.cache of the machine and the program's own folder as /team, all read-only;
///           /tmp and /dev/shm in memory; the folder of its socket. Nothing else.
/// Network   none: the socket is the only way out.
/// Others    process numbers, users, host name and shared memory of its own: other processes do not exist for it.
/// Rights    those of the user that runs Sandlot, or of `nobody` when that is root, less what the sandbox takes away; no new
///           ones, no further user namespaces.
/// Errors    bubblewrap is missing, or the system forbids user namespaces: one sentence with what to do.
/// Limits    no filter of system calls; what is in memory that belongs to no process (unmapped memfds) is bounded by the size and number
///           of open files alone; /proc shows the machine's load.
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "programs/child.h"

namespace sandlot::programs {

/// Whom programs run as: `nobody` when this process is root; nothing: its own user.
std::optional<User> program_user();

/// Whether `user` can read a file, or list a folder, by the modes of it and of the folders above.
bool can_read(const User& user, const std::string& path);

/// Folder with mode 0700 for the socket of one program, that `user` owns. Removed with what is in it when destroyed.
class PrivateFolder {
 public:
  static Result<PrivateFolder> make(const std::optional<User>& user);
  PrivateFolder(PrivateFolder&& other) noexcept : path_(std::exchange(other.path_, {})) {}
  PrivateFolder& operator=(PrivateFolder&& other) noexcept {
    std::swap(path_, other.path_);
    return *this;
  }
  ~PrivateFolder();
  const std::string& path() const { return path_; }

 private:
  explicit PrivateFolder(std::string path) : path_(std::move(path)) {}
  std::string path_;
};

/// 32 random hexadecimal digits, not for the run, whose random numbers come from streams.
Result<std::string> make_secret();

/// What a program that connects to the run is started with.
struct ProgramLaunch {
  std::vector<std::string> command;
  std::string folder;
  Budget budget;
  std::string socket_folder;                   ///< holds `socket_name`; "": it has no socket
  std::vector<std::string> environment;        ///< "NAME=value"
  std::vector<std::string> python_folders;     ///< of modules that it may import
  std::vector<std::string> read_folders = {};  ///< further ones that it may read, at their own paths
  std::vector<int> inherited = {};             ///< descriptors that stay open in it
  std::string below =
      {};  ///< end of `folder` that the sandbox keeps, so that read_files have places above it
  std::vector<std::string> read_files = {};  ///< files in the folders of that end
  std::string write_folder = {};             ///< that it may fill, shown as written_inside
};
inline constexpr const char* socket_name = "run.sock";
inline constexpr const char* written_inside = "/run/files";

/// The command with its sandbox, if it is to have one, its limits, its user and its environment; SANDLOT_URL is added.
/// Errors   there is no sandbox; `nobody` cannot read the folder; the sandbox has no such program.
Result<Launch> launch_of(const ProgramLaunch& program);

/// "bubblewrap 0.8.0", if it works here.
Result<std::string> sandbox_version();

}  // namespace sandlot::programs
