#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>

#include "base/math.h"
#include "base/math_erfc.h"
#include "base/random.h"
#include "sim/test_radios.h"
#include "validation/validation.h"

namespace sandlot::validation {
namespace {

using test::keys_of;
using test::Radios;

constexpr const char* medium = "radio";
constexpr double deviations = 3;

double decibels(double ratio) { return 10 / std::numbers::ln10 * math::log(ratio); }

/// Standard error of a share of n trials.
double share_error(double p, double n) { return std::sqrt(p * (1 - p) / n); }

std::vector<std::uint8_t> bytes(std::size_t count) { return std::vector<std::uint8_t>(count, 0x5a); }

// ------------------------------------------------------------------------------------------------------ propagation

void propagation(Section& s) {
  constexpr double exponent = 2.7, reference_dB = 38, power_dBm = 13;
  Radios world(keys_of({{"model", "log_distance"},
                        {"exponent", fmt::format("{}", exponent)},
                        {"reference_loss", fmt::format("{}", reference_dB)},
                        {"sensitivity", "-150"}}));
  const std::array distances_m{0.5, 3.0, 10.0, 42.0};
  world.add("sender", {}, keys_of({{"power", fmt::format("{}", power_dBm)}}));
  for (const double d : distances_m) world.add(fmt::format("at_{:.0f}", 10 * d), {d, 0, 0});
  world.start();
  world.send("sender", bytes(1));
  world.tick();
  for (const double d : distances_m) {
    const auto packets = world.received(fmt::format("at_{:.0f}", 10 * d));
    s.rows.push_back({fmt::format("received power at {} m, exponent {}", d, exponent), medium, "dBm",
                      packets.empty() ? NAN : packets.front().rssi,
                      power_dBm - reference_dB - 10 * exponent * decibels(std::max(1.0, d)) / 10, 1e-9,
                      false});
  }
  // Shadowing: 500 receivers on a circle, each with a loss of its own.
  constexpr int others = 500;
  constexpr double shadowing_dB = 4, radius_m = 10;
  Radios ring(keys_of({{"model", "log_distance"},
                       {"shadowing", fmt::format("{}", shadowing_dB)},
                       {"sensitivity", "-250"},
                       {"noise_floor", "-250"}}));
  ring.add("sender", {});
  for (int i = 0; i < others; ++i) {
    const auto [sine, cosine] = math::sincos(math::tau * i / others);
    ring.add(fmt::format("r{}", i), {radius_m * cosine, radius_m * sine, 0});
  }
  ring.start();
  ring.send("sender", bytes(1));
  ring.tick();
  const double middle_dBm = 20 - 40 - 10 * 2.5;
  double sum = 0, squares = 0;
  for (int i = 0; i < others; ++i) {
    const auto packets = ring.received(fmt::format("r{}", i));
    const double x = packets.empty() ? NAN : packets.front().rssi - middle_dBm;
    sum += x, squares += x * x;
  }
  const double mean = sum / others, std = std::sqrt(squares / others - mean * mean);
  s.rows.push_back({"shadowing of 4 dB: mean of 500 pairs", medium, "dB", mean, 0,
                    deviations * shadowing_dB / std::sqrt(others), false});
  // Cut off at three deviations, a normal has 0.9975 of its deviation.
  s.rows.push_back({"shadowing of 4 dB: standard deviation of 500 pairs", medium, "dB", std,
                    0.9975 * shadowing_dB, deviations * shadowing_dB / std::sqrt(2.0 * others), false});
}

// ------------------------------------------------------------------------------------------------------------- time

void times(Section& s) {
  constexpr double distance_m = 3000, delay_s = 2e-3, bandwidth = 250e3;
  constexpr int header = 192, size = 100;
  Radios world(keys_of({{"range", "4000"},
                        {"delay", fmt::format("{}", delay_s)},
                        {"bandwidth", fmt::format("{}", bandwidth)},
                        {"header", fmt::format("{}", header)},
                        {"jitter", "0"}}),
               0.001);
  world.add("sender", {});
  world.add("near", {distance_m, 0, 0});
  world.add("far", {4001, 0, 0});
  world.start();
  world.send("sender", bytes(size));
  world.send("sender", bytes(size));
  const double air_s = (header + 8.0 * size) / bandwidth;
  const double arrival_s = air_s + distance_m / 299'792'458 + delay_s;
  std::vector<double> arrivals_s;
  double beyond = 0, early = 0;
  for (int i = 0; i < 30; ++i) {
    world.tick();
    beyond += static_cast<double>(world.received("far").size());
    for (const auto& packet : world.received("near")) {
      arrivals_s.push_back(packet.stamp.s());
      early += packet.stamp > world.simulation->now() ||
               packet.stamp <= world.simulation->now() - world.setup.step;
    }
  }
  arrivals_s.resize(2, NAN);
  s.rows.push_back({"arrival of 992 bits at 250 kbit/s over 3 km, 2 ms of delay", medium, "ms",
                    1e3 * arrivals_s[0], 1e3 * arrival_s, 2e-6, false});
  s.rows.push_back({"time on the air: the next packet of the radio comes later by", medium, "ms",
                    1e3 * (arrivals_s[1] - arrivals_s[0]), 1e3 * air_s, 2e-6, false});
  s.rows.push_back(
      {"packets delivered in another tick than that of their arrival", medium, "1", early, 0, 0, false});
  s.rows.push_back({"packets received 1 m beyond the range", medium, "1", beyond, 0, 0, false});
}

// ----------------------------------------------------------------------------------------------------------- errors

struct Tally {
  double bits = 0, wrong = 0, sent = 0, arrived = 0, intact = 0;
};

/// Packets of 100 bytes from one radio to another, 10 m away.
Tally tally(Node keys, int packets, bool one_more = false, std::vector<std::uint64_t>* which = nullptr) {
  constexpr int per_tick = 50;
  keys.set("bandwidth", Node::scalar("1e9"));
  Radios world(std::move(keys));
  world.add("sender", {});
  Node levels = Node::sequence(), receiver = Node::map();
  for (const char* level : {"packets", "bits"}) levels.push(Node::scalar(level));
  receiver.set("levels", levels);
  world.add("receiver", {10, 0, 0}, receiver);
  if (one_more) world.add("aardvark", {0, 10, 0});
  world.start();
  Tally t;
  for (int n = 0; n < packets; n += per_tick) {
    for (int i = 0; i < per_tick; ++i) world.send("sender", bytes(100));
    world.tick();
    t.intact += static_cast<double>(world.received("receiver").size());
    if (which)
      for (const auto& packet : world.received("receiver", "bits"))
        which->push_back(hash64(std::as_bytes(std::span(packet.data))));
  }
  t.sent = world.value("media/air.sent");
  t.arrived = world.value("receiver/radio.received");
  if (!one_more) {
    t.bits = world.value("media/air.bits");
    t.wrong = world.value("media/air.wrong_bits");
  }
  return t;
}

void bit_errors(Section& s) {
  constexpr int packets = 2000;
  const auto rate = [&](const std::string& what, Node keys, double p) {
    const Tally t = tally(std::move(keys), packets);
    s.rows.push_back({what + ": bits wrong", medium, "1", t.wrong / t.bits, p,
                      deviations * share_error(p, t.bits), false});
    const double kept = math::pow(1 - p, 800);
    s.rows.push_back({what + ": packets of 800 bits lost by their checksum", medium, "1",
                      1 - t.intact / t.arrived, 1 - kept, deviations * share_error(kept, t.arrived), false});
  };
  rate("bit error rate 0.001", keys_of({{"bit_error_rate", "0.001"}}), 0.001);
  // 20 dBm - 40 dB - 25 dB at 10 m are -45 dBm.
  const auto modulated = [](const char* name, double ratio_dB) {
    return keys_of({{"model", "log_distance"},
                    {"modulation", name},
                    {"noise_floor", fmt::format("{}", -45 - ratio_dB)}});
  };
  const double ratio = math::exp(6 * std::numbers::ln10 / 10);
  rate("bpsk, 6 dB above the noise", modulated("bpsk", 6), 0.5 * math::erfc(std::sqrt(ratio)));
  rate("qpsk, 6 dB above the noise", modulated("qpsk", 6), 0.5 * math::erfc(std::sqrt(ratio / 2)));
  rate("fsk, 6 dB above the noise", modulated("fsk", 6), 0.5 * math::exp(-ratio / 2));
  const Tally dropping = tally(keys_of({{"drop", "0.2"}}), packets);
  s.rows.push_back({"packets dropped, probability 0.2", medium, "1", 1 - dropping.arrived / dropping.sent,
                    0.2, deviations * share_error(0.2, dropping.sent), false});
  std::vector<std::uint64_t> alone, in_company;
  tally(keys_of({{"bit_error_rate", "0.001"}, {"drop", "0.2"}}), 500, false, &alone);
  tally(keys_of({{"bit_error_rate", "0.001"}, {"drop", "0.2"}}), 500, true, &in_company);
  s.rows.push_back({"packets whose errors change when a third radio listens", medium, "1",
                    alone == in_company && !alone.empty() ? 0.0 : 1.0, 0, 0, false});
}

// ----------------------------------------------------------------------------------------------------------- access

struct Throughput {
  double mean = 0, error = 0;  ///< packets per air time of a packet
};

/// Packets that begin as a Poisson process, of G per air time, from many radios to one that listens.
Throughput throughput(const char* access, double load) {
  constexpr double air_s = 0.01, step_s = 0.1;
  constexpr int senders = 60, batches = 100, ticks_per_batch = 20;
  Radios world(keys_of({{"bandwidth", "100e3"},
                        {"header", "0"},
                        {"capture", "1000"},
                        {"access", access},
                        {"queue", "10"}}),
               step_s);
  world.add("sink", {});
  for (int i = 0; i < senders; ++i) {
    const auto [sine, cosine] = math::sincos(math::tau * i / senders);
    world.add(fmt::format("r{}", i), {cosine, sine, 0});
  }
  world.start();
  Stream random(1, entity_key("arrivals"), Purpose::experiment, static_cast<std::uint64_t>(1000 * load));
  // Given how many packets there are in a tick, a Poisson process puts each anywhere in it: so does the medium.
  double next_s = -air_s / load * math::log(1 - random.uniform());
  std::vector<double> rates;
  int sender = 0;
  double before = 0;
  for (int batch = 0; batch < batches; ++batch) {
    for (int tick = 0; tick < ticks_per_batch; ++tick) {
      const double end_s = (batch * ticks_per_batch + tick + 1) * step_s;
      for (; next_s < end_s; next_s -= air_s / load * math::log(1 - random.uniform())) {
        world.send(fmt::format("r{}", sender), bytes(125), "sink");
        sender = (sender + 1) % senders;
      }
      world.tick();
    }
    const double received = world.value("sink/radio.received");
    rates.push_back((received - before) * air_s / (ticks_per_batch * step_s));
    before = received;
  }
  Throughput out;
  for (const double rate : rates) out.mean += rate / batches;
  double squares = 0;
  for (const double rate : rates) squares += (rate - out.mean) * (rate - out.mean);
  out.error = std::sqrt(squares / (batches - 1) / batches);
  return out;
}

void access(Section& s) {
  Figure figure{"radio_access",
                "Throughput over offered load",
                {"G", "ALOHA", "G exp(-2 G)", "CSMA"},
                {"1", "1", "1", "1"},
                {{}, {}, {}, {}}};
  double csma_wins = 0, loads = 0;
  for (const double load : {0.1, 0.25, 0.5, 0.75, 1.0, 1.5, 2.0}) {
    const Throughput aloha = throughput("aloha", load), csma = throughput("csma", load);
    const double theory = load * math::exp(-2 * load);
    s.rows.push_back({fmt::format("pure ALOHA, load {}: throughput", load), medium, "1", aloha.mean, theory,
                      deviations * aloha.error, false});
    if (load >= 0.25) {
      ++loads;
      csma_wins += csma.mean > aloha.mean + deviations * (aloha.error + csma.error);
    }
    const double columns[] = {load, aloha.mean, theory, csma.mean};
    for (std::size_t i = 0; i < 4; ++i) figure.columns[i].push_back(columns[i]);
  }
  s.rows.push_back(
      {"loads from 0.25 on at which CSMA carries more than ALOHA", medium, "1", csma_wins, loads, 0, false});
  s.figures.push_back(std::move(figure));
}

}  // namespace

Section radio() {
  Section s{
      "radio",
      "Radio",
      "The medium `radio` against closed forms. Received power follows the log-distance law; arrival is "
      "the time on the air plus flight plus delay, to the nanosecond. Bits are wrong as a binary symmetric "
      "channel, "
      "with a constant probability or one that follows from modulation and noise, and a packet of n bits "
      "passes its "
      "checksum with (1 - p)^n; bounds are three binomial standard errors. Pure ALOHA carries S = G exp(-2 "
      "G) packets "
      "per packet's time when G of them begin as a Poisson process and none is captured: at most 0.184, at G "
      "= 0.5. "
      "The bounds are three standard errors of 100 batches of 200 packets' times. Carrier sense carries "
      "more.",
      {},
      {}};
  propagation(s);
  times(s);
  bit_errors(s);
  access(s);
  return s;
}

}  // namespace sandlot::validation
