#pragma once
/// A uniform grid over the whole plane in a table of fixed size: cell (i, j) lies in slot (i mod columns, j
/// mod rows).
///
/// The grid has no edge that a body could cross, and a body that flies off costs the others nothing. Cells
/// that share a slot share their lists, so a list may name things that are elsewhere: callers test what they
/// find.
///
/// Cost     building: two passes over the things and one over the slots (counting sort), no heap after
///          warm-up.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "physics/planar/turn.h"

namespace sandlot::planar {

/// An axis-parallel rectangle.
struct Area {
  Vec2 low, high;
};

class HashGrid {
 public:
  /// Cells from (x0, y0) to (x1, y1) inclusive.
  struct Range {
    std::int64_t x0 = 0, y0 = 0, x1 = -1, y1 = -1;
    bool empty() const { return x1 < x0 || y1 < y0; }
  };

  /// @pre columns and rows are powers of two
  void resize(double cell_m, std::uint32_t columns, std::uint32_t rows) {
    per_m_ = 1 / cell_m;
    mask_x_ = columns - 1;
    mask_y_ = rows - 1;
    columns_ = columns;
  }
  std::uint32_t columns() const { return mask_x_ + 1; }
  std::uint32_t rows() const { return mask_y_ + 1; }
  std::int64_t cell(double x_m) const { return static_cast<std::int64_t>(std::floor(x_m * per_m_)); }

  /// The cells that an area touches, but no more than there are slots. Empty for areas that are not finite.
  Range cover(Area a) const {
    constexpr double limit_m = 1e12;
    if (!(a.low.x > -limit_m && a.low.y > -limit_m && a.high.x < limit_m && a.high.y < limit_m)) return {};
    const Range r{cell(a.low.x), cell(a.low.y), cell(a.high.x), cell(a.high.y)};
    return {r.x0, r.y0, std::min(r.x1, r.x0 + mask_x_), std::min(r.y1, r.y0 + mask_y_)};
  }
  std::uint32_t slot(std::int64_t i, std::int64_t j) const {
    return (static_cast<std::uint32_t>(j) & mask_y_) * columns_ + (static_cast<std::uint32_t>(i) & mask_x_);
  }
  /// A walk from cell to cell. Whole rows are counted in slots, so that finding a list takes no product; and
  /// the compiler can keep a copy in registers, as it cannot the vectors.
  struct Walk {
    const std::uint32_t *start, *things;
    std::uint32_t mask_x, mask_rows, columns;
    std::uint32_t i, row;  ///< modulo 2^32, of which the table's sizes are divisors
    std::uint32_t slot() const { return (row & mask_rows) + (i & mask_x); }
  };
  Walk walk_from(std::int64_t i, std::int64_t j) const {
    return {start_.data(),
            things_.data(),
            mask_x_,
            mask_y_ * columns_,
            columns_,
            static_cast<std::uint32_t>(i),
            static_cast<std::uint32_t>(j) * columns_};
  }

  /// Files things 0 .. count-1 under the cells of range_of(thing).
  template <class RangeOf>
  void build(std::uint32_t count, RangeOf&& range_of) {
    start_.assign(std::size_t{columns()} * rows() + 1, 0);
    ranges_.resize(count);
    for (std::uint32_t k = 0; k < count; ++k) {
      const Range r = ranges_[k] = range_of(k);
      for (std::int64_t j = r.y0; j <= r.y1; ++j)
        for (std::int64_t i = r.x0; i <= r.x1; ++i) ++start_[slot(i, j)];
    }
    std::uint32_t total = 0;
    for (std::uint32_t& s : start_) s = total += s;
    things_.resize(total);
    // Backwards, so that start_ ends as the begin of each list and the lists are in ascending order.
    for (std::uint32_t k = count; k-- > 0;) {
      const Range r = ranges_[k];
      for (std::int64_t j = r.y0; j <= r.y1; ++j)
        for (std::int64_t i = r.x0; i <= r.x1; ++i) things_[--start_[slot(i, j)]] = k;
    }
  }
  /// All things, slot by slot: those of a slot lie from first_of(slot) to first_of(slot + 1), and slots of a row one behind the
  /// other.
  std::span<const std::uint32_t> things() const { return things_; }
  std::uint32_t first_of(std::uint32_t s) const { return start_[s]; }
  std::span<const std::uint32_t> in_slot(std::uint32_t s) const {
    return {things_.data() + start_[s], start_[s + 1] - start_[s]};
  }

 private:
  double per_m_ = 1;
  std::uint32_t mask_x_ = 0, mask_y_ = 0, columns_ = 1;
  std::vector<std::uint32_t> start_{0, 0}, things_;
  std::vector<Range> ranges_;
};

}  // namespace sandlot::planar
