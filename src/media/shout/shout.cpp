/// shout: words that carry as far as they are loud.
///
/// Level      received = emitted at 1 m - 20 log10(distance / 1 m) - wall_loss, where something stands in the straight line;
///            nearer than 1 m the level stays that of 1 m. What is fainter than `threshold` is not heard.
/// Time       distance / speed, heard in the tick in which it arrives; speed 0: at once.
/// Limits     nobody is drowned out by others; walls neither reflect nor let sound around their edges; the receiver's own motion
///            while the word is under way does not count. A body of the speaker other than the one that carries the device is a
///            wall.
/// Cost       one ray per word and receiver in reach; a grid finds those. Words are shared by all threads. 1,000 voices and ears
///            on 100 m x 100 m (planar, one thread), all speaking in one tick: 2 ms where a word carries 3 m and 19 ms at 10 m,
///            against 65 ms and 76 ms when every receiver is asked; 0.9 s at 100 m, where all are in reach, which are rays.
#include <algorithm>
#include <numbers>

#include "base/math.h"
#include "media/medium.h"
#include "media/places.h"
#include "physics/parallel.h"

namespace sandlot::media::shout {
namespace {

constexpr std::size_t most_under_way = 10'000;

struct Spec {
  double speed_mps = 343;
  double threshold_dB = 30;
  double wall_loss_dB = 20;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"speed", "m/s", "Speed at which words spread; 0: at once.", 0, 1e9}, s.speed_mps);
    visit(Field{"threshold", "dB", "Level below which nothing is heard.", -200, 300, Field::tunable},
          s.threshold_dB);
    visit(
        Field{"wall_loss", "dB", "Loss where something stands in the straight line.", 0, 500, Field::tunable},
        s.wall_loss_dB);
  }
};

/// A word on its way to one receiver.
struct UnderWay {
  std::uint64_t receiver = 0;
  Delivery delivery;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"receiver", "", "Key of the device that will hear it."}, s.receiver);
    visit(Field{"delivery", "", "What it will hear."}, s.delivery);
  }
};

struct State {
  std::vector<UnderWay> under_way;  ///< by arrival
  std::uint64_t words = 0, heard = 0, lost = 0;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"under_way", "", "Words that have not arrived yet."}, s.under_way);
    visit(Field{"words", "1", "Words spoken."}, s.words);
    visit(Field{"heard", "1", "Words delivered, each receiver counted."}, s.heard);
    visit(Field{"lost", "1", "Words lost because too many were under way."}, s.lost);
  }
};

/// Whom one word reaches. Kept for its memory.
struct Reached {
  std::vector<std::uint32_t> receivers;
  std::vector<Vec3> directions;
  std::vector<double> distances;
  std::vector<float> hit_m;
  std::vector<std::uint32_t> hit_bodies;
};

struct Shout {
  using Spec = shout::Spec;
  using State = shout::State;
  Spec spec;
  State state;
  Places places;
  std::vector<Reached> reached;

  Status init(const ElementBuild&) { return {}; }
  bool fits() const {
    return state.under_way.size() <= most_under_way &&
           std::is_sorted(state.under_way.begin(), state.under_way.end(), by_arrival);
  }
  static bool by_arrival(const UnderWay& a, const UnderWay& b) { return a.delivery.at < b.delivery.at; }

  static double level_dB(double at_1m_dB, double distance_m) {
    return at_1m_dB - 20 / std::numbers::ln10 * math::log(std::max(1.0, distance_m));
  }

  /// Finds whom a word reaches, and what stands between. Called in parallel.
  void look(const Emission& word, const MediumContext& context, Reached& to) const {
    to.directions.clear();
    to.distances.clear();
    to.receivers.clear();
    if (level_dB(word.strength, 0) < spec.threshold_dB) return;
    // A little farther than the level carries, so that rounding leaves nobody out: the level itself decides.
    const double carries_m = math::exp((word.strength - spec.threshold_dB) * std::numbers::ln10 / 20);
    places.find_within(word.point_W, 1.001 * carries_m, to.receivers);
    double farthest_m = 0;
    const auto is_out = [&](std::uint32_t index) {
      if (context.receivers[index].body == word.body) return true;  // its own voice
      const Vec3 way = places.point(index) - word.point_W;
      const double distance_m = norm(way);
      if (level_dB(word.strength, distance_m) < spec.threshold_dB) return true;
      to.directions.push_back(distance_m > 0 ? way * (1 / distance_m) : Vec3{1, 0, 0});
      to.distances.push_back(distance_m);
      farthest_m = std::max(farthest_m, distance_m);
      return false;
    };
    std::erase_if(to.receivers, is_out);
    if (to.receivers.empty()) return;
    to.hit_m.resize(to.receivers.size());
    to.hit_bodies.resize(to.receivers.size());
    const RayJob job{.X_WS = {word.point_W, {}},
                     .directions = to.directions,
                     .max_m = farthest_m,
                     .ignore_body = word.body.index,
                     .distance_m = to.hit_m,
                     .body = to.hit_bodies};
    context.rays.cast({&job, 1});
  }

  /// Sends a word to those whom it reaches.
  void send(const Emission& word, const MediumContext& context, const Reached& to) {
    ++state.words;
    for (std::size_t i = 0; i < to.receivers.size(); ++i) {
      const Receiver& receiver = context.receivers[to.receivers[i]];
      const bool wall = to.hit_m[i] < to.distances[i] && to.hit_bodies[i] != receiver.body.index;
      const double level = level_dB(word.strength, to.distances[i]) - (wall ? spec.wall_loss_dB : 0);
      if (level < spec.threshold_dB) continue;
      if (state.under_way.size() >= most_under_way) {
        ++state.lost;
        continue;
      }
      const double delay_s = spec.speed_mps > 0 ? to.distances[i] / spec.speed_mps : 0;
      const std::span<const std::byte> bytes = context.buffer.bytes(word);
      const auto* const first = reinterpret_cast<const std::uint8_t*>(bytes.data());
      state.under_way.push_back({receiver.key,
                                 {{.at = word.at + Time::from_s(delay_s),
                                   .emitter = word.emitter,
                                   .channel = word.channel,
                                   .strength = level,
                                   .direction_W = to.directions[i] * -1.0},
                                  {first, first + bytes.size()}}});
    }
  }

  /// In blocks, so that memory stays bounded.
  void spread(const MediumContext& context) {
    constexpr std::size_t most_at_once = 64;
    if (context.emissions.empty()) return;
    places.update(context);
    for (std::size_t first = 0; first < context.emissions.size(); first += most_at_once) {
      const auto words = context.emissions.subspan(first,
                                                   std::min(most_at_once, context.emissions.size() - first));
      reached.resize(std::max(reached.size(), words.size()));
      parallel_for(words.size(), 2, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) look(words[i], context, reached[i]);
      });
      for (std::size_t i = 0; i < words.size(); ++i) send(words[i], context, reached[i]);
    }
  }

  void deliver(const MediumContext& context) {
    spread(context);
    if (state.under_way.empty()) return;
    if (!context.emissions.empty())
      std::stable_sort(state.under_way.begin(), state.under_way.end(), by_arrival);
    const auto arrived = std::find_if(state.under_way.begin(), state.under_way.end(),
                                      [&](const UnderWay& each) { return each.delivery.at > context.now; });
    for (auto each = state.under_way.begin(); each != arrived; ++each) {
      const Receiver* const receiver = context.find_receiver(each->receiver);
      if (!receiver) continue;
      receiver->inbox->put(each->delivery);
      ++state.heard;
    }
    state.under_way.erase(state.under_way.begin(), arrived);
  }
};

}  // namespace

extern const MediumKind kind;
constinit const MediumKind kind = make_medium<Shout>({
    .name = "shout",
    .help = "Words that carry as far as they are loud; walls weaken them.",
});

}  // namespace sandlot::media::shout
