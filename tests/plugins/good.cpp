/// A plugin as a user would write it; the tests drive robots with it.
#include "control/plugin.h"

#include <stdexcept>

namespace {

/// Turns on the spot, faster with every step, until it has made `steps` of them; then it throws if it was
/// told to.
struct Spinner {
  enum class End { rest, exception, number };
  friend std::span<const sandlot::EnumName<End>> enum_names(End) {
    static constexpr sandlot::EnumName<End> names[] = {
        {"rest", End::rest}, {"exception", End::exception}, {"number", End::number}};
    return names;
  }
  struct Spec {
    double gain_radps = 0.01;
    int steps = 1000;
    End end = End::rest;
    bool fail_at_start = false;
    static void fields(auto& s, auto&& visit) {
      using sandlot::Field;
      visit(Field{"gain", "rad/s", "Rate gained in each step.", 0, 1, Field::tunable}, s.gain_radps);
      visit(Field{"steps", "1", "Steps to make.", 0, 1e6}, s.steps);
      visit(Field{"end", "", "What happens then."}, s.end);
      visit(Field{"fail_at_start", "", "Throw before the first step."}, s.fail_at_start);
    }
  };
  struct State {
    int made = 0;
    static void fields(auto& s, auto&& visit) { visit(sandlot::Field{"made", "1", "Steps made."}, s.made); }
  };
  Spec spec;
  State state;
  sandlot::Actuator<sandlot::msg::Twist> drive;

  sandlot::Status init(const sandlot::Description& robot) {
    if (spec.fail_at_start) throw std::runtime_error("no battery");
    SL_ASSIGN(drive, robot.actuator<sandlot::msg::Twist>(""));
    return {};
  }
  void step(const sandlot::Observation&, sandlot::Command& cmd) {
    if (state.made == spec.steps) {
      if (spec.end == End::exception) throw std::runtime_error("dizzy");
      if (spec.end == End::number) throw 42;
      return;
    }
    sandlot::msg::Twist order;
    order.angular.z = spec.gain_radps * ++state.made;
    cmd.set(drive, order);
  }
};

constexpr sandlot::ControllerKind spinner = sandlot::make_controller<Spinner>(
    {.name = "spinner", .help = "Turns on the spot, faster and faster."});

}  // namespace

SANDLOT_PLUGIN("test_good", &spinner)
