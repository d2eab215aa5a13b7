#pragma once
/// Child process with its standard input, output and error connected to this one.
///
/// Writing   never waits: what the child does not take at once stays in a buffer.
/// Reading   never waits: whole lines, from output and error alike.
/// End       destroying it kills the child's process group and all processes below it, and collects the child. The child is
///           killed by the kernel when the thread that started it ends.
/// Limits    a line of output has at most `longest_line` bytes; processes that leave the group and lose their parent live on,
///           unless a sandbox (programs/sandbox.h) holds them.
/// Errors    the command cannot be started, with the system's reason.
#include <cstddef>
#include <deque>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"
#include "programs/budget.h"

namespace sandlot::programs {

/// A command and the circumstances in which it runs.
struct Launch {
  std::vector<std::string> command;  ///< program and arguments; a program without '/' is looked for in PATH
  std::string folder;                ///< working directory; "": that of this process
  std::optional<std::vector<std::string>> environment = {};  ///< "NAME=value"; unset: that of this process
  std::optional<User> user = {};                             ///< unset: that of this process
  std::optional<Limits> limits = {};
  bool may_gain_rights = true;   ///< by programs that are set-user-ID
  bool ends_with_child = false;  ///< it collects what it runs, and ends then: bubblewrap
  bool answers = true;  ///< its output answers its input; else there is no input, and long lines are cut
  std::vector<int> inherited = {};  ///< descriptors that stay open in it
};

class Child {
 public:
  static constexpr std::size_t longest_line = std::size_t{1} << 20;

  static Result<Child> start(const Launch& launch);
  static Result<Child> start(const std::vector<std::string>& command, const std::string& folder = "") {
    return start(Launch{command, folder});
  }
  Child(Child&& other) noexcept { *this = std::move(other); }
  Child& operator=(Child&& other) noexcept;
  ~Child() { end(); }

  /// Appends a line to what is on its way to the child.
  void write_line(std::string_view line);
  /// Moves what can be moved at once, in both directions.
  void move();
  /// The next whole line of output; move() brings them.
  std::optional<std::string> take_line();
  /// The next whole line of standard error.
  std::optional<std::string> take_note();
  /// Whether bytes are still on their way to the child.
  bool writing() const { return !out_.empty() && input_ >= 0; }
  /// Empty while the child may still send lines; else why it will not.
  const std::string& gone() const { return gone_; }
  /// How it ended, as of waitpid(); nothing: it runs.
  std::optional<int> exit_status();
  int process() const { return process_; }
  int input() const { return input_; }
  int output() const { return output_; }
  int error() const { return error_; }

 private:
  Child() = default;
  void end();
  void write_some();
  void read_some(int& descriptor, std::string& rest, std::deque<std::string>& lines, std::size_t most_lines,
                 bool cut_lines);

  int process_ = -1;  ///< also its process group; -1: it has been collected
  std::optional<int> exit_status_;
  bool answers_ = true, ends_with_child_ = false;
  int input_ = -1, output_ = -1, error_ = -1;
  std::string out_, rest_, error_rest_;
  std::deque<std::string> lines_, notes_;
  std::string gone_;
};

/// The signal that ended a process, by its status of waitpid(), also as shells and bubblewrap pass it on; 0: none did.
int signal_of_exit(int status);
/// Text of a status of waitpid(): "ended with code 1".
std::string text_of_exit(int status);
/// The file that a command runs; "": there is none. @param path  folders with ':' between them
std::string find_program(const std::string& name, const std::string& folder, std::string_view path);

}  // namespace sandlot::programs
