#include "machine.h"

#include <dlfcn.h>
#include <fcntl.h>
#include <linux/futex.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <new>
#include <set>

#include "interpose.h"
#include "screen.h"
#include "tasks.h"

namespace robios {
namespace {

constexpr std::size_t most_messages = 1024;
/// Orders of calls leave this to the screen, which is sent at the end of a turn.
constexpr std::size_t reserved_bytes = 2u << 20;

struct Row {
  const char* name;
  std::int64_t ns;
};
constexpr Row rows[] = {
#define ROBIOS_COST(name, microseconds, reason) {#name, static_cast<std::int64_t>((microseconds)*1000.0)},
#include "costs.def"
#undef ROBIOS_COST
};

alignas(Machine) std::byte machine_place[sizeof(Machine)];  // zeros until attach()
bool finished = false;
int exit_code_sent = 0;
bool exit_called = false;  // otherwise main has returned
bool is_child = false;     // of a fork

void futex_wait(std::atomic<std::uint32_t>& word, std::uint32_t value) {
  syscall(SYS_futex, reinterpret_cast<std::uint32_t*>(&word), FUTEX_WAIT, value, nullptr, nullptr, 0);
}
void futex_wake(std::atomic<std::uint32_t>& word) {
  syscall(SYS_futex, reinterpret_cast<std::uint32_t*>(&word), FUTEX_WAKE, 1, nullptr, nullptr, 0);
}

void put(OrderKind kind, const void* payload, std::size_t size, const void* more, std::size_t more_size) {
  std::byte* const at = machine.memory->orders + machine.order_bytes;
  const OrderHead head{kind, static_cast<std::uint32_t>(size + more_size)};
  const std::size_t whole = (size + more_size + 7) / 8 * 8;
  std::memcpy(at, &head, sizeof(head));
  if (size > 0) std::memcpy(at + sizeof(head), payload, size);
  if (more_size > 0) std::memcpy(at + sizeof(head) + size, more, more_size);
  std::memset(at + sizeof(head) + size + more_size, 0, whole - size - more_size);
  machine.order_bytes += sizeof(head) + whole;
}
std::size_t needed(std::size_t size) { return sizeof(OrderHead) + (size + 7) / 8 * 8; }

/// Reads what came with a new turn.
void take_turn() {
  Machine& m = machine;
  const Senses& s = m.senses();
  m.turns++;
  m.order_bytes = 0;
  m.clock_ns = std::max(m.clock_ns, s.now_ns);
  m.slot_work_ns = m.work_ns;
  const std::uint32_t kept = std::min<std::uint32_t>(s.keys, most_key_presses);
  const std::uint64_t fresh = std::min<std::uint64_t>(kept,
                                                      s.key_presses - std::min(s.key_presses, m.key_presses));
  for (std::uint64_t i = kept - fresh; i < kept; i++) {
    const KeyPress& press = s.key[i];
    const std::uint32_t key = press.key > 0 ? press.key : screen.menu_key(press.x, press.y);
    if (press.key == 0) {
      m.touches.push_back(press);
      if (m.touches.size() > most_key_presses) m.touches.pop_front();
    }
    if (key > 0) {
      m.keys.push_back(key);
      if (m.keys.size() > most_key_presses) m.keys.pop_front();
    }
  }
  m.key_presses = s.key_presses;
  for (std::uint32_t i = 0; i < std::min<std::size_t>(s.radio_messages, most_radio_messages); i++) {
    const RadioMessage& r = s.radio[i];
    if (m.messages.size() >= most_messages) {
      m.lost_messages++;
      note_once("radio", "more than 1024 radio messages wait to be read: further ones are lost");
      continue;
    }
    m.messages.push_back({r.from, {r.bytes, r.bytes + std::min<std::size_t>(r.size, most_radio_bytes)}});
  }
  turn_came();
}

void await_turn() {
  std::atomic<std::uint32_t>& turn = machine.memory->turn;
  for (;;) {
    const std::uint32_t now = turn.load(std::memory_order_acquire);
    if (now == static_cast<std::uint32_t>(Turn::program)) return;
    if (now == static_cast<std::uint32_t>(Turn::ended)) {
      fflush(nullptr);
      _exit(0);
    }
    futex_wait(turn, now);
  }
}
void give_turn() noexcept {
  machine.memory->order_bytes = static_cast<std::uint32_t>(machine.order_bytes);
  machine.memory->turn.store(static_cast<std::uint32_t>(Turn::simulator), std::memory_order_release);
  futex_wake(machine.memory->turn);
}

const char* words_of(int signal) {
  switch (signal) {
    case SIGSEGV: return "the program used memory that is not its own (SIGSEGV), or recursed without end\n";
    case SIGBUS: return "the program used memory that is not there (SIGBUS)\n";
    case SIGFPE: return "the program divided by zero (SIGFPE)\n";
    case SIGILL: return "the program ran into what is not an instruction (SIGILL)\n";
    case SIGABRT: return "the program gave up (abort)\n";
    default: return "the program was ended from outside\n";
  }
}

void on_signal(int signal) {
  const char* words = words_of(signal);
  (void)!write(2, words, std::strlen(words));
  finish(128 + signal);
  ::signal(signal, SIG_DFL);
  raise(signal);
}

void on_leave(int code, void*) {
  if (is_child || finished) return;
  if (!exit_called) main_returns();
  screen.refresh();
  send_screen();
  finish(code);
}

using Main = int (*)(int, char**, char**);
Main program_main = nullptr;

/// Registers on_leave() here: after the program's own exit handlers, which may still drive, and before destructors.
int run_main(int argc, char** argv, char** environment) {
  on_exit(on_leave, nullptr);
  return program_main(argc, argv, environment);
}

__attribute__((constructor)) void attach() {
  new (machine_place) Machine;
  make_screen();
  const char* const variable = getenv(descriptor_variable);
  if (!variable) {
    quit(
        "this is a RoBIOS program: it runs within a simulation of Sandlot, as `program:` of a robot, not by "
        "itself (SANDLOT_ROBIOS_FD is not set)");
  }
  const int descriptor = atoi(variable);
  struct stat status {};
  if (fstat(descriptor, &status) != 0 || status.st_size < static_cast<off_t>(sizeof(Memory)))
    quit("the memory shared with the simulator is missing or too small");
  void* const at = mmap(nullptr, sizeof(Memory), PROT_READ | PROT_WRITE, MAP_SHARED, descriptor, 0);
  if (at == MAP_FAILED) quit("the memory shared with the simulator cannot be mapped");
  close(descriptor);
  unsetenv(descriptor_variable);
  madvise(at, sizeof(Memory), MADV_DONTFORK);
  machine.memory = static_cast<Memory*>(at);
  if (machine.memory->protocol != protocol || machine.memory->size != sizeof(Memory))
    quit("simulator and RoBIOS library are not of the same release of Sandlot");
  // Nobody types, and what is printed shall be seen.
  const int nothing = open("/dev/null", O_RDONLY);
  if (nothing >= 0) {
    dup2(nothing, 0);
    if (nothing != 0) close(nothing);
  }
  setvbuf(stdout, nullptr, _IOLBF, 1 << 12);
  begin_tasks();
  pthread_atfork(nullptr, nullptr, [] {
    is_child = true;
    finished = true;
  });
  struct sigaction action {};
  action.sa_handler = on_signal;
  action.sa_flags = SA_ONSTACK | static_cast<int>(SA_RESETHAND) | SA_NODEFER;
  for (const int signal : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGTERM})
    sigaction(signal, &action, nullptr);
  await_turn();
  machine.start_ns = machine.clock_ns = machine.senses().now_ns;
  machine.key_presses = machine.senses().key_presses;  // older ones are not for this program
  take_turn();
  begin_screen();
}

}  // namespace

Machine& machine = reinterpret_cast<Machine&>(machine_place);

std::int64_t cost_ns(Call call) { return rows[static_cast<int>(call)].ns; }
const char* name_of(Call call) { return rows[static_cast<int>(call)].name; }

void quit(const char* sentence) {
  (void)!write(2, sentence, std::strlen(sentence));
  (void)!write(2, "\n", 1);
  _exit(2);
}

void enter(Call call) {
  if (is_child) _exit(1);  // a fork has no robot
  if (finished) return;
  check_thread();
  pass_time(cost_ns(call));
  let_others_run();
}

void leave_if_finished() {
  if (!finished) return;
  fflush(nullptr);
  _exit(exit_code_sent);
}

void pass_time(std::int64_t ns) {
  Machine& m = machine;
  m.work_ns += ns;
  if (m.robot().delays) {
    m.clock_ns += ns;
  } else if (m.work_ns - m.slot_work_ns >= free_slots * (m.slot_end() - m.senses().now_ns)) {
    m.clock_ns = std::max(m.clock_ns, m.slot_end());
  }
  while (m.clock_ns >= m.slot_end()) hand_over(m.clock_ns, 0);
}

void hand_over(std::int64_t until_ns, std::uint32_t events) {
  leave_if_finished();
  send_screen();
  const WaitOrder wait{until_ns, events, 0};
  put(OrderKind::wait, &wait, sizeof(wait), nullptr, 0);
  give_turn();
  await_turn();
  take_turn();
}

std::size_t room_at_hand_over() { return most_order_bytes - machine.order_bytes - 64; }

void order_at_hand_over(OrderKind kind, const void* payload, std::size_t size, const void* more,
                        std::size_t more_size) {
  if (needed(size + more_size) <= room_at_hand_over()) put(kind, payload, size, more, more_size);
}

void order(OrderKind kind, const void* payload, std::size_t size, const void* more, std::size_t more_size) {
  if (finished) return;
  if (machine.order_bytes + needed(size + more_size) > most_order_bytes - reserved_bytes) {
    note_once("orders", "too many orders in one time slot: the slot ended early");
    machine.clock_ns = std::max(machine.clock_ns, machine.slot_end());
    while (machine.clock_ns >= machine.slot_end()) hand_over(machine.clock_ns, 0);
  }
  put(kind, payload, size, more, more_size);
}

void note(std::string_view text) {
  constexpr std::uint32_t most_notes = 100;
  if (++machine.notes > most_notes) return;
  text = text.substr(0, 1000);
  if (needed(text.size()) <= room_at_hand_over()) put(OrderKind::note, text.data(), text.size(), nullptr, 0);
}

void note_once(const char* what, std::string_view text) {
  static std::set<std::string>* const noted = new std::set<std::string>;
  if (noted->insert(what).second) note(text);
}

void finish(int exit_code) noexcept {
  if (finished || !machine.memory) return;
  if (machine.memory->turn.load() != static_cast<std::uint32_t>(Turn::program)) return;
  finished = true;
  const std::int32_t code = exit_code_sent = exit_code;
  if (needed(sizeof(code)) <= most_order_bytes - machine.order_bytes)
    put(OrderKind::finished, &code, sizeof(code), nullptr, 0);
  give_turn();
}

}  // namespace robios

ROBIOS_INTERPOSE(void, exit, int code) {
  static const auto next = reinterpret_cast<void (*)(int)>(dlsym(RTLD_NEXT, "exit"));
  robios::exit_called = true;
  next(code);
  _exit(code);
}

ROBIOS_INTERPOSE(int, __libc_start_main, robios::Main main, int argc, char** argv, void (*init)(),
                 void (*fini)(), void (*loader_fini)(), void* stack_end) {
  using Start = int (*)(robios::Main, int, char**, void (*)(), void (*)(), void (*)(), void*);
  static const auto next = reinterpret_cast<Start>(dlsym(RTLD_NEXT, "__libc_start_main"));
  robios::program_main = main;
  return next(robios::run_main, argc, argv, init, fini, loader_fini, stack_end);
}
