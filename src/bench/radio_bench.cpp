/// Radio: what a delivered packet costs, among 1000 robots that send ten times a second and have ten others in reach.
///
/// Measured is a run with packets less the same run whose packets the radios refuse because they are too long: queues,
/// propagation, collisions, inboxes, messages. The reference is a bare query of a grid, single precision, for the points within the reach of one: one per delivery.
#include <cmath>

#include "base/math.h"
#include "base/random.h"
#include "bench/bench.h"
#include "sim/test_radios.h"

namespace sandlot::bench {
namespace {

constexpr int robots = 1000, ticks = 10;
constexpr double reach_m = 2;

/// The reference: points in cells as wide as the reach.
class PointGrid {
 public:
  explicit PointGrid(std::span<const Vec3> points) {
    for (const Vec3& p : points) {
      points_.push_back({static_cast<float>(p.x), static_cast<float>(p.y)});
      columns_ = std::max(columns_, cell(points_.back().x) + 2);
      rows_ = std::max(rows_, cell(points_.back().y) + 2);
    }
    std::vector<std::vector<std::uint32_t>> cells(static_cast<std::size_t>(columns_ * rows_));
    for (std::uint32_t i = 0; i < points_.size(); ++i)
      cells[static_cast<std::size_t>(cell(points_[i].y) * columns_ + cell(points_[i].x))].push_back(i);
    for (const auto& each : cells) {
      start_.push_back(static_cast<std::uint32_t>(found_.size()));
      found_.insert(found_.end(), each.begin(), each.end());
    }
    start_.push_back(static_cast<std::uint32_t>(found_.size()));
  }
  /// @return how many lie within the reach; `out` holds which
  std::size_t query(std::uint32_t of, std::vector<std::uint32_t>& out) const {
    const Point at = points_[of];
    out.clear();
    const int i = cell(at.x), j = cell(at.y);
    for (int row = std::max(0, j - 1); row <= std::min(rows_ - 1, j + 1); ++row)
      for (int column = std::max(0, i - 1); column <= std::min(columns_ - 1, i + 1); ++column) {
        const auto slot = static_cast<std::size_t>(row * columns_ + column);
        for (std::uint32_t k = start_[slot]; k < start_[slot + 1]; ++k) {
          const Point p = points_[found_[k]];
          const float dx = p.x - at.x, dy = p.y - at.y;
          if (dx * dx + dy * dy <= static_cast<float>(reach_m * reach_m)) out.push_back(found_[k]);
        }
      }
    return out.size();
  }

 private:
  struct Point {
    float x, y;
  };
  static int cell(float x) { return static_cast<int>(x / static_cast<float>(reach_m)); }
  int columns_ = 0, rows_ = 0;
  std::vector<Point> points_;
  std::vector<std::uint32_t> start_, found_;
};

}  // namespace

std::vector<Row> radio() {
  // Ten others in reach: a density of 10 / (pi reach^2).
  const double side_m = std::sqrt(robots * math::pi * reach_m * reach_m / 10);
  Stream random(1, entity_key("places"), Purpose::placement, 0);
  std::vector<Vec3> places;
  for (int i = 0; i < robots; ++i) {
    const double x = random.uniform(0, side_m);
    places.push_back({x, random.uniform(0, side_m), 0});
  }
  const auto world = [&](const char* max_size) {
    test::Radios made(test::keys_of({{"range", std::to_string(reach_m)}}), 0.1);
    made.setup.engine = "planar";
    for (int i = 0; i < robots; ++i)
      made.add("r" + std::to_string(i), places[static_cast<std::size_t>(i)],
               test::keys_of({{"max_size", max_size}}));
    made.start();
    made.tick(5);
    return made;
  };
  test::Radios speaking = world("16"), silent = world("15");
  std::vector<std::string> names;
  for (int i = 0; i < robots; ++i) names.push_back("r" + std::to_string(i));
  const std::vector<std::uint8_t> data(16, 0x5a);
  const auto speak = [&](test::Radios& radios) {
    for (int tick = 0; tick < ticks; ++tick) {
      for (const std::string& name : names) radios.send(name, data);
      radios.tick();
    }
  };
  speak(speaking);
  const double before = speaking.value("media/air.delivered");
  int rounds = 0;
  const Timing run = compare(
      9, [&] { speak(speaking), ++rounds; }, [&] { speak(silent); });
  const double deliveries = (speaking.value("media/air.delivered") - before) / rounds;
  const PointGrid grid(places);
  std::vector<std::uint32_t> out;
  std::size_t found = 0;
  const auto count = static_cast<std::uint32_t>(deliveries);
  const Timing bare = compare(
      9, [] {},
      [&] {
        for (std::uint32_t i = 0; i < count; ++i) found += grid.query(i % robots, out);
      });
  SL_CHECK(found > 0);
  return {row("radio, per delivery, 1000 robots, 10 in reach", "ns",
              1e9 * (run.ours_s - run.reference_s) / deliveries, 1e9 * bare.reference_s / count, 3, 18)};
}

}  // namespace sandlot::bench
