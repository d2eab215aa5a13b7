/// What a program in its sandbox can and cannot do. Needs bubblewrap, python3 and a system that allows user namespaces.
#include "programs/sandbox.h"

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <thread>

#include "base/test_folder.h"
#include "programs/process_tree.h"
#include "programs/test_sandbox.h"

namespace sandlot::programs {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::HasSubstr;
namespace fs = std::filesystem;

/// A folder that everybody may read, as `nobody` has to when the tests run as root.
struct Folder : test::TestFolder {
  Folder() { fs::permissions(path, fs::perms(0755)); }
};

/// What a Python program did.
struct Ran {
  std::vector<std::string> lines, notes;
  int status = -1;
};

Ran wait_for(Child child) {
  Ran out;
  for (int i = 0; i < 30'000; ++i) {
    child.move();
    while (auto line = child.take_line()) out.lines.push_back(*line);
    while (auto note = child.take_note()) out.notes.push_back(*note);
    if (const auto status = child.exit_status(); status && child.output() < 0 && child.error() < 0) {
      out.status = *status;
      break;
    }
    std::this_thread::sleep_for(1ms);
  }
  return out;
}

class Sandbox : public testing::Test {
 protected:
  void SetUp() override {
    SKIP_WITHOUT_SANDBOX();
    auto made = PrivateFolder::make(program_user());
    ASSERT_TRUE(made) << made.error().text();
    sockets.emplace(std::move(*made));
    program.command = {"python3", "program.py"};
    program.folder = folder.path.string();
    program.socket_folder = sockets->path();
  }
  Result<Child> start(const std::string& python) {
    folder.write("program.py", python);
    auto launch = launch_of(program);
    if (!launch) return launch.error();
    return Child::start(*launch);
  }
  Ran run(const std::string& python) {
    auto child = start(python);
    EXPECT_TRUE(child) << child.error().text();
    return child ? wait_for(std::move(*child)) : Ran();
  }

  Folder folder;
  std::optional<PrivateFolder> sockets;
  ProgramLaunch program;
};

TEST_F(Sandbox, AProgramSeesItsOwnFolderAloneAndCannotWriteThere) {
  const Folder other;
  const std::string secret = other.write("secret", "of another team");
  folder.write("data", "its own");
  const Ran ran = run(R"(
import os
print(open('data').read())
for path in (')" + secret +
                      R"(', '/etc/passwd', '/root', '/home'):
    try: print('read', os.listdir(path) if os.path.isdir(path) else open(path).read())
    except OSError as e: print(type(e).__name__)
for path in ('data', '/usr/x', '/dev/x', '/tmp/x'):
    try: print('wrote', open(path, 'w').write('x'))
    except OSError as e: print(e.strerror)
)");
  EXPECT_THAT(ran.lines, ElementsAre("its own", "FileNotFoundError", "FileNotFoundError", "FileNotFoundError",
                                     "FileNotFoundError", "Read-only file system", "Read-only file system",
                                     "Read-only file system", "wrote 1"))
      << testing::PrintToString(ran.notes);
  EXPECT_EQ(folder.read("data"), "its own");
}

TEST_F(Sandbox, AProgramHasNoNetwork) {
  const int listener = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  ASSERT_EQ(bind(listener, reinterpret_cast<sockaddr*>(&address), size), 0);
  ASSERT_EQ(listen(listener, 4), 0);
  ASSERT_EQ(getsockname(listener, reinterpret_cast<sockaddr*>(&address), &size), 0);
  program.command.push_back(std::to_string(ntohs(address.sin_port)));
  const char* const python = R"(
import socket, sys
try:
    socket.create_connection(('127.0.0.1', int(sys.argv[1])), 2)
    print('connected')
except OSError as e: print(type(e).__name__)
)";
  EXPECT_THAT(run(python).lines, ElementsAre("ConnectionRefusedError"));
  program.budget.sandbox = false;
  EXPECT_THAT(run(python).lines, ElementsAre("connected"));
  close(listener);
}

TEST_F(Sandbox, AProgramIsNotRootAndSeesNoOtherProcess) {
  const char* const python = R"(
import os
print(os.getuid() != 0 and os.geteuid() != 0, os.getgroups() in ([], [os.getgid()]))
print(sorted(int(each) for each in os.listdir('/proc') if each.isdigit()))
print([line for line in open('/proc/self/status') if line.startswith(('CapEff', 'NoNewPrivs'))])
)";
  const std::string rights = "['CapEff:\\t0000000000000000\\n', 'NoNewPrivs:\\t1\\n']";
  // Bubblewrap's own process is the first.
  EXPECT_THAT(run(python).lines, ElementsAre("True True", "[1, 2]", rights));
  program.budget.sandbox = false;
  const Ran free = run(python);
  ASSERT_EQ(free.lines.size(), 3u);
  EXPECT_TRUE(geteuid() != 0 || free.lines[0] == "True True");
  EXPECT_EQ(free.lines[2], rights);
}

TEST_F(Sandbox, AProgramCannotForkBeyondItsNumberOfProcesses) {
  const char* const python = R"(
import os, time
forked = 0
try:
    while forked < 50:
        if os.fork() == 0: time.sleep(30); os._exit(0)
        forked += 1
except BlockingIOError: pass
print(forked)
)";
  program.budget.processes = 8;
  EXPECT_THAT(run(python).lines, ElementsAre("7"));  // and the program itself
  program.budget.processes = 3;
  EXPECT_THAT(run(python).lines, ElementsAre("2"));
}

TEST_F(Sandbox, AProgramHasNoMoreMemoryThanItsBudget) {
  const char* const python = R"(
try: print(len(bytearray(150_000_000)))
except MemoryError: print('MemoryError')
)";
  program.budget.memory_bytes = 200e6;
  EXPECT_THAT(run(python).lines, ElementsAre("150000000"));
  program.budget.memory_bytes = 100e6;
  EXPECT_THAT(run(python).lines, ElementsAre("MemoryError"));
  program.budget.sandbox = false;
  EXPECT_THAT(run(python).lines, ElementsAre("MemoryError"));
}

TEST_F(Sandbox, NothingOfAProgramIsLeft) {
  int process = 0;
  std::vector<int> below;
  {
    auto child = start(R"(
import os, time
if os.fork() == 0:
    os.setsid()
    if os.fork() == 0: time.sleep(1000)
    os._exit(0)
os.wait()
print('ready', flush=True)
time.sleep(1000)
)");
    ASSERT_TRUE(child) << child.error().text();
    process = child->process();
    for (int i = 0; i < 30'000 && !child->take_line(); ++i) {
      child->move();
      std::this_thread::sleep_for(1ms);
    }
    below = processes_below(process);
    EXPECT_EQ(below.size(), 3u);  // bubblewrap's, the program, and the one that it has set free
  }
  for (const int each : below) {
    // Who was not ours to collect may take a moment.
    for (int i = 0; i < 1000 && kill(each, 0) == 0; ++i) std::this_thread::sleep_for(1ms);
    EXPECT_NE(kill(each, 0), 0) << each;
  }
  EXPECT_NE(kill(process, 0), 0);
  EXPECT_EQ(waitpid(-1, nullptr, WNOHANG), -1) << "something was not collected";
}

TEST_F(Sandbox, TheSocketIsTheOnlyWayOut) {
  const char* const python = R"(
import os
print(os.environ['SANDLOT_URL'], os.environ['HELLO'], os.listdir('/run/sandlot'), sorted(os.environ))
)";
  program.environment = {"HELLO=world"};
  const Ran ran = run(python);
  EXPECT_THAT(ran.lines,
              ElementsAre("unix:/run/sandlot/run.sock world [] ['HELLO', 'HOME', 'LANG', 'PATH', 'PWD', "
                          "'PYTHONDONTWRITEBYTECODE', 'PYTHONUNBUFFERED', 'SANDLOT_URL']"))
      << testing::PrintToString(ran.notes);
}

TEST_F(Sandbox, AProgramThatTheSandboxDoesNotShowIsNamed) {
  const Folder other;
  program.command = {other.write("tool", "#!/bin/sh\n")};
  fs::permissions(program.command.front(), fs::perms(0755));
  auto launch = launch_of(program);
  ASSERT_FALSE(launch);
  EXPECT_THAT(launch.error().text(), HasSubstr("the sandbox does not show it"));
  program.command = {"no-such-program"};
  launch = launch_of(program);
  ASSERT_FALSE(launch);
  EXPECT_THAT(launch.error().text(), HasSubstr("there is no such program"));
}

TEST(SandboxMissing, IsOneSentenceAndNoSandboxIsTakenOnlyOnRequest) {
  const Folder folder, empty;
  const std::string before = std::getenv("PATH");
  setenv("PATH", empty.path.c_str(), 1);
  ProgramLaunch program;
  program.command = {"/usr/bin/true"};
  program.folder = folder.path.string();
  const auto launch = launch_of(program);
  program.budget.sandbox = false;
  const auto without = launch_of(program);
  setenv("PATH", before.c_str(), 1);
  ASSERT_FALSE(launch);
  EXPECT_THAT(launch.error().text(),
              testing::AllOf(HasSubstr("there is no bubblewrap"), HasSubstr("sandbox: off")));
  EXPECT_TRUE(without);
}

TEST(SandboxFiles, WhatNobodyCanReadIsRefused) {
  const User nobody{65534, 65534};
  const Folder folder;
  const std::string file = folder.write("file", "");
  fs::permissions(file, fs::perms(0644));
  EXPECT_TRUE(can_read(nobody, file));
  EXPECT_TRUE(can_read(nobody, folder.path.string()));
  fs::permissions(file, fs::perms(0640));
  EXPECT_FALSE(can_read(nobody, file));
  fs::permissions(file, fs::perms(0644));
  fs::permissions(folder.path, fs::perms(0711));
  EXPECT_TRUE(can_read(nobody, file));
  EXPECT_FALSE(can_read(nobody, folder.path.string()));
  fs::permissions(folder.path, fs::perms(0700));
  EXPECT_FALSE(can_read(nobody, file));
  EXPECT_FALSE(can_read(nobody, folder.file("none")));
}

// -------------------------------------------------------------------------------------------------- measuring

/// Child that uses `own` s itself, and lets another one use `other` s, which it collects; then it waits.
Child spender(double own, double other) {
  const std::string python =
      "import os, sys, time\n"
      "def use(s):\n"
      "    while time.process_time() < s: pass\n"
      "if os.fork() == 0: use(" +
      std::to_string(other) +
      "); os._exit(0)\n"
      "os.wait()\nuse(" +
      std::to_string(own) + ")\nprint('spent', flush=True)\ntime.sleep(100)\n";
  auto child = Child::start({"/usr/bin/python3", "-c", python});
  EXPECT_TRUE(child) << child.error().text();
  return std::move(*child);
}

TEST(ProcessMeter, CountsWhatAllProcessesUseOnce) {
  Child child = spender(0.3, 0.4);
  ProcessMeter meter;
  double used_s = 0;
  std::size_t most = 0;
  bool spent = false;
  for (int i = 0; i < 3000 && !spent; ++i) {
    child.move();
    spent = child.take_line().has_value();
    const auto usage = meter.sample(child.process());
    used_s += usage.cpu_s;
    most = std::max(most, usage.processes);
    std::this_thread::sleep_for(20ms);
  }
  // Four counters (user and system of two processes), each cut to 0.01 s; up to 0.05 s for what python uses after the
  // forked one has looked at its clock.
  EXPECT_NEAR(used_s, 0.7, 0.04 + 0.05);
  EXPECT_EQ(most, 2u);
  EXPECT_GT(meter.sample(child.process()).memory_bytes, 1'000'000u);
}

TEST(ProcessMeter, AHaltedTreeUsesNothing) {
  auto child = Child::start({"sh", "-c", "while :; do :; done & while :; do :; done"});
  ASSERT_TRUE(child);
  ProcessMeter meter;
  const auto used = [&](std::chrono::milliseconds wait) {
    meter.sample(child->process());
    std::this_thread::sleep_for(wait);
    return meter.sample(child->process()).cpu_s;
  };
  while (used(50ms) == 0) {}
  halt(child->process(), true);
  std::this_thread::sleep_for(20ms);
  EXPECT_EQ(used(200ms), 0);
  halt(child->process(), false);
  for (int i = 0; i < 100 && used(50ms) == 0; ++i) {}
  EXPECT_GT(used(200ms), 0);
}

}  // namespace
}  // namespace sandlot::programs
