/// infrared: sends and receives packets through a medium of kind `infrared`.
///
/// Frame    the light leaves along x and is received from about x.
/// Output   level `packets`: sandlot_msgs/RadioReceptionArray, the packets that came since the sample before, in the order of
///          arrival. Their received power is E A cos(a): E the irradiance that arrives, A the detector's area, a the angle of
///          incidence.
/// Time     as the device radio: rate 0 samples only when something has come.
/// Beam     I0 cos^m(a) with m = -ln 2 / ln cos(half_angle): half the intensity at the half angle. A half angle of pi/2 or more
///          radiates evenly all round.
/// Receives up to the angle `acceptance` from x; one above pi/2 receives from all sides, and then the incidence does not count.
/// Order    /robot/infrared/send/command, as the device radio.
/// Limits   those of the medium; no saturation, no ambient light.
/// Source   J. M. Kahn, J. R. Barry, Wireless Infrared Communications, Proc. IEEE 85 (1997), sec. II.
#include "base/math.h"
#include "devices/kind.h"
#include "devices/radio/port.h"
#include "messages/messages.h"

namespace sandlot::infrared {
namespace {

struct Spec {
  std::string medium;
  double intensity_Wpsr = 0.05;
  double half_angle_rad = 0.35;
  double acceptance_rad = math::pi / 3;
  double area_m2 = 1e-5;
  double sensitivity_dBm = -50;
  int channel = 0;
  int max_size = 64;
  int queue = 100;
  bool promiscuous = false;
  double energy_per_bit_J = 0;
  double rate_hz = 0;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"medium", "", "Medium that carries the light; the only one of kind infrared if left out.", 0,
                0, Field::none, 100},
          s.medium);
    visit(Field{"intensity", "W/sr", "Radiant intensity along x.", 0, 1e6, Field::tunable}, s.intensity_Wpsr);
    visit(Field{"half_angle", "rad",
                "Angle from x at which the intensity is half; pi/2 or more: the same all round.", 0.01,
                math::pi},
          s.half_angle_rad);
    visit(Field{"acceptance", "rad", "Angle from x up to which it receives; above pi/2: all round.", 0,
                math::pi},
          s.acceptance_rad);
    visit(Field{"area", "m^2", "Area of the detector.", 1e-9, 1}, s.area_m2);
    visit(
        Field{"sensitivity", "dBm", "Power below which a packet is not received.", -300, 100, Field::tunable},
        s.sensitivity_dBm);
    visit_packet_keys(s, visit);
  }
};

struct State {
  SendCounts orders;
  std::uint64_t received = 0;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"orders", "1", "Packets that were commanded."}, s.orders);
    visit(Field{"received", "1", "Packets for this device that came."}, s.received);
  }
};

struct Infrared {
  using Spec = infrared::Spec;
  using State = infrared::State;
  Spec spec;
  State state;
  Port port;
  double order = 0;  ///< m
  double least_cos = -1;
  CommandQueue<msg::RadioPacket>* orders = nullptr;
  Refill<msg::RadioReception> refill;
  Topic<msg::RadioReceptionArray>* topic = nullptr;

  static Result<Infrared> create(const DeviceBuild& build, Spec spec) {
    Infrared r{std::move(spec)};
    SL_ASSIGN(const std::uint32_t medium, build.medium(r.spec.medium, "infrared", "medium"));
    r.port.begin(build, medium, "");
    r.port.inbox->tune(r.spec.channel);
    if (r.spec.half_angle_rad < math::pi / 2)
      r.order = -math::log(2) / math::log(math::cos(r.spec.half_angle_rad));
    if (r.spec.acceptance_rad <= math::pi / 2) r.least_cos = math::cos(r.spec.acceptance_rad);
    r.orders = build.accept_queue<msg::RadioPacket>(Port::always, "send",
                                                    static_cast<std::size_t>(r.spec.queue));
    r.topic = build.publish<msg::RadioReceptionArray>(0, "packets");
    r.topic->message.header.frame_id = build.frame_id();
    return r;
  }

  static void actuate(PoolView<Infrared> pool, const Context& context) {
    for (const std::uint32_t index : pool.due) {
      Infrared& r = pool.all[index];
      r.port.inbox->tune(r.spec.channel);
      for (; !r.orders->empty(); r.orders->pop()) {
        const msg::RadioPacket& packet = r.orders->front();
        if (!r.state.orders.takes(packet, r.spec.max_size)) continue;
        r.port.emit(context,
                    {.at = context.now - context.tick,
                     .direction_W = rotate(r.port.pose(context.engine).q, {1, 0, 0}),
                     .channel = r.spec.channel,
                     .strength = r.spec.intensity_Wpsr},
                    {.number = r.state.orders.sent, .lambertian_order = r.order}, packet.to, packet.data,
                    r.spec.energy_per_bit_J);
        ++r.state.orders.sent;
      }
    }
  }

  static void sense(PoolView<Infrared> pool, const Context& context) {
    for (const std::uint32_t index : pool.due) {
      Infrared& r = pool.all[index];
      if (r.spec.rate_hz > 0 || !r.port.inbox->items().empty()) r.sample(context);
    }
  }

  void sample(const Context& context) {
    const Vec3 axis_W = rotate(port.pose(context.engine).q, {1, 0, 0});
    for (const Received& received : port.inbox->items()) {
      const DeliveryHead& delivery = received.head;
      const double cosine = dot(axis_W, delivery.direction_W);
      if (least_cos >= 0 && !(cosine > 0 && cosine >= least_cos)) continue;
      const double power_W = delivery.strength * area_of(cosine);
      if (!(power_W > 0)) continue;
      const double power_dBm = 10 / std::numbers::ln10 * math::log(1000 * power_W);
      if (power_dBm < spec.sensitivity_dBm) continue;
      const auto packet = read_packet(received.payload());
      if (!packet || !(spec.promiscuous || port.is_for_us(packet->to))) continue;
      ++state.received;
      add_reception(topic->message, refill, delivery, *packet, power_dBm);
    }
    port.inbox->clear();
    if (spec.rate_hz == 0 && refill.used() == 0) return;
    refill.finish(topic->message.packets);
    topic->publish(context.now);
  }

  /// Area of the detector as seen by the light.
  double area_of(double cosine) const { return least_cos >= 0 ? spec.area_m2 * cosine : spec.area_m2; }
};

constexpr LevelInfo levels[] = {
    {"packets", msg::RadioReceptionArray::ros_type, "", "Packets that came, with the received power."},
};

}  // namespace

extern const Kind kind;
constinit const Kind kind = make_kind<Infrared>({
    .name = "infrared",
    .help = "Sends packets along a beam of light and receives those of others that it faces.",
    .levels = levels,
});

}  // namespace sandlot::infrared
