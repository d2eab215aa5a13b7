#pragma once
/// Places in a tick, such as those of the receivers of a medium, in a grid that finds those near a point; of receivers, also what
/// decides whether they hear.
///
/// Cost     update: a pass over the places, on all threads, and one over the cells; about four of them per cell. A query looks at
///          all places of the cells about its circle, and sorts those within it. No heap after warm-up.
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
    // With a margin for rounding, so that callers decide by the distance itself.
    const double squared_m2 = distance_m * distance_m * (1 + 1e-9);
    const auto take = [&](std::uint32_t index) {
      const Vec3 way = all_[index].p_W - p_W;
      if (dot(way, way) <= squared_m2) out.push_back(index);
    };
    const planar::Area area{{p_W.x - distance_m, p_W.y - distance_m},
                            {p_W.x + distance_m, p_W.y + distance_m}};
    if (area.low.x <= whole_.low.x && area.low.y <= whole_.low.y && area.high.x >= whole_.high.x &&
        area.high.y >= whole_.high.y) {
      for (std::uint32_t i = 0; i < all_.size(); ++i) take(i);
      return;
    }
    const planar::HashGrid::Range range = grid_.cover(area);
    for (std::int64_t j = range.y0; j <= range.y1; ++j)
      for (std::int64_t i = range.x0; i <= range.x1; ++i)
        for (const std::uint32_t index : grid_.in_slot(grid_.slot(i, j))) take(index);
    std::sort(out.begin(), out.end());
  }

 private:
  std::vector<Place> all_;
  planar::Area whole_;  ///< about all of them
  planar::HashGrid grid_;
};

}  // namespace sandlot::media
