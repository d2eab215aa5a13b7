#include "optics/shadow_grid.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sandlot::optics {
namespace {

using lanes::F;
using lanes::F3;
using lanes::I;

constexpr float no_height = -std::numeric_limits<float>::infinity();

bool casts(const Visual& visual) { return !visual.is_plane && visual.given.cast_shadows; }

Vec3 middle_of(const Bounds& b) {
  return {(b.lower[0] + b.upper[0]) / 2, (b.lower[1] + b.upper[1]) / 2, (b.lower[2] + b.upper[2]) / 2};
}

/// Extent of the box along a unit vector, to each side of its middle.
double reach_along(Vec3 axis, const Bounds& b) {
  return 0.5 * (std::abs(axis.x) * (b.upper[0] - b.lower[0]) + std::abs(axis.y) * (b.upper[1] - b.lower[1]) +
                std::abs(axis.z) * (b.upper[2] - b.lower[2]));
}

}  // namespace

void ShadowGrid::make(const PictureTree& tree, Vec3 to_light) {
  to_light_ = to_light;
  const Quat q = quat_between({0, 0, 1}, to_light);
  across_[0] = rotate(q, {1, 0, 0});
  across_[1] = rotate(q, {0, 1, 0});
  double size_m = 0;
  for (auto& reach : reach_m_) reach.clear();
  for (std::size_t i = 0; i < tree.size(); ++i) {
    if (!casts(tree.visual(i))) continue;
    const Bounds box = bounds(tree.visual(i).solid);
    for (std::size_t k = 0; k < 2; ++k) reach_m_[k].push_back(reach_along(across_[k], box));
    for (std::size_t k = 0; k < 3; ++k)
      size_m = std::max({size_m, std::abs(box.lower[k]), std::abs(box.upper[k])});
  }
  const std::size_t casting = reach_m_[0].size();
  side_ = static_cast<int>(std::clamp(12 * std::sqrt(static_cast<double>(casting)), 16.0, 128.0));
  cells_.assign(static_cast<std::size_t>(side_) * static_cast<std::size_t>(side_),
                {no_height, no_height, -1});
  if (casting == 0) return;
  for (std::size_t k = 0; k < 2; ++k) {
    // All shapes lie on the grid, but of very large ones only the middle: its cells are made for the others.
    auto& reach = reach_m_[k];
    const auto median = reach.begin() + static_cast<std::ptrdiff_t>((casting - 1) / 2);
    std::nth_element(reach.begin(), median, reach.end());
    const double most = 4 * *median + 0.01;
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (std::size_t i = 0; i < tree.size(); ++i) {
      if (!casts(tree.visual(i))) continue;
      const Bounds box = bounds(tree.visual(i).solid);
      const double at = dot(across_[k], middle_of(box)), part = std::min(reach_along(across_[k], box), most);
      low = std::min(low, at - part), high = std::max(high, at + part);
    }
    cell_m_[k] = std::max((high - low) / (side_ - 2), 1e-3);  // a board seen from its edge is of no width
    corner_m_[k] = low - cell_m_[k];
  }
  // Points come in single precision: they are off by a few roundings of what they are computed from.
  const double margin_m = 1e-3 + 4e-6 * size_m;
  far_m_ = static_cast<float>(2e6 * margin_m);
  for (std::size_t i = 0; i < tree.size(); ++i)
    if (casts(tree.visual(i))) add(bounds(tree.visual(i).solid), static_cast<int>(i), margin_m);
}

void ShadowGrid::raise(Cell& cell, float reach, int visual) const {
  if (reach > cell.first) {
    cell.others = cell.first;
    cell.first = reach;
    cell.highest = visual;
  } else {
    cell.others = std::max(cell.others, reach);
  }
}

void ShadowGrid::add(const Bounds& box, int visual, double margin_m) {
  const Vec3 middle = middle_of(box);
  int first[2], last[2];
  for (std::size_t k = 0; k < 2; ++k) {
    const double at = dot(across_[k], middle) - corner_m_[k], reach = reach_along(across_[k], box) + margin_m;
    const double end = side_ - 1;
    first[k] = static_cast<int>(std::clamp(std::floor((at - reach) / cell_m_[k]), 0.0, end));
    last[k] = static_cast<int>(std::clamp(std::floor((at + reach) / cell_m_[k]), 0.0, end));
  }
  const double highest = dot(to_light_, middle) + reach_along(to_light_, box) + margin_m;
  // A line towards the light leaves the box through one of three faces, at a distance that is linear across
  // the grid.
  struct Face {
    double at_corner, per_column, per_row;
  } faces[3];
  int count = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double towards = to_light_[k];
    if (std::abs(towards) < 1e-3) continue;
    const double plane = (towards > 0 ? box.upper[k] + margin_m : box.lower[k] - margin_m) / towards;
    const double a = -across_[0][k] / towards, b = -across_[1][k] / towards;
    Face& face = faces[count++];
    face = {plane + a * corner_m_[0] + b * corner_m_[1], a * cell_m_[0], b * cell_m_[1]};
    face.at_corner += std::max(face.per_column, 0.0) +
                      std::max(face.per_row, 0.0);  // the highest of a cell's corners
  }
  for (int row = first[1]; row <= last[1]; ++row)
    for (int column = first[0]; column <= last[0]; ++column) {
      double reach = highest;
      const bool border = row == 0 || column == 0 || row == side_ - 1 || column == side_ - 1;
      for (int i = 0; i < count && !border; ++i)
        reach = std::min(reach, faces[i].at_corner + faces[i].per_column * column + faces[i].per_row * row);
      raise(cells_[static_cast<std::size_t>(row * side_ + column)], static_cast<float>(reach + margin_m),
            visual);
    }
}

ShadowGrid::View ShadowGrid::from(const double base[3]) const {
  const Vec3 p{base[0], base[1], base[2]};
  View view;
  view.grid = this;
  view.column_0 = static_cast<float>((dot(across_[0], p) - corner_m_[0]) / cell_m_[0]);
  view.row_0 = static_cast<float>((dot(across_[1], p) - corner_m_[1]) / cell_m_[1]);
  view.height_0 = static_cast<float>(dot(to_light_, p));
  for (std::size_t k = 0; k < 3; ++k) {
    view.column[k] = static_cast<float>(across_[0][k] / cell_m_[0]);
    view.row[k] = static_cast<float>(across_[1][k] / cell_m_[1]);
    view.height[k] = static_cast<float>(to_light_[k]);
  }
  return view;
}

I ShadowGrid::doubtful(const View& view, const F3& at, I valid, I self) {
  const ShadowGrid& grid = *view.grid;
  const auto along = [&](float zero, const float* axis) {
    return zero + (axis[0] * at.x + axis[1] * at.y + axis[2] * at.z);
  };
  const auto cell = [&](F place) {
    return lanes::truncate(lanes::clamp(place, 0, static_cast<float>(grid.side_ - 1)));
  };
  const I index = cell(along(view.row_0, view.row)) * grid.side_ + cell(along(view.column_0, view.column));
  alignas(32) int cells[lanes::width];
  alignas(32) float reach[lanes::width] = {};
  lanes::store(cells, lanes::select(valid, index, I{}));
  for (int i = 0; i < lanes::width; ++i) {
    const Cell& c = grid.cells_[static_cast<std::size_t>(cells[i])];
    reach[i] = c.highest == self[i] ? c.others : c.first;
  }
  const F away = lanes::abs(at.x) + lanes::abs(at.y) + lanes::abs(at.z);
  return valid & ((along(view.height_0, view.height) <= lanes::load<F>(reach)) | (away > grid.far_m_));
}

}  // namespace sandlot::optics
