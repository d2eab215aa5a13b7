/// Program that speaks programs/robios/slot.h itself, compiled by tests: what it does is its file's name.
#include <fcntl.h>
#include <linux/futex.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>

#include "programs/robios/slot.h"

using namespace sandlot::robios;

namespace {

Memory* memory = nullptr;

void futex(int operation, std::uint32_t value) {
  syscall(SYS_futex, reinterpret_cast<std::uint32_t*>(&memory->turn), operation, value, nullptr, nullptr, 0);
}

void await_turn() {
  for (std::uint32_t now; (now = memory->turn.load()) != static_cast<std::uint32_t>(Turn::program);) {
    if (now == static_cast<std::uint32_t>(Turn::ended)) _exit(0);
    futex(FUTEX_WAIT, now);
  }
  memory->order_bytes = 0;
}

void give_turn() {
  memory->turn.store(static_cast<std::uint32_t>(Turn::simulator));
  futex(FUTEX_WAKE, 1);
}

void add(OrderKind kind, const void* payload, std::size_t size, std::uint32_t said) {
  const OrderHead head{kind, said};
  std::memcpy(memory->orders + memory->order_bytes, &head, sizeof head);
  if (size > 0) std::memcpy(memory->orders + memory->order_bytes + sizeof head, payload, size);
  memory->order_bytes += static_cast<std::uint32_t>(sizeof head + (size + 7) / 8 * 8);
}
template <class T>
void add(OrderKind kind, const T& payload) {
  add(kind, &payload, sizeof payload, sizeof payload);
}

int recurse(int depth) {
  volatile char room[4096];
  room[depth % 4096] = 1;
  return recurse(depth + 1) + room[(depth + 1) % 4096];
}

}  // namespace

int main(int, char** words) {
  const std::string path = words[0], mode = path.substr(path.rfind('/') + 1);
  const char* const number = std::getenv(descriptor_variable);
  if (!number) return 2;
  memory = static_cast<Memory*>(
      mmap(nullptr, sizeof(Memory), PROT_READ | PROT_WRITE, MAP_SHARED, std::atoi(number), 0));
  if (memory == MAP_FAILED || memory->protocol != protocol || memory->size != sizeof(Memory)) return 3;
  std::int64_t before = -1;
  for (int turn = 1;; ++turn) {
    await_turn();
    const Senses& senses = memory->senses;
    WaitOrder wait{senses.slot_end_ns, 0, 0};
    if (senses.now_ns <= before || senses.slot_end_ns <= senses.now_ns) return 4;
    before = senses.now_ns;
    if (mode == "drive") add(OrderKind::speed, SpeedOrder{0.01 * turn, 0.001 * senses.beams});
    if (mode == "waiter") {
      add(OrderKind::speed, SpeedOrder{0.1, 0});
      wait.until_ns = turn == 1 ? 430'000'000 : INT64_MAX;
      wait.events = turn == 1 ? wake_key | wake_picture : 0;
    }
    if (mode == "pose") {
      // Its own place is 3 m, 4 m, whatever the drive counted; later it is where it drove from there.
      if (turn == 20) add(OrderKind::set_pose, PoseOrder{3, 4, 0});
      if (turn == 21 && std::hypot(senses.x_m - 3, senses.y_m - 4) > 0.02) return 5;
      add(OrderKind::speed, SpeedOrder{0.2, 0});
    }
    if (mode == "supervise") {
      const EntityPose& crate = senses.entity[1];
      if (senses.entities != 3 || crate.is_robot || crate.id != 2) return 6;
      if (turn == 2) add(OrderKind::set_entity, EntityPose{2, 0, 2.5, 2.5, 0.2, 0});
      if (turn == 5 && std::hypot(crate.x_m - 2.5, crate.y_m - 2.5) > 0.01) return 7;
    }
    if (mode == "nan") add(OrderKind::speed, SpeedOrder{NAN, 0});
    if (mode == "radio") {
      static char bytes[60000];
      add(OrderKind::radio, bytes, sizeof bytes, sizeof bytes);
    }
    if (mode == "screen") add(OrderKind::screen, ScreenOrder{4000000000u, 7, 4000000000u, 9});
    if (mode == "lie") add(OrderKind::note, "x", 1, 4000000000u);
    if (mode == "flood")
      for (int i = 0; i < 50'000; ++i) std::puts("a line that nobody wants to read");
    if (turn >= 3) {
      std::fflush(stdout);
      if (mode == "finish") {
        add(OrderKind::finished, std::int32_t{7});
        give_turn();
        return 7;
      }
      if (mode == "return" || mode == "kill" || mode == "abort")
        std::fputs("these are my last words\n", stderr);
      if (mode == "return") return 9;
      if (mode == "kill") raise(SIGKILL);
      if (mode == "abort") std::abort();
      if (mode == "spin")
        for (volatile int i = 0;; i = i + 1) {}
      if (mode == "recursion") return recurse(0);
      if (mode == "double_free") {
        void* volatile room = std::malloc(100);
        std::free(room);
        std::free(room);
      }
      if (mode == "burn" && turn == 3) {
        const pid_t child = fork();
        if (child == 0)
          for (;;) {}
        std::printf("burner %d\n", static_cast<int>(child));
        std::fflush(stdout);
      }
      if (mode == "fork")
        for (int i = 0; i < 100'000; ++i) {
          const pid_t child = fork();
          if (child < 0) break;
        }
      if (mode == "shorten")
        for (int fd = 3; fd < 64; ++fd) [[maybe_unused]] const int result = ftruncate(fd, 0);
      if (mode == "scribble") {
        std::memset(static_cast<void*>(&memory->robot), 0xff, sizeof(Robot));
        std::memset(static_cast<void*>(memory->orders), 0xff, most_order_bytes);
        memory->protocol = memory->size = memory->order_bytes = 0xffffffff;
        give_turn();
        continue;
      }
    }
    add(OrderKind::wait, wait);
    give_turn();
  }
}
