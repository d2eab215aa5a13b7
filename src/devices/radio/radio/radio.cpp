/// radio: sends and receives packets through a medium of kind `radio`.
///
/// Output   levels `packets` and `bits`: sandlot_msgs/RadioReceptionArray, the packets that came since the sample before, in the
///          order of arrival, with their received power. packets: those alone whose data are right, as a checksum would find;
///          `damaged` counts the others. bits: all, with their wrong bits.
/// Time     rate 0: a sample in every tick in which something has come, and only then. Else at the rate, whether or not
///          something has come.
/// Order    /robot/radio/send/command: packets, first in, first out; at most `queue` per tick, more are refused. A packet longer
///          than `max_size` is not sent; `refused` counts it.
/// For whom a receiver publishes what is for its robot, its team, its own `address` or all; promiscuous: everything on its channel.
/// Limits   the header is never damaged; up to 1000 packets wait for the next sample; one antenna, the same all round.
/// Cost     one copy of the data per packet and active level.
#include "base/prefetch.h"
#include "devices/kind.h"
#include "devices/radio/port.h"
#include "messages/messages.h"

namespace sandlot::radio {
namespace {

enum Level : std::uint32_t { packets, bits };

struct Spec {
  std::string medium;
  std::string address;
  double power_dBm = 20;
  int channel = 0;
  int max_size = 1024;
  int queue = 100;
  bool promiscuous = false;
  double energy_per_bit_J = 0;
  double rate_hz = 0;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"medium", "", "Medium that carries the packets; the only one of kind radio if left out.", 0,
                0, Field::none, 100},
          s.medium);
    visit(Field{"address", "", "Name, in addition to the robot's and the team's, by which it is reached.", 0,
                0, Field::none, most_packet_name},
          s.address);
    visit(Field{"power", "dBm", "Power with which it sends.", -200, 100, Field::tunable}, s.power_dBm);
    visit_packet_keys(s, visit);
  }
};

struct State {
  SendCounts orders;
  std::uint64_t received = 0, damaged = 0;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"orders", "1", "Packets that were commanded."}, s.orders);
    visit(Field{"received", "1", "Packets for this radio that came, damaged ones included."}, s.received);
    visit(Field{"damaged", "1", "Packets for this radio that came with wrong bits."}, s.damaged);
  }
};

struct Radio {
  using Spec = radio::Spec;
  using State = radio::State;
  Spec spec;
  State state;
  Port port;
  CommandQueue<msg::RadioPacket>* orders = nullptr;
  Refill<msg::RadioReception> refills[2];
  Topic<msg::RadioReceptionArray>* topics[2] = {};

  static Result<Radio> create(const DeviceBuild& build, Spec spec) {
    Radio r{std::move(spec)};
    SL_ASSIGN(const std::uint32_t medium, build.medium(r.spec.medium, "radio", "medium"));
    r.port.begin(build, medium, r.spec.address);
    r.port.inbox->tune(r.spec.channel);
    r.orders = build.accept_queue<msg::RadioPacket>(Port::always, "send",
                                                    static_cast<std::size_t>(r.spec.queue));
    r.topics[packets] = build.publish<msg::RadioReceptionArray>(packets, "packets");
    r.topics[bits] = build.publish<msg::RadioReceptionArray>(bits, "bits");
    for (auto* const topic : r.topics) topic->message.header.frame_id = build.frame_id();
    return r;
  }

  static void actuate(PoolView<Radio> pool, const Context& context) {
    for (const std::uint32_t index : pool.due) {
      Radio& r = pool.all[index];
      r.port.inbox->tune(r.spec.channel);
      for (; !r.orders->empty(); r.orders->pop()) {
        const msg::RadioPacket& packet = r.orders->front();
        if (!r.state.orders.takes(packet, r.spec.max_size)) continue;
        r.port.emit(
            context,
            {.at = context.now - context.tick, .channel = r.spec.channel, .strength = r.spec.power_dBm},
            {.number = r.state.orders.sent}, packet.to, packet.data, r.spec.energy_per_bit_J);
        ++r.state.orders.sent;
      }
    }
  }

  static void sense(PoolView<Radio> pool, const Context& context) {
    for (std::size_t i = 0; i < pool.due.size(); ++i) {
      expect(pool, i);
      const std::uint32_t index = pool.due[i];
      Radio& r = pool.all[index];
      if (r.spec.rate_hz == 0 && r.port.inbox->items().empty()) continue;
      r.sample(pool.levels[index], context);
    }
  }

  /// Asks for the memory of the radios that sense after number i: first their own, then what that points to.
  static void expect(PoolView<Radio> pool, std::size_t i) {
    const auto ahead = [&](std::size_t by) {
      return i + by < pool.due.size() ? &pool.all[pool.due[i + by]] : nullptr;
    };
    if (const Radio* const fourth = ahead(4)) prefetch(fourth, 1);
    if (const Radio* const third = ahead(3)) {
      prefetch(third->port.inbox, 1);
      for (const auto* const topic : third->topics) prefetch(topic, 1);
    }
    if (const Radio* const second = ahead(2)) {
      const std::size_t count = second->port.inbox->items().size();
      second->port.inbox->expect(count);
      for (const auto* const topic : second->topics)
        prefetch(topic->message.packets.data(), std::min(count, topic->message.packets.size()));
    }
    if (const Radio* const next = ahead(1))
      for (const auto* const topic : next->topics)
        for (const msg::RadioReception& each : topic->message.packets) prefetch(each.data.data(), 1);
  }

  void sample(std::uint32_t levels, const Context& context) {
    std::size_t came = 0;
    for (const Received& received : port.inbox->items()) {
      const DeliveryHead& delivery = received.head;
      const auto packet = read_packet(received.payload());
      if (!packet || !(spec.promiscuous || port.is_for_us(packet->to))) continue;
      const bool damaged = packet->wrong_bits() > 0;
      ++state.received;
      state.damaged += damaged;
      for (const Level level : {packets, bits}) {
        if (!(levels >> level & 1) || (level == packets && damaged)) continue;
        add_reception(topics[level]->message, refills[level], delivery, *packet, delivery.strength);
        ++came;
      }
    }
    port.inbox->clear();
    if (spec.rate_hz == 0 && came == 0) return;
    for (const Level level : {packets, bits}) {
      if (!(levels >> level & 1) || (spec.rate_hz == 0 && refills[level].used() == 0)) continue;
      refills[level].finish(topics[level]->message.packets);
      topics[level]->publish(context.now);
    }
  }
};

constexpr LevelInfo levels[] = {
    {"packets", msg::RadioReceptionArray::ros_type, "", "Packets whose data arrived without a wrong bit."},
    {"bits", msg::RadioReceptionArray::ros_type, "", "All packets, with the bits that are wrong."},
};

}  // namespace

extern const Kind kind;
constinit const Kind kind = make_kind<Radio>({
    .name = "radio",
    .help = "Sends packets to a robot, a team or all, and receives those of others with their power.",
    .levels = levels,
});

}  // namespace sandlot::radio
