/// A hundred thousand messages and pictures between RoBIOS programs, at random times: none is from the future. And messages that
/// get lost and suffer wrong bits as a .sim file says.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "base/log.h"
#include "base/test_folder.h"
#include "programs/test_sandbox.h"
#include "sim/load/load.h"
#include "sim/test_world.h"

namespace sandlot::test {
namespace {

namespace fs = std::filesystem;

/// Robots in a row, 10 m apart, each in front of a red hand that only it sees: the hand's column in the picture tells the tick.
class Exchange {
 public:
  static constexpr std::array slots_ms{10, 20, 50, 70, 30, 50};
  static constexpr int robots = slots_ms.size(), step_ms = 10, codes = 64;
  // Pictures of 160 columns and 90 degrees: 80 pixels for a metre at 1 m.
  static constexpr double hand_m = 2, column_m = hand_m / 80;

  struct Totals {
    long sent = 0, expected = 0, received = 0, pictures = 0;
  };

  /// @param delay_ms  of the radio, beyond the time on the air
  Exchange(int duration_s, int delay_ms) : duration_s_(duration_s) {
    fs::permissions(folder_.path, fs::perms(0755));
    fs::copy_file("tests/robios/exchange.c", folder_.file("exchange.c"));
    // Header and data of 8 bytes at least with 250 kbit/s.
    const int air_ns = delay_ms * 1'000'000 + 700'000;
    std::ofstream out(folder_.file("exchange.yaml"));
    out << "version: 1\nphysics: planar\ntime: {step: " << step_ms << " ms}\nmedia:\n"
        << "  - {kind: radio, name: air, half_duplex: false, collisions: false, delay: " << delay_ms
        << " ms}\nthings:\n";
    for (int i = 0; i < robots; ++i)
      out << "  - {name: hand" << i << ", model: {builder: block, size: [0.02, " << 1.8 * column_m
          << ", 1], mass: 1}, pose: [" << hand_m + 0.01 << ", " << 10 * i << ", 0]}\n";
    out << "robots:\n";
    for (std::size_t i = 0; i < slots_ms.size(); ++i)
      out << "  - name: robot" << i << "\n    model: {builder: diff_robot}\n    pose: [0, " << 10 * i
          << ", 0]\n    devices:\n      radio: {kind: radio, link: base}\n      screen: {kind: screen}\n"
          << "      eye: {kind: camera, link: base, pose: [0, 0, 0.5, 0, 0, 0], width: 160, height: 4, "
          << "horizontal_fov: 90 deg, rate: 20, on_request: true}\n"
          << "    controller: {kind: robios, program: exchange.c, slot: " << slots_ms[i]
          << " ms, flags: [-DSEED=1, -DEND_MS=" << 1000 * duration_s << ", -DSTEP_NS=" << step_ms
          << "000000LL, -DAIR_NS=" << air_ns << ", -DCODES=" << codes << ", -DLAG=1]}\n";
  }

  /// Runs to the end of the programs. @return the hash, and what the programs counted together
  std::pair<std::uint64_t, Totals> run(int threads) {
    Totals totals;
    log::set_listener([&](log::Level, std::string_view text) {
      Totals one;
      const std::string line(text);
      if (line.find("wrong:") != line.npos) ADD_FAILURE() << line;
      const auto at = line.find("sent ");
      if (at == line.npos || std::sscanf(line.c_str() + at, "sent %ld expected %ld received %ld pictures %ld",
                                         &one.sent, &one.expected, &one.received, &one.pictures) != 4)
        return;
      totals.sent += one.sent;
      totals.expected += one.expected;
      totals.received += one.received;
      totals.pictures += one.pictures;
    });
    Diagnostics diagnostics;
    auto setup = load(folder_.file("exchange.yaml"), {}, diagnostics);
    EXPECT_TRUE(setup) << setup.error().text();
    const auto simulation = build(std::move(*setup), {.threads = threads, .start_programs = true});
    const int ticks = (duration_s_ + 3) * 1000 / step_ms;
    for (int tick = 1; tick <= ticks && !testing::Test::HasFailure(); ++tick) {
      const int code = tick % codes;
      const double column = 80 - codes + 2 * code + 1;  // its middle, from the left edge
      for (int i = 0; i < robots; ++i)
        simulation->submit(PoseRequest{"hand" + std::to_string(i),
                                       {{hand_m + 0.01, 10 * i + (80 - column) * column_m, 0}, {}}});
      advance(*simulation, 1);
    }
    log::set_listener({});
    return {simulation->state_hash(), totals};
  }

 private:
  int duration_s_;
  TestFolder folder_;
};

TEST(RobiosRadio, LosesMessagesAndBitsAsOftenAsASimFileSays) {
  SKIP_WITHOUT_SANDBOX();
  const double bit_error = 0.002, loss = 0.1;
  TestFolder folder;
  fs::permissions(folder.path, fs::perms(0755));
  fs::copy_file("tests/robios/noisy.c", folder.file("noisy.c"));
  std::ofstream(folder.file("noisy.sim"))
      << "S4 0 0 0 noisy.c\nS4 1000 0 0 noisy.c\nerror radio " << bit_error << " " << loss << "\n";
  long of = 0, received = 0, bits = 0, wrong = 0;
  log::set_listener([&](log::Level, std::string_view text) {
    const std::string line(text);
    const auto at = line.find(": of ");
    long one[4];
    if (at == line.npos || std::sscanf(line.c_str() + at, ": of %ld received %ld bits %ld wrong %ld", &one[0],
                                       &one[1], &one[2], &one[3]) != 4)
      return;
    of += one[0], received += one[1], bits += one[2], wrong += one[3];
  });
  Diagnostics diagnostics;
  auto setup = load(folder.file("noisy.sim"), {}, diagnostics);
  ASSERT_TRUE(setup) << setup.error().text();
  const auto simulation = build(std::move(*setup), {.start_programs = true});
  advance(*simulation, 1210);
  log::set_listener({});
  ASSERT_EQ(of, 5000);
  ASSERT_EQ(bits, received * 64 * 8);
  // Binomial numbers within 4.5 standard deviations: beyond those they are once in 150,000 times.
  const auto expect = [](long count, long of_all, double p) {
    const auto n = static_cast<double>(of_all);
    EXPECT_NEAR(static_cast<double>(count), n * p, 4.5 * std::sqrt(n * p * (1 - p))) << "of " << n;
  };
  expect(of - received, of, loss);
  expect(wrong, bits, bit_error);
}

TEST(RobiosExchanges, MessagesTakeTheTimeOfTheRadio) {
  SKIP_WITHOUT_SANDBOX();
  const Exchange::Totals totals = Exchange(10, 40).run(2).second;
  EXPECT_GT(totals.received, 5'000);
  EXPECT_EQ(totals.received, totals.expected);
}

TEST(SlowRobiosExchanges, NothingComesFromTheFuture) {
  SKIP_WITHOUT_SANDBOX();
  Exchange exchange(180, 0);
  const auto [hash, totals] = exchange.run(1);
  EXPECT_GE(totals.received + totals.pictures, 100'000);
  EXPECT_GE(totals.pictures, 3'000);
  EXPECT_EQ(totals.received, totals.expected);
  std::printf("%ld messages sent, %ld received, %ld pictures\n", totals.sent, totals.received,
              totals.pictures);
  for (const int threads : {2, 4}) EXPECT_EQ(exchange.run(threads).first, hash) << threads << " threads";
}

}  // namespace
}  // namespace sandlot::test
