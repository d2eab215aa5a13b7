/// voice: speaks words into a medium of kind `shout`.
///
/// Order    all words of a tick, first in, first out; at most 100 wait, more are refused.
/// Limits   a word longer than `max_length` is not spoken; `taken` counts it, `spoken` does not.
#include "devices/kind.h"
#include "messages/messages.h"

namespace sandlot::voice {
namespace {

struct Spec {
  std::string medium;
  double loudness_dB = 70;
  int max_length = 200;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"medium", "", "Medium that carries the words; the only one of kind shout if left out.", 0, 0,
                Field::none, 100},
          s.medium);
    visit(Field{"loudness", "dB", "Level at a distance of 1 m.", 0, 200, Field::tunable}, s.loudness_dB);
    visit(Field{"max_length", "1", "Greatest length of a word, in bytes.", 1, 10'000}, s.max_length);
  }
};

struct State {
  std::uint64_t taken = 0;   ///< commands so far
  std::uint64_t spoken = 0;  ///< of them

  static void fields(auto& s, auto&& visit) {
    visit(Field{"taken", "1", "Words that were commanded."}, s.taken);
    visit(Field{"spoken", "1", "Words that were spoken."}, s.spoken);
  }
};

struct Voice {
  using Spec = voice::Spec;
  using State = voice::State;
  Spec spec;
  State state;
  std::uint32_t medium = 0;
  std::uint64_t key = 0;
  BodyId body;
  Vec3 p_LS;
  CommandQueue<msg::String>* words = nullptr;

  static Result<Voice> create(const DeviceBuild& build, Spec spec) {
    Voice v{std::move(spec)};
    SL_ASSIGN(v.medium, build.medium(v.spec.medium, "shout", "medium"));
    v.key = build.key;
    v.body = build.body();
    v.p_LS = build.decl.X_LS.p;
    v.words = build.accept_queue<msg::String>(0, "word", 100);
    return v;
  }

  static void actuate(PoolView<Voice> pool, const Context& context) {
    for (const std::uint32_t index : pool.due) {
      Voice& v = pool.all[index];
      for (; !v.words->empty(); v.words->pop()) v.speak(v.words->front().data, context);
    }
  }

  void speak(const std::string& word, const Context& context) {
    ++state.taken;
    if (word.empty() || word.size() > static_cast<std::size_t>(spec.max_length)) return;
    ++state.spoken;
    context.emissions.emit({.medium = medium,
                            .emitter = key,
                            .body = body,
                            .at = context.now - context.tick,
                            .point_W = context.engine.states()[body.index].X_WB * p_LS,
                            .direction_W = {},
                            .strength = spec.loudness_dB},
                           std::as_bytes(std::span(word)));
  }
};

constexpr LevelInfo levels[] = {
    {"word", "", msg::String::ros_type, "Speaks a word."},
};

}  // namespace

extern const Kind kind;
constinit const Kind kind = make_kind<Voice>({
    .name = "voice",
    .help = "Speaks words that others hear, as far as they carry.",
    .levels = levels,
});

}  // namespace sandlot::voice
