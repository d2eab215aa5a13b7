#include "programs/robios/shared_memory.h"

#include <fcntl.h>
#include <linux/futex.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <new>
#include <utility>

namespace sandlot::programs::robios {
namespace {

using sandlot::robios::Memory;
using sandlot::robios::Turn;

constexpr auto simulator = static_cast<std::uint32_t>(Turn::simulator);
constexpr auto program = static_cast<std::uint32_t>(Turn::program);
constexpr auto ended = static_cast<std::uint32_t>(Turn::ended);

long futex(std::atomic<std::uint32_t>& word, int operation, std::uint32_t value, const timespec* wait) {
  return syscall(SYS_futex, reinterpret_cast<std::uint32_t*>(&word), operation, value, wait, nullptr, 0);
}

}  // namespace

Result<SharedMemory> SharedMemory::make() {
  const auto failed = [] {
    return Error{std::string("cannot make the memory that a RoBIOS program shares: ") + std::strerror(errno)};
  };
  SharedMemory out;
  out.descriptor_ = memfd_create("sandlot-robios", MFD_CLOEXEC | MFD_ALLOW_SEALING);
  if (out.descriptor_ < 0) return failed();
  if (ftruncate(out.descriptor_, sizeof(Memory)) != 0 ||
      fcntl(out.descriptor_, F_ADD_SEALS, F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_SEAL) != 0)
    return failed();
  void* const at = mmap(nullptr, sizeof(Memory), PROT_READ | PROT_WRITE, MAP_SHARED, out.descriptor_, 0);
  if (at == MAP_FAILED) return failed();
  out.memory_ = static_cast<Memory*>(at);  // the kernel has filled it with zeros
  out.memory_->protocol = sandlot::robios::protocol;
  out.memory_->size = sizeof(Memory);
  return out;
}

SharedMemory& SharedMemory::operator=(SharedMemory&& other) noexcept {
  std::swap(memory_, other.memory_);
  std::swap(descriptor_, other.descriptor_);
  return *this;
}

SharedMemory::~SharedMemory() {
  if (memory_) munmap(memory_, sizeof(Memory));
  if (descriptor_ >= 0) close(descriptor_);
}

void SharedMemory::give_turn() {
  memory_->order_bytes = 0;
  memory_->turn.store(program, std::memory_order_release);
  futex(memory_->turn, FUTEX_WAKE, 1, nullptr);
}

void SharedMemory::end() {
  memory_->turn.store(ended, std::memory_order_release);
  futex(memory_->turn, FUTEX_WAKE, 1, nullptr);
}

bool SharedMemory::has_turn() const { return memory_->turn.load(std::memory_order_acquire) == simulator; }

void SharedMemory::await_turn(Clock::time_point until) const {
  const std::uint32_t now = memory_->turn.load(std::memory_order_acquire);
  if (now == simulator) return;
  const auto left = std::chrono::duration_cast<std::chrono::nanoseconds>(until - Clock::now()).count();
  if (left <= 0) return;
  const timespec wait{static_cast<time_t>(left / 1'000'000'000), static_cast<long>(left % 1'000'000'000)};
  futex(memory_->turn, FUTEX_WAIT, now, &wait);
}

std::vector<std::byte> SharedMemory::orders() const {
  const volatile std::uint32_t& given = memory_->order_bytes;
  const std::size_t size = std::min<std::size_t>(given, sandlot::robios::most_order_bytes);
  return {memory_->orders, memory_->orders + size};
}

}  // namespace sandlot::programs::robios
