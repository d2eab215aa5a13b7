#include "run/film.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "assets/image/visible.h"
#include "sim/load/load.h"
#include "sim/world/simulation.h"

namespace sandlot {
namespace {

/// A robot that turns on the spot.
std::unique_ptr<Simulation> world(const std::string& step) {
  Diagnostics diagnostics;
  LoadOptions options;
  const std::string text =
      "version: 1\nname: t\ntime: {step: " + step +
      ", stop: 100 s}\nrobots:\n"
      "  - {name: bot, model: {builder: diff_robot}, controller: {kind: sequence, steps: "
      "[{at: 0 s, orders: {drive: [0, 0, 1]}}]}, devices: {drive: {level: ideal, rate: 2}}}\n";
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

TEST(Film, APictureBetweenTwoTicksIsThatOfAWorldWithShorterOnes) {
  const auto coarse = world("400 ms"), fine = world("100 ms");
  const draw::ViewpointOptions options{.camera = "overhead", .width = 120, .height = 90, .samples = 4};
  auto view = draw::Viewpoint::make(options, *coarse), same = draw::Viewpoint::make(options, *fine);
  ASSERT_TRUE(view && same);
  ASSERT_TRUE(coarse->tick());
  const draw::TickPoses before = draw::TickPoses::of(*coarse);
  const auto first = view->picture(*coarse);
  ASSERT_TRUE(coarse->tick());
  const auto last = view->picture(*coarse);
  const draw::TickPoses after = draw::TickPoses::of(*coarse);
  // It turns at 1 rad/s: 17 degrees from picture to picture.
  for (int i = 0; i < 7; ++i) ASSERT_TRUE(fine->tick());
  const auto wanted = same->picture(*fine);
  const draw::Moment moment = draw::moment_between(before, after, Time::from_s(0.7));
  const auto between = view->picture(*coarse, &moment);
  ASSERT_TRUE(first && last && wanted && between);
  EXPECT_LT(apart(*between, *wanted), 0.05);
  EXPECT_GT(apart(*between, *first), 0.5);
  EXPECT_GT(apart(*between, *last), 0.3);
  // The next picture is of the tick again.
  EXPECT_EQ(apart(*view->picture(*coarse), *last), 0);
}

}  // namespace
}  // namespace sandlot
