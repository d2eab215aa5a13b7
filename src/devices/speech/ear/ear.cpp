/// ear: hears the words that a medium of kind `shout` delivers.
#include "devices/kind.h"
#include "messages/messages.h"

namespace sandlot::ear {
namespace {

constexpr std::size_t most_words = 1000;

struct Spec {
  std::string medium;
  double rate_hz = 0;
  double threshold_dB = 0;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"medium", "", "Medium that carries the words; the only one of kind shout if left out.", 0, 0,
                Field::none, 100},
          s.medium);
    visit(Field{"rate", "Hz", "Samples per second; 0: one per tick.", 0, 1e6}, s.rate_hz);
    visit(Field{"threshold", "dB", "Level below which this ear hears nothing.", -200, 300, Field::tunable},
          s.threshold_dB);
  }
};

struct Ear {
  using Spec = ear::Spec;
  using State = NoFields;
  Spec spec;
  State state;
  BodyId body;
  Quat q_LS;
  Inbox* inbox = nullptr;
  Topic<msg::HeardArray>* heard = nullptr;

  static Result<Ear> create(const DeviceBuild& build, Spec spec) {
    Ear e{std::move(spec)};
    SL_ASSIGN(const std::uint32_t medium, build.medium(e.spec.medium, "shout", "medium"));
    e.body = build.body();
    e.q_LS = build.decl.X_LS.q;
    e.inbox = build.receive(medium, most_words);
    e.heard = build.publish<msg::HeardArray>(0, "heard");
    e.heard->message.header.frame_id = build.frame_id();
    return e;
  }

  static void sense(PoolView<Ear> pool, const Context& context) {
    for (const std::uint32_t index : pool.due) {
      Ear& e = pool.all[index];
      const Quat q_SW = conjugate(context.engine.states()[e.body.index].X_WB.q * e.q_LS);
      std::vector<msg::Heard>& words = e.heard->message.words;
      std::size_t used = 0;
      for (const Received& received : e.inbox->items()) {
        const DeliveryHead& delivery = received.head;
        const std::span<const std::uint8_t> payload = received.payload();
        if (delivery.strength < e.spec.threshold_dB) continue;
        if (used == words.size()) words.emplace_back();
        msg::Heard& word = words[used++];
        word.text.assign(payload.begin(), payload.end());
        word.stamp = delivery.at;
        word.level = delivery.strength;
        word.direction = rotate(q_SW, delivery.direction_W);
      }
      words.resize(used);
      e.inbox->clear();
      e.heard->publish(context.now);
    }
  }
};

constexpr LevelInfo levels[] = {
    {"heard", msg::HeardArray::ros_type, "", "Words that arrived since the sample before."},
};

}  // namespace

extern const Kind kind;
constinit const Kind kind = make_kind<Ear>({
    .name = "ear",
    .help = "Hears the words that others speak, with their level and direction.",
    .levels = levels,
});

}  // namespace sandlot::ear
