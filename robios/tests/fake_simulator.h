#pragma once
/// Simulator's side of slot.h for tests: a robot on an empty plane that covers its ways exactly, with scripted senses.
#include <sys/types.h>

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "programs/robios/slot.h"

namespace fake {

using namespace sandlot::robios;

inline constexpr std::int64_t millisecond = 1'000'000;

struct Order {
  OrderKind kind;
  std::int64_t slot_ns;
  std::string payload;
  template <class T>
  T as() const {
    T value{};
    payload.copy(reinterpret_cast<char*>(&value), sizeof(value));
    return value;
  }
};

struct Result {
  int exit_code = -1;  ///< 128 + signal
  int finished = -1;   ///< code of the last order; -1: there was none
  std::int64_t end_ns = 0;
  int turns = 0;
  std::string output, errors;
  std::vector<Order> orders;
  std::vector<Order> of(OrderKind kind) const;
};

class Simulator {
 public:
  Simulator();
  ~Simulator();
  Simulator(const Simulator&) = delete;

  Robot& robot() { return memory_->robot; }
  Senses& senses() { return memory_->senses; }
  Memory& memory() { return *memory_; }
  /// Inputs by the beginning of the slot that they come in.
  void press(std::int64_t ns, std::uint32_t key, std::int32_t x = 0, std::int32_t y = 0) {
    presses_.emplace(ns, KeyPress{key, x, y});
  }
  void receive(std::int64_t ns, std::uint32_t from, std::string text) {
    messages_.emplace(ns, std::pair(from, text));
  }
  void paint(std::uint32_t width, std::uint32_t height,
             const std::function<std::array<int, 3>(int, int)>& color);

  /// Runs until the program's end, or for `most_s` of simulated time.
  Result run(const std::string& program, const std::vector<std::string>& arguments = {}, double most_s = 60);

  std::function<void(std::int64_t now_ns)> on_slot;  ///< at the beginning of each slot
  std::int64_t slot_ns = 50 * millisecond;
  bool listens = true;  ///< false: pictures are not taken, ways not begun
  // What the screen shows.
  std::map<std::pair<int, int>, int> pixels;
  std::vector<std::string> menu, lines;
  int pixel(int x, int y) const;

 private:
  void step(std::int64_t now_ns);
  bool take_orders(Result& result);
  void apply(const Order& order);
  std::uint32_t inputs(std::int64_t now_ns);

  int descriptor_ = -1;
  Memory* memory_ = nullptr;
  std::multimap<std::int64_t, KeyPress> presses_;
  std::multimap<std::int64_t, std::pair<std::uint32_t, std::string>> messages_;
  double v_ = 0, w_ = 0;
  bool way_ = false, picture_ = false;
  ManeuverOrder maneuver_{};
  double left_s_ = 0, whole_s_ = 0;
  std::array<double, most_motors> motor_{};
  std::int64_t until_ns_ = 0;
  std::uint32_t events_ = 0;
};

/// Compiles a program of robios/tests/programs with the C compiler; the path of the executable, or what the compiler wrote.
std::string compile(const std::string& source, int generation, const std::string& flags = "");
bool compiles(const std::string& command, std::string* errors = nullptr);
std::string scratch();  ///< folder of this process

}  // namespace fake
