/// keys: push buttons of a robot, and its touch screen, pressed by people, scripts and clients.
///
/// Command  level `presses`: sandlot_msgs/KeyPress, up to 64 in a tick, in their order: key 1 is the leftmost one, key 0 is a touch
///          at (x, y) of the screen. A key above `count`, and a touch where `touch` is false, is refused and
///          counted.
/// Output   level `presses`: sandlot_msgs/KeyPresses, the 16 latest presses, published in the tick of a press.
/// Time     a press is read in the tick it arrives in. A press has no length: a key is not held.
/// Limits   no bounce, no chords. Labels are those of the screen (ScreenText.menu).
/// Cost     a few comparisons per tick; no allocation.
/// Errors   none beyond the ranges of the keys.
#include <algorithm>

#include "devices/kind.h"
#include "messages/messages.h"

namespace sandlot::keys {
namespace {

constexpr std::size_t most_waiting = 64, most_kept = 16;

struct Spec {
  int count = 4;
  bool touch = true;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"count", "1", "Number of keys.", 0, 64}, s.count);
    visit(Field{"touch", "", "Whether the screen can be touched."}, s.touch);
  }
};

struct State {
  std::uint64_t presses = 0, published = 0, refused = 0;
  std::vector<msg::KeyPress> latest;  ///< the oldest first

  static void fields(auto& s, auto&& visit) {
    visit(Field{"presses", "1", "Number of presses so far."}, s.presses);
    visit(Field{"published", "1", "Number of the press that was published last."}, s.published);
    visit(Field{"refused", "1", "Number of commands for keys that do not exist."}, s.refused);
    visit(Field{"latest", "", "Latest presses, the oldest first."}, s.latest);
  }
};

struct Keys {
  using Spec = keys::Spec;
  using State = keys::State;
  Spec spec;
  State state;
  CommandQueue<msg::KeyPress>* presses = nullptr;
  Topic<msg::KeyPresses>* pressed = nullptr;

  static Result<Keys> create(const DeviceBuild& build, Spec spec) {
    Keys made{spec, {}};
    made.state.latest.reserve(most_kept);
    made.presses = build.accept_queue<msg::KeyPress>(0, "presses", most_waiting);
    made.pressed = build.publish<msg::KeyPresses>(0, "presses");
    made.pressed->message.header.frame_id = build.frame_id();
    made.pressed->message.latest.reserve(most_kept);
    return made;
  }

  void press(const msg::KeyPress& press) {
    if (press.key == 0 ? !spec.touch : press.key > static_cast<std::uint32_t>(spec.count)) {
      ++state.refused;
      return;
    }
    if (state.latest.size() == most_kept) state.latest.erase(state.latest.begin());
    // A key has no place.
    state.latest.push_back(press.key == 0 ? press : msg::KeyPress{press.key, 0, 0});
    ++state.presses;
  }

  static void actuate(PoolView<Keys> pool, const Context&) {
    for (const std::uint32_t index : pool.due) {
      Keys& keys = pool.all[index];
      for (; !keys.presses->empty(); keys.presses->pop()) keys.press(keys.presses->front());
    }
  }

  static void sense(PoolView<Keys> pool, const Context& context) {
    for (const std::uint32_t index : pool.due) {
      Keys& keys = pool.all[index];
      if (keys.state.published == keys.state.presses) continue;
      keys.state.published = keys.state.presses;
      keys.pressed->message.count = keys.state.presses;
      keys.pressed->message.latest = keys.state.latest;
      keys.pressed->publish(context.now);
    }
  }

  bool fits() const {
    return state.latest.size() <= most_kept && state.latest.size() <= state.presses &&
           state.published <= state.presses &&
           std::all_of(state.latest.begin(), state.latest.end(), [&](const msg::KeyPress& press) {
             return press.key <= static_cast<std::uint32_t>(spec.count);
           });
  }
};

constexpr LevelInfo levels[] = {
    {"presses", msg::KeyPresses::ros_type, msg::KeyPress::ros_type, "Presses of keys and touches."},
};

}  // namespace

extern const Kind kind;
constinit const Kind kind = make_kind<Keys>({
    .name = "keys",
    .help = "Push buttons and touch screen that people press.",
    .levels = levels,
});

}  // namespace sandlot::keys
