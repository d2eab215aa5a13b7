#pragma once
/// Places of the receivers of a medium in a tick, in a grid that finds those near a point.
///
/// Cost     update: a pass over the receivers, on all threads, and one over the cells; about four receivers per cell. No heap
///          after warm-up.
#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <vector>

#include "media/medium.h"
#include "physics/parallel.h"
#include "physics/planar/hash_grid.h"

namespace sandlot::media {

class Places {
 public:
  void update(const MediumContext& context) {
    points_.resize(context.receivers.size());
    parallel_for(points_.size(), 256, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) points_[i] = context.pose(context.receivers[i]).p;
    });
    whole_ = {};
    if (points_.empty()) return;
    whole_ = {{points_[0].x, points_[0].y}, {points_[0].x, points_[0].y}};
    for (const Vec3& point : points_) {
      whole_.low = {std::min(whole_.low.x, point.x), std::min(whole_.low.y, point.y)};
      whole_.high = {std::max(whole_.high.x, point.x), std::max(whole_.high.y, point.y)};
    }
    // About four receivers per cell, were they spread evenly.
    const auto cells = std::bit_ceil(
        static_cast<std::uint32_t>(std::sqrt(static_cast<double>(points_.size()) / 4)) + 1);
    const double length_m = std::max(whole_.high.x - whole_.low.x, whole_.high.y - whole_.low.y);
    grid_.resize(std::max(length_m / cells, 1e-3), cells, cells);
    grid_.build(static_cast<std::uint32_t>(points_.size()), [&](std::uint32_t i) {
      const Vec2 at{points_[i].x, points_[i].y};
      return grid_.cover({at, at});
    });
  }
  const Vec3& point(std::uint32_t receiver) const { return points_[receiver]; }
  /// Fills `out` with the receivers within a distance in the plane, and some beyond it, in creation order.
  void find_near(Vec3 p, double distance_m, std::vector<std::uint32_t>& out) const {
    if (!find_around(p, distance_m, out)) std::sort(out.begin(), out.end());
  }
  /// Fills `out` with the receivers within a distance, in creation order.
  void find_within(Vec3 p, double distance_m, std::vector<std::uint32_t>& out) const {
    const bool sorted = find_around(p, distance_m, out);
    // With a margin for rounding, so that callers decide by the distance itself.
    const double squared_m2 = distance_m * distance_m * (1 + 1e-9);
    std::erase_if(out, [&](std::uint32_t index) {
      const Vec3 way = points_[index] - p;
      return !(dot(way, way) <= squared_m2);
    });
    if (!sorted) std::sort(out.begin(), out.end());
  }

 private:
  /// Fills `out` with the receivers in the cells about a point. @return whether they are in creation order
  bool find_around(Vec3 p, double distance_m, std::vector<std::uint32_t>& out) const {
    out.clear();
    const planar::Area area{{p.x - distance_m, p.y - distance_m}, {p.x + distance_m, p.y + distance_m}};
    if (area.low.x <= whole_.low.x && area.low.y <= whole_.low.y && area.high.x >= whole_.high.x &&
        area.high.y >= whole_.high.y) {
      out.resize(points_.size());
      std::iota(out.begin(), out.end(), 0u);
      return true;
    }
    const planar::HashGrid::Range range = grid_.cover(area);
    for (std::int64_t j = range.y0; j <= range.y1; ++j)
      for (std::int64_t i = range.x0; i <= range.x1; ++i) {
        const auto found = grid_.in_slot(grid_.slot(i, j));
        out.insert(out.end(), found.begin(), found.end());
      }
    return false;
  }

  std::vector<Vec3> points_;
  planar::Area whole_;  ///< about all of them
  planar::HashGrid grid_;
};

}  // namespace sandlot::media
