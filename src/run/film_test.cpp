#include "run/film.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "sim/load/load.h"
#include "sim/world/simulation.h"

namespace sandlot {
namespace {

/// A robot that turns on the spot.
std::vector<std::byte> snapshot_of_world() {
  Diagnostics diagnostics;
  LoadOptions options;
  options.text =
      "version: 1\nname: t\ntime: {step: 20 ms, stop: 100 s}\nrobots:\n"
      "  - {name: bot, model: {builder: diff_robot}, controller: {kind: sequence, steps: "
      "[{at: 0 s, orders: {drive: [0, 0, 1]}}]}, devices: {drive: {level: ideal}}}\n";
  auto setup = load("t.yaml", options, diagnostics);
  EXPECT_TRUE(setup) << setup.error().text();
  auto made = Simulation::create(std::move(*setup), {}, diagnostics);
  EXPECT_TRUE(made) << made.error().text();
  return (*made)->snapshot();
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

}  // namespace
}  // namespace sandlot
