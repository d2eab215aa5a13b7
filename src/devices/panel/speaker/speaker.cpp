/// speaker: makes tones and plays recordings, for the ears of people.
///
/// Command  level `sound`: sandlot_msgs/Sound, ends the sound before it; of several in a tick the last one is heard. A duration
///          of 0 or less is silence; one above `max_duration` is cut to it. A name of more than 200 bytes is refused and counted.
/// Output   level `sound`: sandlot_msgs/SpeakerState when a sound begins and ends, and every second while one lasts.
/// Time     a sound begins with the tick it is ordered in and lasts `duration` of simulated time.
/// Limits   no loudness, no samples: a recording is a name and a length. Robots do not hear it; those that shall use a voice
///          and an ear.
/// Cost     a comparison per tick.
/// Errors   none beyond the ranges of the keys.
#include <algorithm>

#include "base/time.h"
#include "devices/kind.h"
#include "messages/messages.h"

namespace sandlot::speaker {
namespace {

constexpr std::size_t most_name_bytes = 200;

struct Spec {
  double max_duration_s = 60;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"max_duration", "s", "Greatest length of a sound.", 0, 1e6}, s.max_duration_s);
  }
};

struct State {
  std::uint64_t commands = 0, sounds = 0, refused = 0;
  msg::Sound sound;  ///< the latest one
  bool playing = false;
  Time until;         ///< end of the sound while `playing`
  Time published_at;  ///< of the latest message

  static void fields(auto& s, auto&& visit) {
    visit(Field{"commands", "1", "Number of commands so far."}, s.commands);
    visit(Field{"sounds", "1", "Number of sounds so far."}, s.sounds);
    visit(Field{"refused", "1", "Number of commands with a name that is too long."}, s.refused);
    visit(Field{"sound", "", "Latest sound."}, s.sound);
    visit(Field{"playing", "", "Whether the latest sound lasts."}, s.playing);
    visit(Field{"until", "s", "End of the sound."}, s.until);
    visit(Field{"published_at", "s", "Time of the latest message."}, s.published_at);
  }
};

struct Speaker {
  using Spec = speaker::Spec;
  using State = speaker::State;
  Spec spec;
  State state;
  Topic<msg::Sound>* orders = nullptr;
  Topic<msg::SpeakerState>* doing = nullptr;

  static Result<Speaker> create(const DeviceBuild& build, Spec spec) {
    Speaker made{spec, {}};
    made.orders = build.accept<msg::Sound>(0, "sound");
    made.doing = build.publish<msg::SpeakerState>(0, "sound");
    made.doing->message.header.frame_id = build.frame_id();
    return made;
  }

  /// @param from  beginning of the tick
  void play(const msg::Sound& sound, Time from) {
    if (sound.name.size() > most_name_bytes) {
      ++state.refused;
      return;
    }
    // A duration that is not a number is silence, too.
    const double wanted_s = sound.duration > 0 ? sound.duration : 0;
    const Time length = Time::from_s(std::min(wanted_s, spec.max_duration_s));
    state.playing = length.ns > 0;
    if (!state.playing) return;
    ++state.sounds;
    state.sound = sound;
    state.sound.frequency = sound.frequency > 0 ? sound.frequency : 0;
    state.sound.duration = length.s();
    state.until = from + length;
  }

  static void actuate(PoolView<Speaker> pool, const Context& context) {
    for (const std::uint32_t index : pool.due) {
      Speaker& speaker = pool.all[index];
      if (speaker.orders->count == speaker.state.commands) continue;
      speaker.state.commands = speaker.orders->count;
      speaker.play(speaker.orders->message, context.now - context.tick);
    }
  }

  static void sense(PoolView<Speaker> pool, const Context& context) {
    for (const std::uint32_t index : pool.due) {
      Speaker& speaker = pool.all[index];
      State& state = speaker.state;
      msg::SpeakerState& last = speaker.doing->message;
      if (state.playing && state.until <= context.now) state.playing = false;
      const bool goes_on = state.playing && context.now - state.published_at >= Time::from_s(1);
      if (last.playing == state.playing && last.sounds == state.sounds && !goes_on) continue;
      last.playing = state.playing;
      last.sounds = state.sounds;
      last.sound = state.sound;
      speaker.doing->publish(context.now);
      state.published_at = context.now;
    }
  }

  bool fits() const { return state.sound.name.size() <= most_name_bytes; }
};

constexpr LevelInfo levels[] = {
    {"sound", msg::SpeakerState::ros_type, msg::Sound::ros_type, "Tones and recordings."},
};

}  // namespace

extern const Kind kind;
constinit const Kind kind = make_kind<Speaker>({
    .name = "speaker",
    .help = "Speaker that makes tones and plays recordings.",
    .levels = levels,
});

}  // namespace sandlot::speaker
