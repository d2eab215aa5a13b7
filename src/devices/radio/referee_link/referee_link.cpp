/// referee_link: words of a referee, and how the game stands, as a robot of soccer receives them.
///
/// Command  level `command`: sandlot_msgs/RefereeCommand, from the rule `referee` or a person. At every level `state`:
///          sandlot_msgs/RefereeState.
/// Output   `command`: each word once, one per tick; `state`: how the game stands, whenever the referee reports it.
/// Time     the end of the tick in which it came.
/// Limits   no loss, no delay of its own (the keys `delay` and `max_rate` of every device do that); at most 32 words wait.
/// Cost     none while nothing comes.
#include "devices/kind.h"
#include "messages/messages.h"

namespace sandlot::referee_link {
namespace {

constexpr std::size_t most_words = 32;
constexpr std::uint32_t always = 1;  ///< beyond the levels

struct Spec {
  static void fields(auto&, auto&&) {}
};

struct State {
  std::uint64_t received = 0;  ///< words so far
  std::uint64_t reports = 0;   ///< reports seen

  static void fields(auto& s, auto&& visit) {
    visit(Field{"received", "1", "Words received so far."}, s.received);
    visit(Field{"reports", "1", "Reports of the game received so far."}, s.reports);
  }
};

struct RefereeLink {
  using Spec = referee_link::Spec;
  using State = referee_link::State;
  Spec spec;
  State state;
  CommandQueue<msg::RefereeCommand>* words = nullptr;
  Topic<msg::RefereeState>* report = nullptr;
  Topic<msg::RefereeCommand>* word_topic = nullptr;
  Topic<msg::RefereeState>* state_topic = nullptr;

  static Result<RefereeLink> create(const DeviceBuild& build, Spec spec) {
    RefereeLink link{spec, {}};
    link.words = build.accept_queue<msg::RefereeCommand>(0, "command", most_words);
    link.report = build.accept<msg::RefereeState>(always, "state");
    link.word_topic = build.publish<msg::RefereeCommand>(0, "command");
    link.state_topic = build.publish<msg::RefereeState>(always, "state");
    return link;
  }

  static void actuate(PoolView<RefereeLink>, const Context&) {}

  static void sense(PoolView<RefereeLink> pool, const Context& context) {
    for (const std::uint32_t index : pool.due) {
      RefereeLink& link = pool.all[index];
      if (link.report->count != link.state.reports) {
        link.state.reports = link.report->count;
        link.state_topic->message = link.report->message;
        link.state_topic->publish(context.now);
      }
      if (link.words->empty()) continue;
      link.word_topic->message = link.words->front();
      link.words->pop();
      ++link.state.received;
      link.word_topic->publish(context.now);
    }
  }
};

constexpr LevelInfo levels[] = {
    {"command", msg::RefereeCommand::ros_type, msg::RefereeCommand::ros_type, "Words of the referee."},
};

}  // namespace

extern const Kind kind;
constinit const Kind kind = make_kind<RefereeLink>({
    .name = "referee_link",
    .help = "Receiver of the words of a referee of robot soccer, and of how the game stands.",
    .levels = levels,
});

}  // namespace sandlot::referee_link
