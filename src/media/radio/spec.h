#pragma once
/// Keys and State of the medium `radio`.
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/fields.h"
#include "base/time.h"

namespace sandlot::media::radio {

enum class Model : std::uint8_t { range, log_distance };
inline std::span<const EnumName<Model>> enum_names(Model) {
  static constexpr EnumName<Model> names[] = {{"range", Model::range}, {"log_distance", Model::log_distance}};
  return names;
}
enum class Access : std::uint8_t { aloha, csma };
inline std::span<const EnumName<Access>> enum_names(Access) {
  static constexpr EnumName<Access> names[] = {{"aloha", Access::aloha}, {"csma", Access::csma}};
  return names;
}
enum class Modulation : std::uint8_t { none, bpsk, qpsk, fsk };
inline std::span<const EnumName<Modulation>> enum_names(Modulation) {
  static constexpr EnumName<Modulation> names[] = {{"none", Modulation::none},
                                                   {"bpsk", Modulation::bpsk},
                                                   {"qpsk", Modulation::qpsk},
                                                   {"fsk", Modulation::fsk}};
  return names;
}

/// Loss of a sort of body that stands in the straight line.
struct ObstacleLoss {
  std::string of;
  double loss_dB = 0;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"of", "", "Label of the body, or the name of its substance, such as metal.", 0, 0,
                Field::required, 100},
          s.of);
    visit(Field{"loss", "dB", "Loss by one such body.", 0, 500, Field::tunable}, s.loss_dB);
  }
};

/// Carrier sense, after the unslotted CSMA-CA of IEEE 802.15.4.
struct CsmaSpec {
  double threshold_dBm = -85;
  double slot_s = 320e-6;
  int min_exponent = 3, max_exponent = 5;
  int attempts = 5;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"threshold", "dBm", "Power above which the channel is busy.", -300, 100, Field::tunable},
          s.threshold_dBm);
    visit(Field{"slot", "s", "Unit of the random waiting times.", 1e-9, 1}, s.slot_s);
    visit(Field{"min_exponent", "1", "Exponent e of the first waiting time, 1 to 2^e slots.", 0, 16},
          s.min_exponent);
    visit(Field{"max_exponent", "1",
                "Greatest exponent of a waiting time; it grows by one each time the channel is busy.", 0, 16},
          s.max_exponent);
    visit(Field{"attempts", "1",
                "Number of times that a packet finds the channel busy before it is given up.", 1, 1000},
          s.attempts);
  }
};

struct Spec {
  Model model = Model::range;
  std::optional<double> range_m;
  double reference_loss_dB = 40;
  double reference_distance_m = 1;
  double exponent = 2.5;
  double shadowing_dB = 0;
  double fading_dB = 0;
  double obstacle_loss_dB = 0;
  std::vector<ObstacleLoss> obstacles;
  double noise_floor_dBm = -100;
  double sensitivity_dBm = -90;
  double bandwidth_bitps = 250e3;
  int header_bits = 128;
  double delay_s = 0;
  double speed_mps = 299'792'458;
  bool half_duplex = true;
  bool collisions = true;
  double capture_dB = 10;
  Access access = Access::aloha;
  std::optional<double> jitter_s;
  CsmaSpec csma;
  Modulation modulation = Modulation::none;
  double bit_error_rate = 0;
  double drop = 0;
  int queue = 100;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"model", "",
                "Propagation: nothing is lost within the range, or loss grows with the logarithm "
                "of the distance."},
          s.model);
    visit(
        Field{"range", "m",
              "Distance beyond which nothing arrives; if left out, 100 m in the model range and unlimited in "
              "log_distance.",
              0, 1e6},
        s.range_m);
    visit(Field{"reference_loss", "dB", "Loss at the reference distance; for log_distance.", -100, 300,
                Field::tunable},
          s.reference_loss_dB);
    visit(Field{"reference_distance", "m", "Distance of the reference loss; nearer than that the loss stays.",
                1e-3, 1e5},
          s.reference_distance_m);
    visit(Field{"exponent", "1", "Path loss exponent of log_distance: 2 in free space, 2 to 4 indoors.", 0.5,
                10, Field::tunable},
          s.exponent);
    visit(Field{"shadowing", "dB",
                "Standard deviation of a loss that each pair of radios keeps for the whole run; for "
                "log_distance.",
                0, 30, Field::tunable},
          s.shadowing_dB);
    visit(Field{"fading", "dB",
                "Standard deviation of a loss drawn for each packet and receiver; for log_distance.", 0, 30,
                Field::tunable},
          s.fading_dB);
    visit(
        Field{"obstacle_loss", "dB", "Loss by each body in the straight line that `obstacles` does not name.",
              0, 500, Field::tunable},
        s.obstacle_loss_dB);
    visit(Field{"obstacles", "", "Losses by bodies of a label or substance.", 0, 0, Field::none, 100},
          s.obstacles);
    visit(Field{"noise_floor", "dBm", "Power of the noise in a receiver; weaker signals disturb nobody.",
                -300, 100, Field::tunable},
          s.noise_floor_dBm);
    visit(
        Field{"sensitivity", "dBm", "Power below which a packet is not received.", -300, 100, Field::tunable},
        s.sensitivity_dBm);
    visit(Field{"bandwidth", "bit/s", "Bits per second on the air.", 1, 1e12}, s.bandwidth_bitps);
    visit(Field{"header", "bit", "Bits of preamble and header that precede the data of each packet.", 0,
                100'000},
          s.header_bits);
    visit(Field{"delay", "s", "Time from the last bit's arrival to the delivery.", 0, 1000}, s.delay_s);
    visit(Field{"speed", "m/s", "Speed at which signals spread.", 1, 1e12}, s.speed_mps);
    visit(Field{"half_duplex", "", "Whether a radio that sends receives nothing meanwhile."}, s.half_duplex);
    visit(Field{"collisions", "",
                "Whether packets that overlap in time at a receiver on one channel destroy each other."},
          s.collisions);
    visit(Field{"capture", "dB",
                "Ratio to the sum of all packets that overlap it at which a packet survives; 1000: none ever "
                "does.",
                -50, 1000, Field::tunable},
          s.capture_dB);
    visit(Field{"access", "", "When a radio sends: at once, or when it senses no other."}, s.access);
    visit(
        Field{"jitter", "s",
              "Longest random wait of a packet before it is sent; if left out, the length of a tick, so that "
              "packets begin anywhere in it.",
              0, 1000},
        s.jitter_s);
    visit(Field{"csma", "", "Carrier sense; for the access csma."}, s.csma);
    visit(Field{"modulation", "", "Formula of bit errors from the ratio of signal to noise; none: without."},
          s.modulation);
    visit(
        Field{"bit_error_rate", "1", "Probability that a bit of the data is wrong.", 0, 0.5, Field::tunable},
        s.bit_error_rate);
    visit(Field{"drop", "1", "Probability that a packet is lost at a receiver for no other reason.", 0, 1,
                Field::tunable},
          s.drop);
    visit(Field{"queue", "1", "Number of packets of a radio that wait; further ones are lost.", 1, 10'000},
          s.queue);
  }
};

/// A packet that waits in its radio.
struct Waiting {
  Time ready;
  std::int32_t channel = 0;
  double power_dBm = 0;
  std::vector<std::uint8_t> packet;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"ready", "s", "Earliest time at which it is sent."}, s.ready);
    visit(Field{"channel", "1", "Channel."}, s.channel);
    visit(Field{"power", "dBm", "Power with which it is sent."}, s.power_dBm);
    visit(Field{"packet", "", "Bytes of the packet."}, s.packet);
  }
};

/// A radio that sends or is about to.
struct Sender {
  std::uint64_t radio = 0;
  Time free;                   ///< end of its transmission
  Time attempt;                ///< of the first packet in the queue, where it has a number
  std::uint32_t attempts = 0;  ///< of that packet; 0: none is set yet
  std::vector<Waiting> queue;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"radio", "", "Key of the device."}, s.radio);
    visit(Field{"free", "s", "End of the transmission under way."}, s.free);
    visit(Field{"attempt", "s", "Time at which the first packet in the queue is tried next."}, s.attempt);
    visit(Field{"attempts", "1", "Number of this attempt of the first packet in the queue."}, s.attempts);
    visit(Field{"queue", "", "Packets that wait."}, s.queue);
  }
};

/// A packet that was sent and has not been judged at all of its receivers.
struct Transmission {
  std::uint64_t emitter = 0;
  std::vector<std::uint8_t> packet;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"emitter", "", "Key of the device that sent it."}, s.emitter);
    visit(Field{"packet", "", "Bytes of the packet."}, s.packet);
  }
};

/// A transmission as it arrives at one radio, or as it occupies the radio that sends it.
struct Signal {
  std::uint64_t receiver = 0;      ///< key
  std::uint64_t transmission = 0;  ///< number
  Time start, end;                 ///< of its arrival
  double power_dBm = 0;            ///< as received
  std::int32_t channel = 0;
  std::uint8_t own = 0;   ///< 1: of the radio itself
  std::uint8_t done = 0;  ///< 1: was judged; kept because it disturbs others

  static void fields(auto& s, auto&& visit) {
    visit(Field{"receiver", "", "Key of the receiving device."}, s.receiver);
    visit(Field{"transmission", "", "Number of the transmission."}, s.transmission);
    visit(Field{"start", "s", "Arrival of the first bit."}, s.start);
    visit(Field{"end", "s", "Arrival of the last bit."}, s.end);
    visit(Field{"power", "dBm", "Received power."}, s.power_dBm);
    visit(Field{"channel", "1", "Channel."}, s.channel);
    visit(Field{"own", "", "Whether it is the radio's own transmission."}, s.own);
    visit(Field{"done", "", "Whether it was judged."}, s.done);
  }
};

struct State {
  std::vector<Sender> senders;              ///< in creation order of the radios
  std::uint64_t first = 0;                  ///< number of transmissions.front()
  std::vector<Transmission> transmissions;  ///< by number, without a gap
  std::vector<Signal> signals;              ///< by receiver in creation order, then by end
  std::uint64_t sent = 0, delivered = 0, weak = 0, deaf = 0, collided = 0, dropped = 0;
  std::uint64_t bits = 0, wrong_bits = 0, damaged = 0;
  std::uint64_t overflowed = 0, given_up = 0, lost = 0;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"senders", "", "Radios that send or are about to."}, s.senders);
    visit(Field{"first", "", "Number of the first transmission that is kept."}, s.first);
    visit(Field{"transmissions", "", "Packets on the air."}, s.transmissions);
    visit(Field{"signals", "", "Packets on the air as they arrive at each radio."}, s.signals);
    visit(Field{"sent", "1", "Packets sent."}, s.sent);
    visit(Field{"delivered", "1", "Packets delivered, each receiver counted; damaged ones included."},
          s.delivered);
    visit(Field{"weak", "1", "Packets lost at a receiver: above the noise, below the sensitivity."}, s.weak);
    visit(Field{"deaf", "1", "Packets lost at a receiver that was sending."}, s.deaf);
    visit(Field{"collided", "1", "Packets lost at a receiver to others that overlapped them."}, s.collided);
    visit(Field{"dropped", "1", "Packets lost at a receiver for no other reason."}, s.dropped);
    visit(Field{"bits", "1", "Bits of data delivered."}, s.bits);
    visit(Field{"wrong_bits", "1", "Bits of data delivered wrong."}, s.wrong_bits);
    visit(Field{"damaged", "1", "Packets delivered with at least one wrong bit."}, s.damaged);
    visit(Field{"overflowed", "1", "Packets lost because the queue of their radio was full."}, s.overflowed);
    visit(Field{"given_up", "1", "Packets lost because the channel was always busy."}, s.given_up);
    visit(Field{"lost", "1", "Packets lost because too much was on the air."}, s.lost);
  }
};

}  // namespace sandlot::media::radio
