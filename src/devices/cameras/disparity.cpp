#include "devices/cameras/disparity.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <utility>
#include <vector>

#include "base/check.h"

namespace sandlot::cameras {
namespace {

constexpr int steepest = 31;

/// Horizontal slopes of one row, 0 to 2 * steepest, steepest: none. The columns at the sides have none; rows beyond the picture are as
/// its last ones.
void slopes_of_row(std::span<const std::uint8_t> picture, int width, int height, int row,
                   std::uint8_t* slope) {
  const auto at = [&](int v) {
    return picture.data() + static_cast<std::ptrdiff_t>(std::clamp(v, 0, height - 1)) * width;
  };
  const std::uint8_t *const above = at(row - 1), *const here = at(row), *const below = at(row + 1);
  slope[0] = slope[width - 1] = steepest;
  for (int u = 1; u + 1 < width; ++u) {
    const int s = above[u + 1] - above[u - 1] + 2 * (here[u + 1] - here[u - 1]) + below[u + 1] - below[u - 1];
    slope[u] = static_cast<std::uint8_t>(std::clamp(s / 4, -steepest, steepest) + steepest);
  }
}

/// Disparities are handled by so many at once.
constexpr int lanes = 16;
using Costs = std::uint16_t __attribute__((vector_size(2 * lanes)));
using Slopes = std::uint8_t __attribute__((vector_size(lanes)));
constexpr int padded(int count) { return (count + lanes - 1) / lanes * lanes; }

template <class Vector, class Number>
inline Vector load(const Number* from) {
  Vector v;
  std::memcpy(&v, from, sizeof v);
  return v;
}
inline void store(Costs v, std::uint16_t* to) { std::memcpy(to, &v, sizeof v); }

/// What is added up over windows: for each column the sum over a window's rows, for each disparity. Where a disparity leads out of the
/// right picture the sum means nothing.
class Columns {
 public:
  Columns(int width, int least, int count)
      : width_(width),
        least_(least),
        count_(padded(count)),
        cost_(static_cast<std::size_t>(width) * static_cast<std::size_t>(count_)),
        texture_(static_cast<std::size_t>(width)) {}

  /// Adds a row of slopes (sign 1) or takes it away (-1). The right row is stored from its end, so that disparities lie one after the
  /// other, with room behind it.
  template <int sign>
  void add(const std::uint8_t* left, const std::uint8_t* right_reversed) {
    for (int u = 0; u < width_; ++u) {
      const int l = left[u];
      texture_[static_cast<std::size_t>(u)] += sign * std::abs(l - steepest);
      std::uint16_t* const cost = &cost_[static_cast<std::size_t>(u) * static_cast<std::size_t>(count_)];
      const std::uint8_t* const r = right_reversed + (width_ - 1 - u + least_);
      const Costs here = Costs{} + static_cast<std::uint16_t>(l);
      for (int d = 0; d < count_; d += lanes) {
        const Costs there = __builtin_convertvector(load<Slopes>(r + d), Costs);
        const Costs apart = here > there ? here - there : there - here, sum = load<Costs>(cost + d);
        store(sign > 0 ? sum + apart : sum - apart, cost + d);
      }
    }
  }
  /// Adds a column to a window or takes it away.
  template <int sign>
  void slide(int u, std::span<std::uint16_t> window, int& slopes) const {
    const std::uint16_t* const cost = &cost_[static_cast<std::size_t>(u) * static_cast<std::size_t>(count_)];
    std::uint16_t* const sum = window.data();
    for (int d = 0; d < count_; d += lanes) {
      const Costs column = load<Costs>(cost + d), old = load<Costs>(sum + d);
      store(sign > 0 ? old + column : old - column, sum + d);
    }
    slopes += sign * texture_[static_cast<std::size_t>(u)];
  }

 private:
  int width_, least_, count_;
  std::vector<std::uint16_t> cost_;  ///< at most 31 rows of 62
  std::vector<int> texture_;
};

/// Sixteenths of a pixel to add to a whole disparity.
int between(int before, int best, int after) {
  const int slope = std::max(before, after) - best;
  if (slope <= 0) return 0;
  const int twice = 16 * (before - after);  // over 2 slope
  return (twice + (twice >= 0 ? slope : -slope)) / (2 * slope);
}

struct Best {
  int index = -1;
  std::uint16_t cost = 0;
};

constexpr std::uint16_t none =
    std::numeric_limits<std::uint16_t>::max();  // a window of 31 x 31 costs at most 59,582

std::uint16_t least_of(std::span<const std::uint16_t> costs) {
  Costs least = Costs{} + none;
  std::size_t d = 0;
  for (; d + lanes <= costs.size(); d += lanes) {
    const Costs here = load<Costs>(costs.data() + d);
    least = here < least ? here : least;
  }
  std::uint16_t result = none;
  for (; d < costs.size(); ++d) result = std::min(result, costs[d]);
  for (int i = 0; i < lanes; ++i) result = std::min<std::uint16_t>(result, least[i]);
  return result;
}

/// The cheapest disparity of a window; none where it is not clear which. `window` is as before in the end.
Best best_of(std::span<std::uint16_t> window, double uniqueness) {
  const std::uint16_t least = least_of(window);
  const auto index = std::find(window.begin(), window.end(), least) - window.begin();
  // The others without its neighbours.
  const auto first = static_cast<std::size_t>(std::max<std::ptrdiff_t>(index - 1, 0)),
             last = std::min(static_cast<std::size_t>(index) + 2, window.size());
  std::array<std::uint16_t, 3> kept{};
  for (std::size_t d = first; d < last; ++d) kept[d - first] = std::exchange(window[d], none);
  const std::uint16_t second = least_of(window);
  for (std::size_t d = first; d < last; ++d) window[d] = kept[d - first];
  if (second != none && static_cast<double>(second) <= static_cast<double>(least) * (1 + uniqueness))
    return {};
  return {static_cast<int>(index), least};
}

}  // namespace

void match_rows(const MatchKeys& keys, std::span<const std::uint8_t> left,
                std::span<const std::uint8_t> right, int width, int height, int first, int last,
                std::span<float> disparity) {
  SL_CHECK(left.size() == right.size() &&
           left.size() >= static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  SL_CHECK(first >= 0 && first <= last && last <= height &&
           disparity.size() >= static_cast<std::size_t>(last - first) * static_cast<std::size_t>(width));
  std::fill(disparity.begin(), disparity.end(), no_disparity);
  const int half = keys.window / 2, count = keys.count;
  if (width <= 2 * half + keys.least || width < 3 || first == last) return;
  const int rows = 2 * half + 1, texture = keys.texture * rows * rows;
  Columns columns(width, keys.least, count);
  // Slopes of the rows of a window, by turns; the right ones reversed, with room behind for disparities beyond the border.
  const auto line = static_cast<std::size_t>(width),
             reversed = line + static_cast<std::size_t>(keys.least + padded(count));
  std::vector<std::uint8_t> lefts(line * static_cast<std::size_t>(rows)),
      rights(reversed * static_cast<std::size_t>(rows)), slope(line);
  const auto place = [&](int row) { return static_cast<std::size_t>(((row % rows) + rows) % rows); };
  const auto take = [&](int row) {
    std::uint8_t *const l = &lefts[place(row) * line], *const r = &rights[place(row) * reversed];
    slopes_of_row(left, width, height, row, l);
    slopes_of_row(right, width, height, row, slope.data());
    std::reverse_copy(slope.begin(), slope.end(), r);
    columns.add<1>(l, r);
  };
  const auto drop = [&](int row) {
    columns.add<-1>(&lefts[place(row) * line], &rights[place(row) * reversed]);
  };
  for (int row = first - half; row < first + half; ++row) take(row);

  std::vector<std::uint16_t> window(static_cast<std::size_t>(padded(count)));
  std::vector<Best> matched(line), by_right(line);
  std::vector<int> sixteenths(line);
  for (int row = first; row < last; ++row) {
    take(row + half);
    std::fill(matched.begin(), matched.end(), Best{});
    std::fill(by_right.begin(), by_right.end(), Best{});
    std::fill(window.begin(), window.end(), std::uint16_t{0});
    int slopes = 0;
    for (int u = 0; u < 2 * half; ++u) columns.slide<1>(u, window, slopes);
    for (int u = half; u + half < width; ++u) {
      columns.slide<1>(u + half, window, slopes);
      const int seen = std::min(count,
                                u - half - keys.least + 1);  // farther, the window leaves the right picture
      if (seen > 0 && slopes >= texture) {
        const Best best = best_of(std::span(window).first(static_cast<std::size_t>(seen)), keys.uniqueness);
        const auto at = static_cast<std::size_t>(u);
        if (best.index >= 0) {
          matched[at] = best;
          const auto w = [&](int d) { return static_cast<int>(window[static_cast<std::size_t>(d)]); };
          const bool inner = best.index > 0 && best.index + 1 < seen;
          sixteenths[at] = 16 * (best.index + keys.least) +
                           (inner ? between(w(best.index - 1), w(best.index), w(best.index + 1)) : 0);
          Best& of_right = by_right[static_cast<std::size_t>(u - best.index - keys.least)];
          if (of_right.index < 0 || best.cost < of_right.cost) of_right = best;
        }
      }
      columns.slide<-1>(u - half, window, slopes);
    }
    float* const out = disparity.data() + static_cast<std::ptrdiff_t>(row - first) * width;
    for (int u = half; u + half < width; ++u) {
      const auto at = static_cast<std::size_t>(u);
      if (matched[at].index < 0) continue;
      const Best& of_right = by_right[static_cast<std::size_t>(u - matched[at].index - keys.least)];
      if (std::abs(of_right.index - matched[at].index) <= 1)
        out[u] = static_cast<float>(sixteenths[at]) / 16.0F;
    }
    drop(row - half);
  }
}

}  // namespace sandlot::cameras
