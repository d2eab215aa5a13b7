#pragma once
/// Text display: a small screen of lines, as robots carry it to show their state.
///
/// Command  level `text`: std_msgs/String. Up to 64 orders of a tick are printed one behind the other, in their order. "\n"
///          begins a line, "\f" clears the screen; a line that is full goes on in the next one; above a full screen lines
///          scroll off.
/// Output   level `text`: std_msgs/String, the lines of the screen separated by "\n", `rate` times per second.
/// Service  clear (std_srvs/Trigger): an empty screen.
/// Time     an order is printed in its tick.
/// Limits   characters are code points of one width; no fonts, colours, graphics or cursor; control characters but those above
///          are left out. Cameras do not see it.
/// Cost     a copy of the screen per sample; no allocation once lines have had their length.
/// Errors   none beyond the ranges of the keys.
#include "devices/kind.h"
#include "messages/device_services.h"
#include "messages/messages.h"

namespace sandlot::text_display {

struct Spec {
  int rows = 8, columns = 21;
  double rate_hz = 10;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"rows", "1", "Number of lines.", 1, 200}, s.rows);
    visit(Field{"columns", "1", "Characters per line.", 1, 400}, s.columns);
    visit(Field{"rate", "Hz", "Messages per second; 0: one in every tick.", 0, 1e5}, s.rate_hz);
  }
};

struct State {
  std::vector<std::string> lines;  ///< from the top; the last one is written on

  static void fields(auto& s, auto&& visit) { visit(Field{"lines", "", "Lines on the screen."}, s.lines); }
};

struct Display {
  using Spec = text_display::Spec;
  using State = text_display::State;
  Spec spec;
  State state;
  CommandQueue<msg::String>* orders = nullptr;
  Topic<msg::String>* screen = nullptr;

  static Result<Display> create(const DeviceBuild& build, Spec spec);
  static void actuate(PoolView<Display> pool, const Context& context);
  static void sense(PoolView<Display> pool, const Context& context);
  bool fits() const;
  void print(std::string_view text);
  Result<msg::std_srvs::Trigger::Response> clear(const msg::std_srvs::Trigger::Request&, const Context&);
};

extern const Kind kind;

}  // namespace sandlot::text_display
