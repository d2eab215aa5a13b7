/// range_bearing: sends beacons that name its robot, and measures how far and in which direction those are that it receives.
///
/// Frame    bearing about z from x, elevation above the xy plane, of the device.
/// Output   level `neighbours`: sandlot_msgs/RangeBearingArray, an entry per packet that came since the sample before, in the
///          order of arrival: sender, range [m], bearing and elevation [rad], data.
/// Time     of the measurement: the end of the tick, against the place from which the packet was sent. rate 0: a sample in
///          every tick in which a packet has come, and only then.
/// Sends    a beacon `beacon_rate` times a second, with the data of the latest order to /robot/device/send/command; through a
///          medium of kind radio or infrared, all round.
/// Noise    white, per packet, on range, bearing and elevation; a range is never below 0. Keyed by the two devices and the
///          packet, so that one neighbour more changes no other's.
/// Limits   the geometry is the true one plus noise: no multipath, no error that grows with the distance or with weak reception;
///          damaged packets are left out.
/// Cost     two arc tangents per packet, a normal per value with noise.
#include <cmath>

#include "base/math.h"
#include "devices/kind.h"
#include "devices/radio/port.h"
#include "messages/messages.h"
#include "noise/chain.h"
#include "noise/white.h"

namespace sandlot::range_bearing {
namespace {

struct Spec {
  std::string medium;
  double power_dBm = 20;
  double intensity_Wpsr = 0.05;
  int channel = 0;
  double beacon_rate_hz = 10;
  int max_size = 64;
  double energy_per_bit_J = 0;
  WhiteNoiseSpec range_noise, bearing_noise, elevation_noise;
  double rate_hz = 0;
  double errors = 1;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"medium", "",
                "Medium of kind radio or infrared that carries the beacons; the only radio, else the only "
                "infrared one if left out.",
                0, 0, Field::none, 100},
          s.medium);
    visit(Field{"power", "dBm", "Power of the beacons in a medium of kind radio.", -200, 100, Field::tunable},
          s.power_dBm);
    visit(Field{"intensity", "W/sr", "Radiant intensity of the beacons in a medium of kind infrared.", 0, 1e6,
                Field::tunable},
          s.intensity_Wpsr);
    visit(Field{"channel", "1", "Channel on which it sends and receives.", 0, 100'000, Field::tunable},
          s.channel);
    visit(Field{"beacon_rate", "Hz", "Beacons per second; 0: none.", 0, 1e4}, s.beacon_rate_hz);
    visit(Field{"max_size", "B", "Greatest number of bytes in a beacon.", 1, most_packet_data}, s.max_size);
    visit(Field{"range_noise", "m", "White error of the range."}, s.range_noise);
    visit(Field{"bearing_noise", "rad", "White error of the bearing."}, s.bearing_noise);
    visit(Field{"elevation_noise", "rad", "White error of the elevation."}, s.elevation_noise);
    visit(energy_per_bit_field, s.energy_per_bit_J);
    visit(Field{"rate", "Hz", "Samples per second; 0: one in every tick in which a packet has come.", 0, 1e6},
          s.rate_hz);
    visit(errors_field, s.errors);
  }
};

struct State {
  Time start = {-1};          ///< of the first beacon; below 0: none yet
  std::uint64_t beacons = 0;  ///< index of the next one
  SendCounts orders;
  std::uint64_t taken = 0;  ///< orders so far
  std::string to;
  std::vector<std::uint8_t> data;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"start", "s", "Time of the first beacon; below 0 before it."}, s.start);
    visit(Field{"beacons", "1", "Index of the next beacon."}, s.beacons);
    visit(Field{"orders", "1", "Beacons sent, and data refused."}, s.orders);
    visit(Field{"taken", "1", "Orders taken."}, s.taken);
    visit(Field{"to", "", "Robot or team that the beacons are for; empty: all."}, s.to);
    visit(Field{"data", "", "Content of the beacons."}, s.data);
  }
};

struct RangeBearing {
  using Spec = range_bearing::Spec;
  using State = range_bearing::State;
  Spec spec;
  State state;
  Port port;
  bool is_radio = true;
  Topic<msg::RadioPacket>* order = nullptr;
  Refill<msg::RangeBearing> refill;
  Topic<msg::RangeBearingArray>* topic = nullptr;

  static Result<RangeBearing> create(const DeviceBuild& build, Spec spec) {
    RangeBearing r{std::move(spec)};
    Result<std::uint32_t> medium = build.medium(r.spec.medium, "radio", "medium");
    if (!medium) {
      if (Result<std::uint32_t> light = build.medium(r.spec.medium, "infrared", "medium")) {
        medium = std::move(light);
        r.is_radio = false;
      }
    }
    if (!medium) return std::move(medium.error());
    r.port.begin(build, *medium, "");
    r.port.inbox->tune(r.spec.channel);
    r.order = build.accept<msg::RadioPacket>(Port::always, "send");
    r.topic = build.publish<msg::RangeBearingArray>(0, "neighbours");
    r.topic->message.header.frame_id = build.frame_id();
    return r;
  }

  bool fits() const {
    return state.start.ns <= 2'000'000'000'000'000'000 && state.beacons <= std::uint64_t{1} << 53 &&
           state.to.size() <= most_packet_name &&
           state.data.size() <= static_cast<std::size_t>(spec.max_size);
  }

  static void actuate(PoolView<RangeBearing> pool, const Context& context) {
    for (const std::uint32_t index : pool.due) {
      RangeBearing& r = pool.all[index];
      r.port.inbox->tune(r.spec.channel);
      if (r.order->count != r.state.taken) {
        r.state.taken = r.order->count;
        if (r.state.orders.takes(r.order->message, r.spec.max_size)) {
          r.state.to = r.order->message.to;
          r.state.data = r.order->message.data;
        }
      }
      if (r.spec.beacon_rate_hz > 0) r.send_beacons(context);
    }
  }

  void send_beacons(const Context& context) {
    const Time begin = context.now - context.tick;
    if (state.start.ns < 0) state.start = begin;
    const auto due = [&] {
      return due_time(state.start, static_cast<std::int64_t>(state.beacons), spec.beacon_rate_hz);
    };
    if (due() < begin) {  // those of a time in which it did not run are left out
      const double missed = std::floor((begin - state.start).s() * spec.beacon_rate_hz);
      state.beacons = std::max(state.beacons, static_cast<std::uint64_t>(std::max(0.0, missed)));
      if (due() < begin) ++state.beacons;
    }
    for (; due() < context.now; ++state.beacons) {
      port.emit(context,
                {.at = std::max(due(), begin),
                 .channel = spec.channel,
                 .strength = is_radio ? spec.power_dBm : spec.intensity_Wpsr},
                {.number = state.orders.sent}, state.to, state.data, spec.energy_per_bit_J);
      ++state.orders.sent;
    }
  }

  static void sense(PoolView<RangeBearing> pool, const Context& context) {
    for (const std::uint32_t index : pool.due) {
      RangeBearing& r = pool.all[index];
      if (r.spec.rate_hz > 0 || !r.port.inbox->items().empty()) r.sample(context);
    }
  }

  void sample(const Context& context) {
    const Pose X_SW = inverse(port.pose(context.engine));
    std::vector<msg::RangeBearing>& neighbours = topic->message.neighbours;
    for (const Received& received : port.inbox->items()) {
      const DeliveryHead& delivery = received.head;
      const auto packet = read_packet(received.payload());
      if (!packet || packet->wrong_bits() > 0 || !port.is_for_us(packet->to)) continue;
      msg::RangeBearing& to = refill.next(neighbours);
      to.stamp = delivery.at;
      to.from = packet->from;
      to.data.assign(packet->data.begin(), packet->data.end());
      measure(X_SW * packet->point(), delivery.emitter, packet->number(), context, to);
    }
    port.inbox->clear();
    if (spec.rate_hz == 0 && refill.used() == 0) return;
    refill.finish(neighbours);
    topic->publish(context.now);
  }

  void measure(Vec3 p_S, std::uint64_t emitter, std::uint64_t number, const Context& context,
               msg::RangeBearing& to) const {
    to.range = norm(p_S);
    to.bearing = math::atan2(p_S.y, p_S.x);
    to.elevation = math::atan2(p_S.z, std::sqrt(p_S.x * p_S.x + p_S.y * p_S.y));
    if (spec.range_noise.std == 0 && spec.bearing_noise.std == 0 && spec.elevation_noise.std == 0) return;
    Stream random(context.seed, hash_combine(port.key, emitter), Purpose::noise, number);
    const auto corrupt = [&](const WhiteNoiseSpec& noise, double truth) {
      return WhiteNoiseSpec{spec.errors * noise.std}.corrupt(truth, random);
    };
    to.range = std::max(0.0, corrupt(spec.range_noise, to.range));
    to.bearing = math::wrap_angle(corrupt(spec.bearing_noise, to.bearing));
    to.elevation = corrupt(spec.elevation_noise, to.elevation);
  }
};

constexpr LevelInfo levels[] = {
    {"neighbours", msg::RangeBearingArray::ros_type, "",
     "Neighbours whose beacons came: who, how far, in which direction."},
};

}  // namespace

extern const Kind kind;
constinit const Kind kind = make_kind<RangeBearing>({
    .name = "range_bearing",
    .help = "Sends beacons, and measures range and bearing of those who send theirs.",
    .levels = levels,
});

}  // namespace sandlot::range_bearing
