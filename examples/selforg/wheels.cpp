/// A two-wheeler that finds its own behaviour, in a plain program: the robot is fifty lines of our own, there is no simulator.
///
///   wheels [--steps N] [--seed N] [--controller KIND] [--set NAME=NUMBER] [--log FILE] [--load FILE] [--store FILE]
///   wheels --console on                                      runs on, with a console on the terminal: help
///   wheels --console paused                                  the same, but waits for `run` or `step N`
///
/// Sensors   the speeds of the two wheels. Motors   their desired speeds. The wheels follow with a lag; at the walls of the arena
/// they stall, which the sensors show and the world model has to learn.
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <thread>

#include <sandlot/selforg.h>

using namespace sandlot;

/// Two wheels at +-0.1 m, at most 0.5 m/s, in a square arena of 4 m.
class TwoWheeler final : public selforg::Robot {
 public:
  std::size_t sensors() const override { return 2; }
  std::size_t motors() const override { return 2; }
  void read_sensors(std::span<double> x) override {
    x[0] = left_ / top_mps;
    x[1] = right_ / top_mps;
  }
  void set_motors(std::span<const double> y) override {
    wanted_left_ = top_mps * y[0];
    wanted_right_ = top_mps * y[1];
  }
  void move(double dt_s) {
    left_ += (wanted_left_ - left_) * dt_s / lag_s;
    right_ += (wanted_right_ - right_) * dt_s / lag_s;
    const double speed = (left_ + right_) / 2;
    // The heading as a unit vector, turned by a rotation of exactly unit length: no sine, so the same bits everywhere.
    const double half = (right_ - left_) / track_m * dt_s / 2;
    const double c = (1 - half * half) / (1 + half * half), s = 2 * half / (1 + half * half);
    const double hx = hx_ * c - hy_ * s;
    hy_ = hx_ * s + hy_ * c;
    hx_ = hx;
    const double x = x_m + hx_ * speed * dt_s, y = y_m + hy_ * speed * dt_s;
    if (std::abs(x) < half_arena_m && std::abs(y) < half_arena_m) {
      x_m = x;
      y_m = y;
      way_m += std::abs(speed) * dt_s;
    } else {
      left_ *= 0.5;  // it pushes against the wall
      right_ *= 0.5;
      ++touches;
    }
  }
  double x_m = 0, y_m = 0, way_m = 0;
  long touches = 0;

 private:
  static constexpr double top_mps = 0.5, lag_s = 0.05, track_m = 0.2, half_arena_m = 2;
  double left_ = 0, right_ = 0, wanted_left_ = 0, wanted_right_ = 0, hx_ = 1, hy_ = 0;
};

namespace {

void or_exit(const Status& status) {
  if (status) return;
  std::fprintf(stderr, "%s\n", status.error().text().c_str());
  std::exit(2);
}

[[noreturn]] void usage() {
  std::fprintf(stderr,
               "usage: wheels [--steps N] [--seed N] [--controller KIND] [--set NAME=NUMBER] [--log FILE] "
               "[--load FILE] [--store FILE] [--console on|paused]\n");
  std::exit(2);
}

double number(const char* text) {
  char* end = nullptr;
  const double value = std::strtod(text, &end);
  if (end == text || *end != 0 || !std::isfinite(value)) usage();
  return value;
}

}  // namespace

int main(int argc, char** argv) {
  long steps = 6000;
  std::string log, load, store, console;
  std::vector<std::pair<std::string, double>> parameters;
  selforg::AgentSpec spec;
  for (int i = 1; i < argc; i += 2) {
    if (i + 1 >= argc) usage();
    const std::string key = argv[i], value = argv[i + 1];
    if (key == "--steps") steps = static_cast<long>(number(argv[i + 1]));
    else if (key == "--seed") spec.seed = static_cast<std::uint64_t>(number(argv[i + 1]));
    else if (key == "--controller") spec.controller = value;
    else if (key == "--log") log = value;
    else if (key == "--load") load = value;
    else if (key == "--store") store = value;
    else if (key == "--console" && (value == "on" || value == "paused")) console = value;
    else if (key == "--set" && value.find('=') != std::string::npos)
      parameters.emplace_back(value.substr(0, value.find('=')), number(value.c_str() + value.find('=') + 1));
    else usage();
  }

  TwoWheeler robot;
  auto made = selforg::make_agent(robot, spec);
  if (!made) or_exit(Status(std::move(made).error()));
  selforg::Agent& agent = **made;
  if (!load.empty()) or_exit(agent.wired().load(load));
  for (const auto& [name, value] : parameters) or_exit(agent.set(name, value));
  if (!log.empty()) or_exit(agent.start_log(log));

  constexpr double dt_s = 0.02;
  const auto step = [&] {
    agent.step(dt_s);
    robot.move(dt_s);
  };
  if (console.empty()) {
    for (long k = 0; k < steps; ++k) step();
  } else {
    selforg::Terminal terminal(agent, {.paused = console == "paused", .prompt = isatty(0) != 0});
    while (terminal.serve()) {
      step();
      if (console == "on") std::this_thread::sleep_for(std::chrono::duration<double>(dt_s));  // real time
    }
  }
  or_exit(agent.stop_log());
  if (!store.empty()) or_exit(agent.wired().store(store));
  // Hexadecimal: all bits.
  std::printf("%s: %.1f m in %.0f s, %ld steps at walls, ends at %a %a\n", spec.controller.c_str(),
              robot.way_m, agent.time_s(), robot.touches, robot.x_m, robot.y_m);
}
