#include "programs/child.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <span>
#include <utility>

#include "base/text.h"
#include "programs/process_tree.h"

namespace sandlot::programs {
namespace {

void close_one(int& descriptor) {
  if (descriptor >= 0) close(descriptor);
  descriptor = -1;
}

/// A pair of connected descriptors that no other child inherits.
struct Pair {
  int ours = -1, theirs = -1;
  ~Pair() { close_one(ours), close_one(theirs); }
};

bool open_pair(Pair& pair, bool to_child) {
  int both[2];
  // To the child by a socket: writing to one that is closed need not raise SIGPIPE.
  if (to_child ? socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, both) : pipe2(both, O_CLOEXEC))
    return false;
  pair.ours = both[0];  // of a pipe the end that reads
  pair.theirs = both[1];
  return fcntl(pair.ours, F_SETFL, fcntl(pair.ours, F_GETFL) | O_NONBLOCK) == 0;
}

/// What the child needs between fork and exec, made before: it may not allocate.
struct Plan {
  const char* file = nullptr;
  char* const* arguments = nullptr;
  char* const* environment = nullptr;
  const char* folder = "";
  const User* user = nullptr;
  const Limits* limits = nullptr;
  std::span<const int> inherited;
  bool may_gain_rights = true;
  pid_t parent = 0;
  int in = -1, out = -1, error = -1, report = -1;
};

/// By bare system calls: the wrappers of the library would have all threads of the process follow.
bool become_user(const User& user) {
  return syscall(SYS_setgroups, 0, nullptr) == 0 &&
         syscall(SYS_setresgid, user.group, user.group, user.group) == 0 &&
         syscall(SYS_setresuid, user.user, user.user, user.user) == 0;
}

bool apply(const Limits& limits) {
  const auto at_most = [](auto what, rlim_t most) {
    rlimit now{};
    if (getrlimit(what, &now) != 0) return false;
    const rlimit lower{std::min(most, now.rlim_max), std::min(most, now.rlim_max)};
    return setrlimit(what, &lower) == 0;
  };
  [[maybe_unused]] const int niceness = nice(limits.niceness);
  return at_most(RLIMIT_CORE, 0) && at_most(RLIMIT_FSIZE, limits.file_bytes) &&
         at_most(RLIMIT_NOFILE, limits.open_files) && at_most(RLIMIT_DATA, limits.memory_bytes) &&
         at_most(RLIMIT_AS, limits.memory_bytes + limits.address_bytes) &&
         (limits.processes == 0 || at_most(RLIMIT_NPROC, limits.processes));
}

bool keep_open(std::span<const int> descriptors) {
  for (const int each : descriptors)
    if (fcntl(each, F_SETFD, 0) != 0) return false;
  return true;
}

/// What the child does between fork and exec: system calls alone, since other threads may hold any lock.
[[noreturn]] void become(const Plan& plan) {
  setpgid(0, 0);
  // A change of the user makes the kernel forget the death signal: first the one, then the other.
  if ((!plan.user || become_user(*plan.user)) && prctl(PR_SET_PDEATHSIG, SIGKILL) == 0 &&
      getppid() == plan.parent && dup2(plan.in, 0) >= 0 && dup2(plan.out, 1) >= 0 &&
      dup2(plan.error, 2) >= 0 && keep_open(plan.inherited) && (!*plan.folder || chdir(plan.folder) == 0) &&
      (!plan.limits || apply(*plan.limits)) &&
      (plan.may_gain_rights || prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0)) {
    sigset_t none;
    sigemptyset(&none);
    sigprocmask(SIG_SETMASK, &none, nullptr);
    signal(SIGPIPE, SIG_DFL);
    execve(plan.file, plan.arguments, plan.environment);
  }
  const int why = errno;
  [[maybe_unused]] const ssize_t sent = ::write(plan.report, &why, sizeof why);
  _exit(127);
}

std::vector<char*> pointers_to(const std::vector<std::string>& texts) {
  std::vector<char*> out;
  for (const std::string& each : texts) out.push_back(const_cast<char*>(each.c_str()));
  out.push_back(nullptr);
  return out;
}

}  // namespace

std::string find_program(const std::string& name, const std::string& folder, std::string_view path) {
  if (name.find('/') != std::string::npos) {
    std::string file = name.front() == '/' || folder.empty() ? name : folder + "/" + name;
    return access(file.c_str(), X_OK) == 0 ? file : "";
  }
  for (const std::string_view each : split(path, ':')) {
    std::string file = std::string(each.empty() ? "." : each) + "/" + name;
    if (access(file.c_str(), X_OK) == 0) return file;
  }
  return "";
}

int signal_of_exit(int status) {
  if (WIFSIGNALED(status)) return WTERMSIG(status);
  const int code = WEXITSTATUS(status);
  return code > 128 && code < 128 + NSIG ? code - 128 : 0;
}

std::string text_of_exit(int status) {
  if (const int number = signal_of_exit(status))
    return "was ended by signal " + std::to_string(number) + " (" + strsignal(number) + ")";
  return "ended with code " + std::to_string(WEXITSTATUS(status));
}

Result<Child> Child::start(const Launch& launch) {
  const auto& [command, folder] = std::tie(launch.command, launch.folder);
  const auto failed = [&launch](const std::string& why) {
    return Error{
        "cannot start '" + (launch.command.empty() ? std::string() : launch.command.front()) + "': " + why,
        "name a program and its arguments: command: [python3, brain.py]"};
  };
  if (command.empty() || command.front().empty()) return failed("the command is empty");
  const char* const path = std::getenv("PATH");
  const std::string file = find_program(command.front(), folder,
                                        path ? path : "/usr/local/bin:/usr/bin:/bin");
  if (file.empty()) return failed("there is no such program");
  if (struct stat there; !folder.empty() && (::stat(folder.c_str(), &there) != 0 || !S_ISDIR(there.st_mode)))
    return Error{"cannot start '" + command.front() + "': there is no folder '" + folder + "' to work in",
                 "folder: is relative to the scenario's file; by default it is that file's own"};
  const std::vector<char*> arguments = pointers_to(command);
  const std::vector<std::string> none;
  const std::vector<char*> environment = pointers_to(launch.environment ? *launch.environment : none);

  Pair in, out, error, report;
  if (!open_pair(in, true) || !open_pair(out, false) || !open_pair(error, false) || !open_pair(report, false))
    return failed(std::strerror(errno));
  Plan plan;
  plan.file = file.c_str();
  plan.arguments = arguments.data();
  plan.environment = launch.environment ? environment.data() : environ;
  plan.folder = folder.c_str();
  plan.user = launch.user ? &*launch.user : nullptr;
  plan.limits = launch.limits ? &*launch.limits : nullptr;
  plan.inherited = launch.inherited;
  plan.may_gain_rights = launch.may_gain_rights;
  plan.parent = getpid();
  plan.in = in.theirs, plan.out = out.theirs, plan.error = error.theirs, plan.report = report.theirs;
  const pid_t process = fork();
  if (process < 0) return failed(std::strerror(errno));
  if (process == 0) become(plan);
  setpgid(process, process);  // here too: whoever comes first
  Child child;
  child.process_ = process;
  child.answers_ = launch.answers;
  child.ends_with_child_ = launch.ends_with_child;
  for (Pair* const pair : {&in, &out, &error, &report}) close_one(pair->theirs);
  if (launch.answers) child.input_ = std::exchange(in.ours, -1);
  child.output_ = std::exchange(out.ours, -1);
  child.error_ = std::exchange(error.ours, -1);
  // The report closes when the command runs; this is the only wait, and it is one for the kernel.
  int why = 0;
  fcntl(report.ours, F_SETFL, 0);
  ssize_t got = 0;
  do got = ::read(report.ours, &why, sizeof why);
  while (got < 0 && errno == EINTR);
  if (got > 0) return failed(std::strerror(why));
  return child;
}

Child& Child::operator=(Child&& other) noexcept {
  if (this == &other) return *this;
  end();
  process_ = std::exchange(other.process_, -1);
  exit_status_ = std::exchange(other.exit_status_, std::nullopt);
  answers_ = other.answers_;
  ends_with_child_ = other.ends_with_child_;
  input_ = std::exchange(other.input_, -1);
  output_ = std::exchange(other.output_, -1);
  error_ = std::exchange(other.error_, -1);
  out_ = std::move(other.out_);
  rest_ = std::move(other.rest_);
  error_rest_ = std::move(other.error_rest_);
  lines_ = std::move(other.lines_);
  notes_ = std::move(other.notes_);
  gone_ = std::move(other.gone_);
  return *this;
}

void Child::end() {
  close_one(input_);
  close_one(output_);
  close_one(error_);
  if (process_ < 0) return;
  for (const int each : processes_below(process_)) kill(each, SIGKILL);
  if (ends_with_child_) {
    kill(process_, SIGCONT);
    for (int i = 0; i < 200 && !exit_status(); ++i) usleep(1000);
    if (process_ < 0) return;
  }
  kill(-process_, SIGKILL);
  kill(process_, SIGKILL);
  while (waitpid(process_, nullptr, 0) < 0 && errno == EINTR) {}
  process_ = -1;
}

std::optional<int> Child::exit_status() {
  int status = 0;
  if (process_ >= 0 && waitpid(process_, &status, WNOHANG) == process_) {
    kill(-process_, SIGKILL);  // the rest of its group
    process_ = -1;
    exit_status_ = status;
  }
  return exit_status_;
}

void Child::write_line(std::string_view line) {
  out_.append(line).push_back('\n');
  write_some();
}

void Child::write_some() {
  while (!out_.empty() && input_ >= 0) {
    const ssize_t sent = send(input_, out_.data(), out_.size(), MSG_NOSIGNAL);
    if (sent > 0) {
      out_.erase(0, static_cast<std::size_t>(sent));
    } else if (sent < 0 && errno == EINTR) {
      continue;
    } else {
      if (sent < 0 && errno != EAGAIN && errno != EWOULDBLOCK) {
        close_one(input_);  // it reads no more; it may still have something to say
        out_.clear();
      }
      return;
    }
  }
}

void Child::move() {
  write_some();
  constexpr std::size_t most_lines = 64, most_notes = 64;
  read_some(error_, error_rest_, notes_, most_notes, true);
  if (output_ < 0) return;
  read_some(output_, rest_, lines_, most_lines, !answers_);
  if (output_ < 0 && gone_.empty()) gone_ = "it has ended";
}

/// Reads until there is nothing more for now, or lines enough: the kernel's buffer then holds the child back.
/// @param cut_lines  too long a line is cut; else it ends the connection
void Child::read_some(int& descriptor, std::string& rest, std::deque<std::string>& lines,
                      std::size_t most_lines, bool cut_lines) {
  constexpr std::size_t longest_note = 1000;
  std::array<char, 16384> buffer;
  while (descriptor >= 0 && lines.size() < most_lines) {
    const ssize_t got = ::read(descriptor, buffer.data(), buffer.size());
    if (got < 0 && errno == EINTR) continue;
    if (got < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) return;
    if (got <= 0) return close_one(descriptor);
    std::string_view text(buffer.data(), static_cast<std::size_t>(got));
    while (!text.empty()) {
      const std::size_t end = text.find('\n');
      rest.append(text.substr(0, end));
      if (cut_lines && rest.size() > longest_note) rest.resize(longest_note);
      if (!cut_lines && rest.size() > longest_line) {
        gone_ = "its line is longer than " + std::to_string(longest_line) + " bytes";
        return close_one(descriptor);
      }
      if (end == std::string_view::npos) break;
      lines.push_back(std::exchange(rest, {}));
      text.remove_prefix(end + 1);
    }
  }
}

std::optional<std::string> Child::take_line() {
  if (lines_.empty()) return std::nullopt;
  std::string line = std::move(lines_.front());
  lines_.pop_front();
  return line;
}

std::optional<std::string> Child::take_note() {
  if (notes_.empty()) return std::nullopt;
  std::string note = std::move(notes_.front());
  notes_.pop_front();
  return note;
}

}  // namespace sandlot::programs
