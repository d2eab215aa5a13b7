#pragma once
/// The controller that a program runs on: its memory shared with the simulator, its clock, its orders, its inputs.
///
/// Clock     virtual time of the program [ns]. Each call adds its cost (costs.def); native code is free. A clock that leaves the
///           time slot hands the turn over until the slot that holds it. With delays off calls add nothing, but a slot ends at
///           the latest when its calls would have cost `free_slots` slots, so that every loop over calls ends.
/// Threads   one runs at a time (tasks.h): nothing here is locked.
#include <cstdint>
#include <deque>
#include <string>
#include <string_view>
#include <vector>

#include "programs/robios/slot.h"

namespace robios {

using namespace sandlot::robios;

inline constexpr std::int64_t never = INT64_MAX;
inline constexpr std::int64_t microsecond = 1'000, millisecond = 1'000'000, second = 1'000'000'000;
inline constexpr int free_slots = 4;

/// Functions that cost time, by name.
enum class Call : int {
#define ROBIOS_COST(name, microseconds, reason) name,
#include "costs.def"
#undef ROBIOS_COST
  count
};
std::int64_t cost_ns(Call call);
const char* name_of(Call call);

struct Message {
  std::uint32_t from;
  std::vector<std::uint8_t> bytes;
};

struct Machine {
  Memory* memory = nullptr;
  std::int64_t clock_ns = 0, start_ns = 0;
  std::int64_t work_ns = 0;       ///< what the calls so far cost, or would
  std::int64_t slot_work_ns = 0;  ///< `work_ns` at the beginning of the slot
  std::uint64_t turns = 0;
  std::size_t order_bytes = 0;
  std::uint32_t notes = 0;
  // Inputs that came and were not read.
  std::uint64_t key_presses = 0;
  std::deque<std::uint32_t> keys;
  std::deque<KeyPress> touches;
  std::deque<Message> messages;
  std::uint64_t lost_messages = 0;

  const Robot& robot() const { return memory->robot; }
  const Senses& senses() const { return memory->senses; }
  std::int64_t slot_end() const { return memory->senses.slot_end_ns; }
};
extern Machine& machine;  ///< made by attach(), never destroyed: programs call functions until their very end

/// First of every call: the thread is known, its time has passed. May hand the turn over and let other threads run.
void enter(Call call);
/// Adds `ns` to the clock; hands the turn over as often as the clock says.
void pass_time(std::int64_t ns);

/// Ends the process if its last order is given: destructors that run after it may call functions, but not wait.
void leave_if_finished();

/// Gives the turn to the simulator, with what the program waits for; returns in the next one.
void hand_over(std::int64_t until_ns, std::uint32_t events);

/// Adds an order; ends the slot first if there is no room.
void order(OrderKind kind, const void* payload, std::size_t size, const void* more = nullptr,
           std::size_t more_size = 0);
template <class T>
void order(OrderKind kind, const T& payload) {
  order(kind, &payload, sizeof(payload));
}
/// Room for an order that hand_over itself adds.
std::size_t room_at_hand_over();
void order_at_hand_over(OrderKind kind, const void* payload, std::size_t size, const void* more = nullptr,
                        std::size_t more_size = 0);
/// Adds a line to the run's log; the first 100 of a program count.
void note(std::string_view text);
/// The same, once per `what`.
void note_once(const char* what, std::string_view text);

/// Last order. The simulator gives no further turn.
void finish(int exit_code) noexcept;
[[noreturn]] void quit(const char* sentence);

}  // namespace robios
