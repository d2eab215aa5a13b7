#include "run/film.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "assets/image/visible.h"
#include "sim/load/load.h"
#include "sim/world/simulation.h"

namespace sandlot {
namespace {

/// A robot that turns on the spot, or stands.
std::unique_ptr<Simulation> world(const std::string& step, double yaw_rad = 0, double turning_radps = 6) {
  Diagnostics diagnostics;
  LoadOptions options;
  const std::string text =
      "version: 1\nname: t\ntime: {step: " + step +
      ", stop: 100 s}\nrobots:\n"
      "  - {name: bot, rate: 20 Hz, pose: [0, 0, " +
      std::to_string(yaw_rad) +
      "], model: labbot/labbot.robi, controller: {kind: sequence, steps: [{at: 0 s, orders: {drive: [0, 0, " +
      std::to_string(turning_radps) + "]}}]}, devices: {drive: {level: ideal}}}\n";
  options.text = text;
  auto setup = load("t.yaml", options, diagnostics);
  EXPECT_TRUE(setup) << setup.error().text();
  auto made = Simulation::create(std::move(*setup), {}, diagnostics);
  EXPECT_TRUE(made) << made.error().text();
  return std::move(*made);
}

std::vector<std::byte> snapshot_of_world() { return world("20 ms")->snapshot(); }

/// Mean difference of the bytes of two pictures.
double apart(const assets::Picture& a, const assets::Picture& b) {
  EXPECT_EQ(a.rgb.size(), b.rgb.size());
  double sum = 0;
  for (std::size_t i = 0; i < a.rgb.size(); ++i) sum += std::abs(int(a.rgb[i]) - int(b.rgb[i]));
  return sum / static_cast<double>(a.rgb.size());
}

TEST(Film, HasAPictureForEachTimeAndChangesNothing) {
  const std::string file = testing::TempDir() + "film.mp4";
  const auto blank = snapshot_of_world();
  const auto run = [&](bool filmed) {
    Diagnostics diagnostics;
    auto again = Simulation::restore(blank, {}, diagnostics);
    EXPECT_TRUE(again);
    std::optional<Film> film;
    if (filmed) {
      FilmOptions options{.file = file,
                          .view = {.camera = "follow:bot", .width = 64, .height = 48, .samples = 1},
                          .rate_hz = 25};
      auto begun = Film::begin(options, **again);
      EXPECT_TRUE(begun) << begun.error().text();
      film = std::move(*begun);
    }
    for (int i = 0; i < 50; ++i) {
      EXPECT_TRUE((*again)->tick());
      if (film) { EXPECT_TRUE(film->take_due_pictures(**again)); }
    }
    if (film) {
      EXPECT_EQ(film->pictures(), 26u) << "at the start, and every 0.04 s of the second that follows";
      EXPECT_TRUE(film->finish());
    }
    return (*again)->state_hash();
  };
  EXPECT_EQ(run(true), run(false));
  EXPECT_GT(std::filesystem::file_size(file), 1000u);
  std::filesystem::remove(file);
}

TEST(Film, SlowMotionHasPicturesBetweenTheStepsAndChangesNothing) {
  const std::string file = testing::TempDir() + "slow.mp4";
  const auto run = [&](double speed, std::uint64_t pictures) {
    const auto sim = world("40 ms");
    FilmOptions options{.file = file,
                        .view = {.camera = "overhead", .width = 64, .height = 48, .samples = 1},
                        .rate_hz = 25,
                        .speed = speed};
    auto film = Film::begin(options, *sim);
    EXPECT_TRUE(film) << film.error().text();
    for (int i = 0; i < 10; ++i) {
      EXPECT_TRUE(sim->tick());
      EXPECT_TRUE(film->take_due_pictures(*sim));
    }
    EXPECT_EQ(film->pictures(), pictures) << speed;
    EXPECT_TRUE(film->finish());
    return sim->state_hash();
  };
  const auto unfilmed = world("40 ms");
  for (int i = 0; i < 10; ++i) ASSERT_TRUE(unfilmed->tick());
  // 0.4 s: one picture at the beginning, and one every 10, 40 and 200 ms.
  EXPECT_EQ(run(0.25, 41), unfilmed->state_hash());
  EXPECT_EQ(run(1, 11), unfilmed->state_hash());
  EXPECT_EQ(run(5, 3), unfilmed->state_hash());
  std::filesystem::remove(file);
}

TEST(Film, APictureBetweenTwoTicksShowsTheRobotOnItsWay) {
  const auto turns = world("50 ms");
  const draw::ViewpointOptions options{
      .from = Vec3{0, -0.5, 0.4}, .at = Vec3{}, .width = 120, .height = 90, .samples = 4};
  auto view = draw::Viewpoint::make(options, *turns);
  ASSERT_TRUE(view);
  for (int i = 0; i < 20; ++i) ASSERT_TRUE(turns->tick());
  const draw::TickPoses before = draw::TickPoses::of(*turns);
  const auto first = view->picture(*turns);
  ASSERT_TRUE(turns->tick());
  const auto last = view->picture(*turns);
  const draw::TickPoses after = draw::TickPoses::of(*turns);
  const draw::Moment moment = draw::moment_between(before, after, Time::from_s(1.0375));
  const auto between = view->picture(*turns, &moment);
  // 6 rad/s: 17 degrees a tick. A robot that stands at three quarters of them; its wheels have not turned.
  const double yaw_rad = rpy_from_quat(before.bodies[1].X_WB.q).z + 0.75 * 6 * 0.05;
  const auto stands = world("50 ms", yaw_rad, 0);
  for (int i = 0; i < 20; ++i) ASSERT_TRUE(stands->tick());
  auto there = draw::Viewpoint::make(options, *stands);
  ASSERT_TRUE(there);
  const auto wanted = there->picture(*stands);
  ASSERT_TRUE(first && last && wanted && between);
  const double to_last = apart(*between, *last), to_first = apart(*between, *first);
  EXPECT_LT(apart(*between, *wanted), 0.5 * to_last) << "within two degrees";
  EXPECT_GT(to_first, 1.5 * to_last);
  // The next picture is of the tick again.
  EXPECT_EQ(apart(*view->picture(*turns), *last), 0);
}

}  // namespace
}  // namespace sandlot
