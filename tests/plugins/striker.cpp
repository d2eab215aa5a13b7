/// The law of tests/striker.py as a controller in the process: the same sums, so that both give the same run.
#include <algorithm>

#include "control/plugin.h"

namespace {

/// Drives at the ball while the game runs, and kicks it when it lies before it.
struct Striker {
  struct Spec {
    static void fields(auto&, auto&&) {}
  };
  struct State {
    double x_m = 0, y_m = 0;
    bool seen = false, runs = false;
    static void fields(auto& s, auto&& visit) {
      using sandlot::Field;
      visit(Field{"x", "m", "Where the ball was seen, ahead."}, s.x_m);
      visit(Field{"y", "m", "Where the ball was seen, to the left."}, s.y_m);
      visit(Field{"seen", "", "Whether it has been seen."}, s.seen);
      visit(Field{"runs", "", "Whether the game runs."}, s.runs);
    }
  };
  Spec spec;
  State state;
  sandlot::Reading<sandlot::msg::ObjectArray> eye;
  sandlot::Reading<sandlot::msg::RefereeState> referee;
  sandlot::Actuator<sandlot::msg::Twist> drive;
  sandlot::Actuator<sandlot::msg::Float64> kicker;

  sandlot::Status init(const sandlot::Description& robot) {
    SL_ASSIGN(eye, robot.reading<sandlot::msg::ObjectArray>("eye"));
    SL_ASSIGN(referee, robot.reading<sandlot::msg::RefereeState>("referee"));
    SL_ASSIGN(drive, robot.actuator<sandlot::msg::Twist>("drive"));
    SL_ASSIGN(kicker, robot.actuator<sandlot::msg::Float64>("kicker"));
    return {};
  }
  void step(const sandlot::Observation& obs, sandlot::Command& cmd) {
    if (const auto words = obs.get(referee); words.valid && words.fresh)
      state.runs = words.message.phase == "running";
    if (const auto sight = obs.get(eye); sight.valid && sight.fresh)
      for (const auto& thing : sight.message.objects)
        if (thing.label == "ball")
          state.x_m = thing.position.x, state.y_m = thing.position.y, state.seen = true;
    sandlot::msg::Twist order;
    if (state.runs && state.seen) {
      order.linear.x = std::clamp(0.3 * state.x_m, -2.0, 2.0);
      order.linear.y = std::clamp(0.3 * state.y_m, -2.0, 2.0);
      order.angular.z = std::clamp(3.0 * state.y_m, -3.0, 3.0);
    }
    cmd.set(drive, order);
    if (state.runs && state.seen && 0 < state.x_m && state.x_m < 0.45 && -0.15 < state.y_m &&
        state.y_m < 0.15)
      cmd.set(kicker, sandlot::msg::Float64{2.5});
  }
};

constexpr sandlot::ControllerKind striker = sandlot::make_controller<Striker>(
    {.name = "striker", .help = "Drives at the ball and kicks it when it lies before it."});

}  // namespace

SANDLOT_PLUGIN("test_striker", &striker)
