#pragma once
/// Places in a tick, such as those of the receivers of a medium, in a grid that finds those near a point; of receivers, also what
/// decides whether they hear.
///
/// Cost     update: a pass over the places, on all threads, and one over the cells; about four of them per cell. A query looks at
///          all places of the cells about its circle, which lie together row by row, and sorts those within it where their order is
///          asked for. No heap after warm-up.
#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>
#include <vector>

#include "media/medium.h"
#include "physics/parallel.h"
#include "physics/planar/hash_grid.h"

namespace sandlot::media {

class Places {
 public:
  struct Place {
    Vec3 p_W;
    std::uint64_t key = 0;                     ///< of a receiver
    std::optional<std::int32_t> channel = {};  ///< that a receiver listens to; empty: all
  };
  /// Those of the receivers of a medium.
  void update(const MediumContext& context) {
    update(context.receivers.size(), [&](std::size_t i) -> Place {
      const Receiver& receiver = context.receivers[i];
      return {context.pose(receiver).p, receiver.key, receiver.inbox->channel()};
    });
  }
  /// @param place_of  place number i; called on several threads
  template <class PlaceOf>
  void update(std::size_t count, PlaceOf&& place_of) {
    all_.resize(count);
    parallel_for(all_.size(), 256, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) all_[i] = place_of(i);
    });
    whole_ = {};
    filed_.clear();
    if (all_.empty()) return;
    whole_ = {{all_[0].p_W.x, all_[0].p_W.y}, {all_[0].p_W.x, all_[0].p_W.y}};
    for (const Place& each : all_) {
      whole_.low = {std::min(whole_.low.x, each.p_W.x), std::min(whole_.low.y, each.p_W.y)};
      whole_.high = {std::max(whole_.high.x, each.p_W.x), std::max(whole_.high.y, each.p_W.y)};
    }
    // About four receivers per cell, were they spread evenly.
    const auto cells = std::bit_ceil(
        static_cast<std::uint32_t>(std::sqrt(static_cast<double>(all_.size()) / 4)) + 1);
    const double length_m = std::max(whole_.high.x - whole_.low.x, whole_.high.y - whole_.low.y);
    grid_.resize(std::max(length_m / cells, 1e-3), cells, cells);
    grid_.build(static_cast<std::uint32_t>(all_.size()), [&](std::uint32_t i) {
      const Vec2 at{all_[i].p_W.x, all_[i].p_W.y};
      return grid_.cover({at, at});
    });
    filed_.resize(grid_.things().size());
    for (std::size_t i = 0; i < filed_.size(); ++i)
      filed_[i] = {all_[grid_.things()[i]].p_W, grid_.things()[i]};
  }
  const Vec3& point(std::uint32_t receiver) const { return all_[receiver].p_W; }
  std::uint64_t key(std::uint32_t receiver) const { return all_[receiver].key; }
  /// Whether a receiver listens to a channel.
  bool hears(std::uint32_t receiver, std::int32_t channel) const {
    return all_[receiver].channel.value_or(channel) == channel;
  }
  /// Fills `out` with the receivers within a distance, in creation order.
  void find_within(Vec3 p_W, double distance_m, std::vector<std::uint32_t>& out) const {
    out.clear();
    visit_near(p_W, distance_m, [&](std::span<const Filed> row, double squared_m2) {
      for (const Filed& each : row)
        if (squared(each.p_W - p_W) <= squared_m2) out.push_back(each.index);
    });
    std::sort(out.begin(), out.end());
  }
  struct Near {
    std::uint32_t index = 0;
    double squared_m2 = 0;  ///< of its distance
  };
  /// The same in the order of the cells, which the places alone decide; for those whom the order does not matter.
  /// @param memory  of what is returned; only grows
  std::span<const Near> find_within(Vec3 p_W, double distance_m, std::vector<Near>& memory) const {
    std::size_t count = 0;
    visit_near(p_W, distance_m, [&](std::span<const Filed> row, double squared_m2) {
      if (memory.size() < count + row.size()) memory.resize(count + row.size());
      for (const Filed& each : row) {
        const double of_each_m2 = squared(each.p_W - p_W);
        memory[count] = {each.index, of_each_m2};
        count += of_each_m2 <= squared_m2 ? 1 : 0;
      }
    });
    return std::span(memory).first(count);
  }

 private:
  struct Filed {
    Vec3 p_W;
    std::uint32_t index = 0;
  };
  static double squared(Vec3 way) { return dot(way, way); }
  /// Calls `take` with those that may be within a distance, cells of a row together, and the square of the distance, with a margin
  /// for rounding, so that callers decide by the distance itself.
  template <class Take>
  void visit_near(Vec3 p_W, double distance_m, Take&& take) const {
    const double squared_m2 = distance_m * distance_m * (1 + 1e-9);
    const std::span<const Filed> filed(filed_);
    const planar::Area area{{p_W.x - distance_m, p_W.y - distance_m},
                            {p_W.x + distance_m, p_W.y + distance_m}};
    if (area.low.x <= whole_.low.x && area.low.y <= whole_.low.y && area.high.x >= whole_.high.x &&
        area.high.y >= whole_.high.y)
      return take(filed, squared_m2);
    const planar::HashGrid::Range range = grid_.cover(area);
    if (range.empty()) return;
    for (std::int64_t j = range.y0; j <= range.y1; ++j) {
      const auto in_cells = [&](std::uint32_t first, std::uint32_t last) {
        const std::uint32_t begin = grid_.first_of(first), end = grid_.first_of(last + 1);
        take(filed.subspan(begin, end - begin), squared_m2);
      };
      const std::uint32_t first = grid_.slot(range.x0, j), last = grid_.slot(range.x1, j);
      if (first <= last) {
        in_cells(first, last);
      } else {  // the row goes on at the beginning of the table's
        in_cells(first, grid_.slot(-1, j));
        in_cells(grid_.slot(0, j), last);
      }
    }
  }

  std::vector<Place> all_;
  std::vector<Filed> filed_;  ///< in the order of the grid: those near each other together
  planar::Area whole_;        ///< about all of them
  planar::HashGrid grid_;
};

}  // namespace sandlot::media
