#pragma once
/// The loop that P2 compares with: discs in a bounded grid, single precision, nothing but the walk through
/// the cells.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "geometry/vec3.h"

namespace sandlot::bench {

class BareGrid {
 public:
  /// @param discs  x, y and the radius
  BareGrid(std::span<const Vec3> discs, double cell_m) : cell_(static_cast<float>(cell_m)), per_(1 / cell_) {
    for (const Vec3 d : discs) {
      discs_.push_back({static_cast<float>(d.x), static_cast<float>(d.y), static_cast<float>(d.z * d.z)});
      const auto r = static_cast<float>(d.z);
      low_x_ = std::min(low_x_, discs_.back().x - r);
      low_y_ = std::min(low_y_, discs_.back().y - r);
      high_x_ = std::max(high_x_, discs_.back().x + r);
      high_y_ = std::max(high_y_, discs_.back().y + r);
    }
    columns_ = column(high_x_) + 1;
    rows_ = row(high_y_) + 1;
    std::vector<std::vector<std::uint32_t>> cells(static_cast<std::size_t>(columns_ * rows_));
    for (std::uint32_t k = 0; k < discs_.size(); ++k) {
      const auto r = static_cast<float>(discs[k].z);
      for (int j = row(discs_[k].y - r); j <= row(discs_[k].y + r); ++j)
        for (int i = column(discs_[k].x - r); i <= column(discs_[k].x + r); ++i)
          cells[static_cast<std::size_t>(j * columns_ + i)].push_back(k);
    }
    for (const auto& cell : cells) {
      start_.push_back(static_cast<std::uint32_t>(things_.size()));
      things_.insert(things_.end(), cell.begin(), cell.end());
    }
    start_.push_back(static_cast<std::uint32_t>(things_.size()));
  }

  float cast(float ox, float oy, float dx, float dy, float max_m, std::uint32_t ignored) const {
    float best = max_m;
    bool found = false;
    int i = column(ox), j = row(oy);
    const int step_i = dx < 0 ? -1 : 1, step_j = dy < 0 ? -1 : 1;
    const float inf = std::numeric_limits<float>::infinity();
    const float per_x = dx != 0 ? 1 / dx : inf, per_y = dy != 0 ? 1 / dy : inf;
    float t_x = dx != 0 ? (low_x_ + cell_ * static_cast<float>(i + (dx < 0 ? 0 : 1)) - ox) * per_x : inf;
    float t_y = dy != 0 ? (low_y_ + cell_ * static_cast<float>(j + (dy < 0 ? 0 : 1)) - oy) * per_y : inf;
    const float delta_x = cell_ * std::abs(per_x), delta_y = cell_ * std::abs(per_y);
    while (i >= 0 && i < columns_ && j >= 0 && j < rows_) {
      const auto cell = static_cast<std::size_t>(j * columns_ + i);
      for (std::uint32_t k = start_[cell]; k < start_[cell + 1]; ++k) {
        const Disc& disc = discs_[things_[k]];
        const float cx = disc.x - ox, cy = disc.y - oy;
        const float side = cx * dy - cy * dx, square = disc.radius2 - side * side;
        if (square < 0 || things_[k] == ignored) continue;
        const float t = cx * dx + cy * dy - std::sqrt(square);
        if (t >= 0 && t < best) best = t, found = true;
      }
      const float leave = std::min(t_x, t_y);
      if (best <= leave) break;
      if (t_x < t_y) t_x += delta_x, i += step_i;
      else t_y += delta_y, j += step_j;
    }
    return found ? best : inf;
  }

 private:
  struct Disc {
    float x, y, radius2;
  };
  int column(float x) const { return static_cast<int>((x - low_x_) * per_); }
  int row(float y) const { return static_cast<int>((y - low_y_) * per_); }

  float cell_, per_;
  float low_x_ = 1e9f, low_y_ = 1e9f, high_x_ = -1e9f, high_y_ = -1e9f;
  int columns_ = 0, rows_ = 0;
  std::vector<Disc> discs_;
  std::vector<std::uint32_t> start_, things_;
};

}  // namespace sandlot::bench
