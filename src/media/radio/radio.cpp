/// radio: packets of data from device to device, with what they suffer on the way.
///
/// Propagation   media/radio/propagation.h. Positions are those at the end of the tick in which a packet begins.
/// Air time      (header + 8 bytes) / bandwidth. A radio sends one packet after the other; those that wait stand in its queue.
/// Start         a packet is ready at the tick that takes its order, plus a random wait of up to `jitter`; by default starts lie
///               anywhere in the tick. aloha: it is sent when it is ready and the radio is free. csma: after 1 to 2^e slots, if
///               the sum of what arrives is then at most `threshold`; else e grows by one, up to its limit, and the radio waits
///               again; after `attempts` busy ones the packet is given up.
/// Arrival       the last bit's start plus flight (distance / speed) plus `delay`, to the nanosecond; delivered in the tick in
///               which that lies.
/// Lost          in this order: below `sensitivity` (weak); its receiver sends at some time meanwhile (deaf); other packets on
///               the channel overlap it and it is not `capture` dB above the sum of them all (collided); by chance (dropped).
/// Bits          of the data are wrong with the probability p of media/radio/bit_errors.h for the power over noise plus what
///               interferes, on average over the packet, and with `bit_error_rate` in addition. Header and names are never
///               wrong. What a device does with a damaged packet is its own affair.
/// Random        keyed by the two devices and the packet's number, so that one robot more changes nothing for the others but
///               by its packets.
/// Limits        no turn-around time, acknowledgement or repetition; neighbouring channels do not disturb each other; a stronger
///               packet that begins later is captured all the same; no Doppler effect.
/// Cost          aloha: senders are looked at on all threads; csma: one after the other, as each depends on those before it.
///               Judging is on all threads, by receiver.
/// Source        N. Abramson, The ALOHA System (1970); IEEE 802.15.4, unslotted CSMA-CA.
#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <optional>

#include "base/math.h"
#include "base/prefetch.h"
#include "base/random.h"
#include "media/medium.h"
#include "media/packet.h"
#include "media/places.h"
#include "media/radio/bit_errors.h"
#include "media/radio/propagation.h"
#include "media/radio/spec.h"
#include "physics/parallel.h"

namespace sandlot::media::radio {
namespace {

constexpr std::size_t most_signals = 1'000'000, most_senders = 1'000'000;
constexpr std::size_t most_packet_bytes = sizeof(PacketHead) + 2 * most_packet_name + most_packet_data;
constexpr std::int64_t latest_ns = 2'000'000'000'000'000'000;  ///< of times in State: no sum overflows

/// What happened at the receivers in a tick.
enum Count : std::size_t { delivered, weak, deaf, collided, dropped, bits, wrong_bits, damaged, counts };

struct Radio {
  using Spec = radio::Spec;
  using State = radio::State;
  Spec spec;
  State state;

  // Of one tick, kept for their memory.
  Places places;
  std::vector<Sender> senders;                ///< per receiver
  std::vector<std::vector<Signal>> arrivals;  ///< per receiver; in judge() by end
  std::vector<std::uint32_t> active;          ///< receivers that have packets to send
  std::vector<std::uint8_t> marked;           ///< per receiver
  std::vector<std::uint32_t> touched;         ///< receivers at which something arrives or that send
  std::vector<Start> starts;
  std::vector<Reached> reached;
  std::size_t on_the_way = 0;  ///< signals in `arrivals`
  /// Packets that are over, for their memory. Inboxes may hold what was lent of them until the next deliver().
  std::vector<std::vector<std::uint8_t>> spare;

  Status init(const ElementBuild& build) {
    if (spec.csma.max_exponent < spec.csma.min_exponent)
      return build.error("csma", "max_exponent is less than min_exponent",
                         "a greatest exponent of at least " + std::to_string(spec.csma.min_exponent));
    return {};
  }

  bool fits() const {
    const auto sound = [](Time t) { return t.ns >= 0 && t.ns <= latest_ns; };
    const auto is_packet = [](const std::vector<std::uint8_t>& bytes) {
      return bytes.size() <= most_packet_bytes && read_packet(bytes).has_value();
    };
    const auto waits = [&](const Waiting& each) {
      return sound(each.ready) && std::abs(each.power_dBm) <= 1000 && is_packet(each.packet);
    };
    const auto sends = [&](const Sender& each) {
      return sound(each.free) && sound(each.attempt) &&
             each.attempts <= static_cast<std::uint32_t>(spec.csma.attempts) &&
             each.queue.size() <= static_cast<std::size_t>(spec.queue) &&
             std::all_of(each.queue.begin(), each.queue.end(), waits);
    };
    const auto arrives = [&](const Signal& each) {
      return sound(each.start) && sound(each.end) && each.start <= each.end &&
             std::abs(each.power_dBm) <= 10'000 && each.own <= 1 && each.done <= 1 &&
             (each.done == 1 || each.own == 1 ||
              (each.transmission >= state.first &&
               each.transmission - state.first < state.transmissions.size()));
    };
    return state.senders.size() <= most_senders && state.signals.size() <= most_signals &&
           state.transmissions.size() <= most_signals && state.first <= std::uint64_t{1} << 62 &&
           std::all_of(state.senders.begin(), state.senders.end(), sends) &&
           std::all_of(state.signals.begin(), state.signals.end(), arrives) &&
           std::all_of(state.transmissions.begin(), state.transmissions.end(),
                       [&](const Transmission& each) { return is_packet(each.packet); });
  }

  void deliver(const MediumContext& context) {
    if (context.emissions.empty() && state.senders.empty() && state.signals.empty()) return;
    for (const Receiver& each : context.receivers) each.inbox->keep();
    unpack(context);
    take(context);
    places.update(context);
    if (!active.empty()) send(context);
    judge(context);
    pack(context);
  }

  // ------------------------------------------------------------------------------------------- State, in and out

  /// Finds the receivers of keys that come mostly in the order of receivers.
  class Finder {
   public:
    explicit Finder(const MediumContext& context) : context_(context) {}
    /// Its index; nothing: it is gone.
    std::optional<std::uint32_t> find(std::uint64_t key) {
      for (std::uint32_t i = latest_; i < std::min<std::size_t>(latest_ + 2, context_.receivers.size()); ++i)
        if (context_.receivers[i].key == key) return latest_ = i;
      const Receiver* const found = context_.find_receiver(key);
      if (!found) return std::nullopt;
      return latest_ = static_cast<std::uint32_t>(found - context_.receivers.data());
    }

   private:
    const MediumContext& context_;
    std::uint32_t latest_ = 0;
  };

  /// Distributes State to the receivers. What belongs to radios that are gone is forgotten.
  void unpack(const MediumContext& context) {
    const std::size_t count = context.receivers.size();
    senders.resize(std::max(senders.size(), count));
    arrivals.resize(std::max(arrivals.size(), count));
    touched.clear();
    active.clear();
    on_the_way = 0;
    Finder finder(context);
    for (Sender& each : state.senders)
      if (const auto index = finder.find(each.radio)) {
        senders[*index] = std::move(each);
        if (!senders[*index].queue.empty()) active.push_back(*index);
        touch(*index);
      }
    for (const Signal& each : state.signals)
      if (const auto index = finder.find(each.receiver)) add(*index, each);
  }

  /// Sorts indices of receivers, each once.
  void sort_once(std::vector<std::uint32_t>& indices, std::size_t receivers) {
    constexpr std::size_t few = 16;
    if (indices.size() < receivers / few) {
      std::sort(indices.begin(), indices.end());
      indices.erase(std::unique(indices.begin(), indices.end()), indices.end());
      return;
    }
    marked.assign(receivers, 0);
    for (const std::uint32_t each : indices) marked[each] = 1;
    indices.clear();
    for (std::uint32_t i = 0; i < receivers; ++i)
      if (marked[i]) indices.push_back(i);
  }
  void touch(std::uint32_t index) { touched.push_back(index); }
  void add(std::uint32_t index, const Signal& signal) {
    if (arrivals[index].empty()) touch(index);
    arrivals[index].push_back(signal);
    ++on_the_way;
  }

  /// Collects what goes on into the next tick, and frees the packets that nobody waits for.
  void pack(const MediumContext& context) {
    state.senders.clear();
    state.signals.clear();
    std::uint64_t needed = state.first + state.transmissions.size();
    for (const std::uint32_t index : touched) {
      Sender& sender = senders[index];
      if (!sender.queue.empty() || sender.free > context.now) {
        state.senders.push_back(std::move(sender));
        sender = {};
      } else {  // its queue keeps its memory
        sender.radio = 0, sender.free = sender.attempt = {}, sender.attempts = 0;
      }
      for (Signal& each : arrivals[index]) {
        each.receiver = places.key(index);
        state.signals.push_back(each);
        if (!each.done && !each.own) needed = std::min(needed, each.transmission);
      }
      arrivals[index].clear();
    }
    const auto over = state.transmissions.begin() + static_cast<std::ptrdiff_t>(needed - state.first);
    for (auto each = state.transmissions.begin(); each != over; ++each)
      spare.push_back(std::move(each->packet));
    state.transmissions.erase(state.transmissions.begin(), over);
    state.first = needed;
  }

  // ------------------------------------------------------------------------------------------------------ sending

  /// Puts the packets of this tick into the queues of their radios.
  void take(const MediumContext& context) {
    constexpr std::uint64_t use = 0x7374617274;  // "start"
    Finder finder(context);
    for (const Emission& emission : context.emissions) {
      const auto index = finder.find(emission.emitter);
      const std::span<const std::byte> bytes = context.buffer.bytes(emission);
      const auto* const first = reinterpret_cast<const std::uint8_t*>(bytes.data());
      const auto packet = read_packet({first, bytes.size()});
      if (!index || !packet) continue;
      Sender& sender = senders[*index];
      if (sender.queue.size() >= static_cast<std::size_t>(spec.queue)) {
        ++state.overflowed;
        continue;
      }
      sender.radio = emission.emitter;
      const double jitter_s = spec.jitter_s.value_or(context.step.s());
      Time ready = emission.at;
      if (jitter_s > 0) {
        Stream random(context.seed, hash_combine(emission.emitter, use), Purpose::medium, packet->number());
        // Rounded down, so that a wait of up to a tick ends within the tick.
        ready.ns += static_cast<std::int64_t>(jitter_s * 1e9 * random.uniform());
      }
      if (sender.queue.empty()) {
        active.push_back(*index);
        touch(*index);
      }
      Waiting& waiting = sender.queue.emplace_back();
      waiting.ready = ready;
      waiting.channel = emission.channel;
      waiting.power_dBm = emission.strength;
      if (!spare.empty()) {
        waiting.packet = std::move(spare.back());
        spare.pop_back();
      }
      waiting.packet.assign(first, first + bytes.size());
    }
  }

  /// Attempts in the order of their times.
  struct Attempt {
    Time at;
    std::uint64_t key = 0;  ///< of the device; decides where the times are equal
    std::uint32_t sender = 0;
    bool operator<(const Attempt& other) const {  // the first is the greatest, for std::push_heap
      return at != other.at ? at > other.at : key > other.key;
    }
  };
  std::vector<Attempt> attempts;
  std::vector<std::size_t> heads;  ///< per receiver: packets of the queue that were sent in this tick

  void send(const MediumContext& context) {
    starts.clear();
    attempts.clear();
    heads.resize(std::max(heads.size(), context.receivers.size()));
    sort_once(active, context.receivers.size());
    for (const std::uint32_t index : active) heads[index] = 0;
    if (spec.access == Access::aloha) send_all(context);
    else sense_and_send(context);
    spread(context);
    for (const std::uint32_t index : active) {
      std::vector<Waiting>& queue = senders[index].queue;
      queue.erase(queue.begin(), queue.begin() + static_cast<std::ptrdiff_t>(heads[index]));
    }
  }

  /// aloha: no attempt depends on what others send.
  void send_all(const MediumContext& context) {
    constexpr std::size_t most_at_once = 256;
    for (const std::uint32_t index : active) {
      Time free = senders[index].free;
      for (const Waiting& waiting : senders[index].queue) {
        const Time at = std::max({waiting.ready, free, context.now - context.step});
        if (at >= context.now) break;
        attempts.push_back({at, senders[index].radio, index});
        free = at + air_time(waiting.packet);
      }
    }
    std::sort(attempts.begin(), attempts.end(), [](const Attempt& a, const Attempt& b) { return b < a; });
    for (const Attempt& attempt : attempts) {
      start(attempt);
      if (starts.size() == most_at_once) spread(context);
    }
  }

  /// csma: one after the other.
  void sense_and_send(const MediumContext& context) {
    for (const std::uint32_t index : active) plan(index, context);
    while (!attempts.empty()) {
      std::pop_heap(attempts.begin(), attempts.end());
      const Attempt attempt = attempts.back();
      attempts.pop_back();
      Sender& sender = senders[attempt.sender];
      if (is_busy(attempt)) {
        if (++sender.attempts > static_cast<std::uint32_t>(spec.csma.attempts)) {
          ++state.given_up;
          next_packet(sender, attempt.sender);
        } else {
          wait(sender, attempt.sender, attempt.at, context);
        }
        plan(attempt.sender, context);
        continue;
      }
      start(attempt);
      plan(attempt.sender, context);
      spread(context);
    }
  }

  void start(const Attempt& attempt) {
    Sender& sender = senders[attempt.sender];
    Waiting& packet = sender.queue[heads[attempt.sender]];
    sender.free = attempt.at + air_time(packet.packet);
    begin(attempt, packet);
    next_packet(sender, attempt.sender);
  }

  void next_packet(Sender& sender, std::uint32_t index) {
    sender.attempts = 0;
    ++heads[index];
  }

  Time air_time(const std::vector<std::uint8_t>& packet) const {
    const double on_air = spec.header_bits + 8.0 * static_cast<double>(read_packet(packet)->data.size());
    return std::max(Time::from_ns(1), Time::from_s(on_air / spec.bandwidth_bitps));
  }

  /// Waits 1 to 2^e slots; the channel is sensed at their end.
  void wait(Sender& sender, std::uint32_t index, Time from, const MediumContext& context) {
    constexpr std::uint64_t use = 0x6261636b6f6666;  // "backoff"
    const auto before = static_cast<int>(sender.attempts) - 1;
    const int exponent = std::min(spec.csma.min_exponent + before, spec.csma.max_exponent);
    const std::uint64_t number = read_packet(sender.queue[heads[index]].packet)->number();
    const Stream of_packet(context.seed, hash_combine(sender.radio, use), Purpose::medium, number);
    Stream random = of_packet.fork(sender.attempts);
    const std::uint32_t slots = 1 + random.below(std::uint32_t{1} << exponent);
    sender.attempt = from + Time::from_s(slots * spec.csma.slot_s);
  }

  /// csma: puts the next attempt of a radio among those of this tick, if it lies in it.
  void plan(std::uint32_t index, const MediumContext& context) {
    Sender& sender = senders[index];
    if (heads[index] >= sender.queue.size()) return;
    const Time begin = context.now - context.step;
    if (sender.attempts == 0) {
      sender.attempts = 1;
      wait(sender, index, std::max({sender.queue[heads[index]].ready, sender.free, begin}), context);
    }
    const Time at = std::max(sender.attempt, begin);
    if (at >= context.now) return;
    attempts.push_back({at, sender.radio, index});
    std::push_heap(attempts.begin(), attempts.end());
  }

  /// Carrier sense.
  bool is_busy(const Attempt& attempt) const {
    const std::int32_t channel = senders[attempt.sender].queue[heads[attempt.sender]].channel;
    double sum_mW = 0;
    for (const Signal& each : arrivals[attempt.sender])
      if (!each.own && each.channel == channel && each.start <= attempt.at && attempt.at < each.end)
        sum_mW += milliwatts(each.power_dBm);
    return sum_mW > milliwatts(spec.csma.threshold_dBm);
  }

  /// Makes a transmission of a packet. Its signals follow in spread().
  void begin(const Attempt& attempt, Waiting& waiting) {
    PacketHead head = read_packet(waiting.packet)->head();
    const Vec3 at_W = places.point(attempt.sender);
    head.x_m = at_W.x, head.y_m = at_W.y, head.z_m = at_W.z;
    write_head(head, waiting.packet);
    starts.push_back({.at = attempt.at,
                      .sender = attempt.sender,
                      .number = head.number,
                      .channel = waiting.channel,
                      .power_dBm = waiting.power_dBm});
    ++state.sent;
    state.transmissions.push_back({attempt.key, std::move(waiting.packet)});
  }

  /// Adds the signals of the latest transmissions to those of the radios that they reach.
  void spread(const MediumContext& context) {
    if (starts.empty()) return;
    reached.resize(std::max(reached.size(), starts.size()));
    parallel_for(starts.size(), 4, [&](std::size_t first, std::size_t last) {
      for (std::size_t i = first; i < last; ++i) look(spec, starts[i], places, context, reached[i]);
    });
    const std::uint64_t next = state.first + state.transmissions.size();
    for (std::size_t i = 0; i < starts.size(); ++i) {
      const Start& start = starts[i];
      const std::uint64_t number = next - starts.size() + i;
      if (i + 2 < starts.size()) expect_at_ends(reached[i + 2].receivers);
      const Time air = air_time(state.transmissions[number - state.first].packet);
      Signal signal{.transmission = number, .channel = start.channel};
      if (spec.half_duplex) {
        signal.start = start.at, signal.end = start.at + air;
        signal.own = 1;
        add(start.sender, signal);
        signal.own = 0;
      }
      for (std::size_t k = 0; k < reached[i].receivers.size(); ++k) {
        if (on_the_way >= most_signals) {
          ++state.lost;
          continue;
        }
        const std::uint32_t index = reached[i].receivers[k];
        signal.start = start.at + Time::from_s(reached[i].distances_m[k] / spec.speed_mps);
        signal.end = signal.start + air;
        signal.power_dBm = reached[i].powers_dBm[k];
        add(index, signal);
      }
    }
    starts.clear();
  }

  /// Asks for the memory in which the next signals of some radios will lie.
  void expect_at_ends(std::span<const std::uint32_t> receivers) const {
    for (const std::uint32_t each : receivers) prefetch(arrivals[each].data() + arrivals[each].size(), 1);
  }

  // ------------------------------------------------------------------------------------------------------ judging

  void judge(const MediumContext& context) {
    sort_once(touched, context.receivers.size());
    std::array<std::atomic<std::uint64_t>, counts> sums{};
    parallel_for(touched.size(), 16, [&](std::size_t first, std::size_t last) {
      std::array<std::uint64_t, counts> own{};
      for (std::size_t i = first; i < last; ++i) {
        if (i + 2 < last) prefetch(context.receivers[touched[i + 2]].inbox, 1);
        if (i + 1 < last) expect(touched[i + 1], context);
        judge_at(touched[i], context, own);
      }
      for (std::size_t k = 0; k < counts; ++k) sums[k] += own[k];
    });
    state.delivered += sums[Count::delivered];
    state.weak += sums[Count::weak];
    state.deaf += sums[Count::deaf];
    state.collided += sums[Count::collided];
    state.dropped += sums[Count::dropped];
    state.bits += sums[Count::bits];
    state.wrong_bits += sums[Count::wrong_bits];
    state.damaged += sums[Count::damaged];
  }

  /// Asks for the memory of a radio that is judged next.
  void expect(std::uint32_t index, const MediumContext& context) const {
    prefetch(arrivals[index].data(), arrivals[index].size());
    context.receivers[index].inbox->expect(arrivals[index].size());
  }

  /// A function with its latest value: powers at a receiver are often the same.
  template <double (*f)(double)>
  class Latest {
   public:
    double operator()(double x) {
      if (x != x_) x_ = x, value_ = f(x);
      return value_;
    }

   private:
    double x_ = std::numeric_limits<double>::quiet_NaN(), value_ = x_;
  };
  struct Powers {
    Latest<milliwatts> in_mW;
    Latest<decibels> in_dB;
  };

  /// Judges all that has arrived at a radio by now, in the order of arrival.
  void judge_at(std::uint32_t index, const MediumContext& context, std::array<std::uint64_t, counts>& sums) {
    std::vector<Signal>& signals = arrivals[index];
    const auto sooner = [](const Signal& a, const Signal& b) {
      return a.end != b.end ? a.end < b.end : a.transmission < b.transmission;
    };
    // Mostly they come so.
    if (!std::is_sorted(signals.begin(), signals.end(), sooner))
      std::sort(signals.begin(), signals.end(), sooner);
    Time longest;
    for (const Signal& each : signals) longest = std::max(longest, each.end - each.start);
    const Time delay = Time::from_s(spec.delay_s);
    Powers powers;
    // What is over disturbs only what was there before it ended.
    Time earliest = context.now;
    for (std::size_t i = 0; i < signals.size(); ++i) {
      Signal& each = signals[i];
      if (each.done || each.own) continue;
      if (each.end + delay > context.now) {
        earliest = std::min(earliest, each.start);
        continue;
      }
      each.done = 1;
      const double interference_mW = meet(i, signals, longest, powers, sums);
      if (interference_mW >= 0) receive(each, index, interference_mW, context, sums);
    }
    std::erase_if(signals,
                  [&](const Signal& each) { return (each.done || each.own) && each.end <= earliest; });
  }

  /// Holds a packet against all that overlaps it. @return what interferes, on average over the packet; -1: it is lost
  double meet(std::size_t at, const std::vector<Signal>& signals, Time longest, Powers& powers,
              std::array<std::uint64_t, counts>& sums) const {
    const Signal& packet = signals[at];
    if (packet.power_dBm < spec.sensitivity_dBm) return ++sums[Count::weak], -1;
    double sum_mW = 0, mean_mW = 0;
    bool overlapped = false;
    std::size_t first = at;
    while (first > 0 && signals[first - 1].end > packet.start) --first;
    for (std::size_t i = first; i < signals.size() && signals[i].end - longest < packet.end; ++i) {
      const Signal& other = signals[i];
      if (i == at || other.start >= packet.end || other.end <= packet.start) continue;
      if (other.own) return ++sums[Count::deaf], -1;
      if (!spec.collisions || other.channel != packet.channel) continue;
      overlapped = true;
      const double power_mW = powers.in_mW(other.power_dBm);
      const Time shared = std::min(packet.end, other.end) - std::max(packet.start, other.start);
      const auto whole_ns = static_cast<double>(std::max<std::int64_t>(1, (packet.end - packet.start).ns));
      sum_mW += power_mW;
      mean_mW += power_mW * (static_cast<double>(shared.ns) / whole_ns);
    }
    if (overlapped && packet.power_dBm - powers.in_dB(sum_mW) < spec.capture_dB)
      return ++sums[Count::collided], -1;
    return mean_mW;
  }

  /// Puts a packet that was not lost on the way into the inbox of its receiver.
  void receive(const Signal& signal, std::uint32_t index, double interference_mW,
               const MediumContext& context, std::array<std::uint64_t, counts>& sums) const {
    constexpr std::uint64_t use = 0x72656365697665;  // "receive"
    const Transmission& sent = state.transmissions[signal.transmission - state.first];
    const PacketView packet = *read_packet(sent.packet);
    const std::size_t data = packet.data.size();
    Inbox& inbox = *context.receivers[index].inbox;
    double p = spec.bit_error_rate;
    if (spec.modulation != Modulation::none) {
      const double noise_mW = milliwatts(spec.noise_floor_dBm) + interference_mW;
      p = both(p, error_rate(spec.modulation, milliwatts(signal.power_dBm) / noise_mW));
    }
    std::optional<Stream> random;
    if (spec.drop > 0 || spec.bit_error_rate > 0 || spec.modulation != Modulation::none) {
      random.emplace(context.seed, hash_combine(hash_combine(sent.emitter, places.key(index)), use),
                     Purpose::medium, packet.number());
      if (random->uniform() < spec.drop) return void(++sums[Count::dropped]);
    }
    ++sums[Count::delivered];
    sums[Count::bits] += 8 * data;
    const Vec3 way_W = packet.point() - places.point(index);
    const double distance_m = norm(way_W);
    const DeliveryHead delivery{.at = signal.end + Time::from_s(spec.delay_s),
                                .emitter = sent.emitter,
                                .channel = signal.channel,
                                .strength = signal.power_dBm,
                                .direction_W = distance_m > 0 ? way_W * (1 / distance_m) : Vec3{}};
    if (!random) return inbox.lend(delivery, sent.packet);
    // A full inbox loses the packet, but not its part in the statistics of the air.
    std::vector<std::uint8_t> lost;
    std::span<std::uint8_t> payload = inbox.put(delivery, sent.packet);
    if (payload.empty()) payload = lost = sent.packet;
    PacketHead head = packet.head();
    head.wrong_bits = flip_bits(payload.last(data), p, *random);
    if (head.wrong_bits > 0) write_head(head, payload);
    sums[Count::wrong_bits] += head.wrong_bits;
    sums[Count::damaged] += head.wrong_bits > 0;
  }
};

}  // namespace

extern const MediumKind kind;
constinit const MediumKind kind = make_medium<Radio>({
    .name = "radio",
    .help = "Packets of data: range or path loss, air time, collisions, bit errors.",
});

}  // namespace sandlot::media::radio
