#include "navigation/visual_odometry/features.h"

#include <algorithm>
#include <cstdlib>

namespace sandlot::navigation::vo {
namespace {

// Loops over rows have an inner loop of this constant length: gcc 12 at -O2 vectorises no others.
constexpr int feature_lanes = 16;

/// Sums over rows: of three (middle ones), of five, and lower two less upper two.
void feature_columns(const std::uint8_t* __restrict r0, const std::uint8_t* __restrict r1,
                     const std::uint8_t* __restrict r2, const std::uint8_t* __restrict r3,
                     const std::uint8_t* __restrict r4, std::int16_t* __restrict sum3,
                     std::int16_t* __restrict sum5, std::int16_t* __restrict step, int length) {
  for (int at = 0; at < length; at += feature_lanes)
    for (int i = 0; i < feature_lanes; ++i) {
      const int u = at + i, inner = r1[u] + r2[u] + r3[u];
      sum3[u] = static_cast<std::int16_t>(inner);
      sum5[u] = static_cast<std::int16_t>(inner + r0[u] + r4[u]);
      step[u] = static_cast<std::int16_t>(r3[u] + r4[u] - r0[u] - r1[u]);
    }
}

/// blob = -(5 x 5) + 2 (3 x 3) + 7 (centre); corner: the product of two steps, negative.
void feature_rows(const std::int16_t* __restrict sum3, const std::int16_t* __restrict sum5,
                  const std::int16_t* __restrict step, const std::uint8_t* __restrict middle,
                  std::int16_t* __restrict blob, std::int16_t* __restrict corner, int length) {
  for (int at = 0; at < length; at += feature_lanes)
    for (int i = 0; i < feature_lanes; ++i) {
      const int u = at + i;
      blob[u] = static_cast<std::int16_t>(2 * (sum3[u - 1] + sum3[u] + sum3[u + 1]) + 7 * middle[u] -
                                          (sum5[u - 2] + sum5[u - 1] + sum5[u] + sum5[u + 1] + sum5[u + 2]));
      corner[u] = static_cast<std::int16_t>(step[u - 2] + step[u - 1] - step[u + 1] - step[u + 2]);
    }
}

void feature_bounds(const std::int16_t* __restrict high, const std::int16_t* __restrict low,
                    std::int16_t* __restrict greatest, std::int16_t* __restrict least, int length) {
  for (int at = 0; at < length; at += feature_lanes)
    for (int i = 0; i < feature_lanes; ++i) {
      const int u = at + i;
      greatest[u] = std::max(greatest[u], high[u]);
      least[u] = std::min(least[u], low[u]);
    }
}

/// Marks responses that are the greatest or least in their surroundings and large enough.
void feature_marks(const std::int16_t* __restrict row, const std::int16_t* __restrict greatest,
                   const std::int16_t* __restrict least, std::int16_t threshold,
                   std::int16_t* __restrict mark, int length) {
  for (int at = 0; at < length; at += feature_lanes)
    for (int i = 0; i < feature_lanes; ++i) {
      const int u = at + i;
      const bool high = (row[u] == greatest[u]) & (row[u] >= threshold),
                 low = (row[u] == least[u]) & (row[u] <= -threshold);
      mark[u] = static_cast<std::int16_t>(high | low);
    }
}

/// Whether no equal response within n pixels precedes, in the order of rows.
bool feature_first(const std::int16_t* at, int stride, int n) {
  for (int y = -n; y < 0; ++y)
    for (int x = -n; x <= n; ++x)
      if (at[y * stride + x] == *at) return false;
  for (int x = -n; x < 0; ++x)
    if (at[x] == *at) return false;
  return true;
}

struct FeatureGrid {
  int bucket_px, columns, rows, width, height, stride, margin;
};

/// Place, class, square and response as a number that sorts by (class, square, response, place).
std::uint64_t feature_key(const FeatureGrid& grid, int kind, int u, int v, int response) {
  const int square = v / grid.bucket_px * grid.columns + u / grid.bucket_px;
  std::uint64_t key = static_cast<std::uint64_t>(kind);
  key = key << 24 | static_cast<std::uint64_t>(square);
  key = key << 12 | static_cast<std::uint64_t>(4095 - std::abs(response));
  key = key << 13 | static_cast<std::uint64_t>(v);
  return key << 13 | static_cast<std::uint64_t>(u);
}

/// Adds the extremes of a filter: what equals the bounds of its surroundings, found row by row.
void feature_extremes(const FeatureGrid& grid, const std::int16_t* response, int n, int threshold, int kind,
                      std::vector<std::uint64_t>& keys) {
  constexpr int edge = feature_lanes;  // at least n
  const auto length = static_cast<std::size_t>(grid.stride);
  // Bounds over the rows, with edges; those over rows and columns; marks.
  std::vector<std::int16_t> lines(2 * (length + 2 * edge) + 3 * length);
  std::int16_t *high = lines.data() + edge, *low = high + length + 2 * edge, *greatest = low + length + edge,
               *least = greatest + length, *mark = least + length;
  for (int v = grid.margin; v < grid.height - grid.margin; ++v) {
    const std::int16_t *row = response + v * grid.stride, *first = row - n * grid.stride;
    std::copy_n(first, grid.stride, high);
    std::copy_n(first, grid.stride, low);
    for (int y = 1; y <= 2 * n; ++y)
      feature_bounds(first + y * grid.stride, first + y * grid.stride, high, low, grid.stride);
    std::copy_n(high, grid.stride, greatest);
    std::copy_n(low, grid.stride, least);
    for (int x = 1; x <= n; ++x) {
      feature_bounds(high - x, low - x, greatest, least, grid.stride);
      feature_bounds(high + x, low + x, greatest, least, grid.stride);
    }
    feature_marks(row, greatest, least, static_cast<std::int16_t>(threshold), mark, grid.stride);
    for (int at = 0; at < grid.stride; at += feature_lanes) {
      std::int16_t any = 0;
      for (int i = 0; i < feature_lanes; ++i) any = static_cast<std::int16_t>(any | mark[at + i]);
      if (!any) continue;
      for (int u = std::max(at, grid.margin); u < std::min(at + feature_lanes, grid.width - grid.margin); ++u)
        if (mark[u] && feature_first(row + u, grid.stride, n))
          keys.push_back(feature_key(grid, row[u] > 0 ? kind : kind + 1, u, v, row[u]));
    }
  }
}

/// Where the gradient is sampled: three rings.
constexpr std::array<std::array<int, 2>, 16> feature_samples{{{-1, -1},
                                                              {1, -1},
                                                              {-1, 1},
                                                              {1, 1},
                                                              {-3, -1},
                                                              {3, -1},
                                                              {-3, 1},
                                                              {3, 1},
                                                              {-1, -3},
                                                              {1, -3},
                                                              {-1, 3},
                                                              {1, 3},
                                                              {-5, 0},
                                                              {5, 0},
                                                              {0, -5},
                                                              {0, 5}}};

std::array<std::uint8_t, 32> feature_descriptor(const PaddedImage& image, int u, int v) {
  std::array<std::uint8_t, 32> out{};
  const auto part = [](int gradient) {
    return static_cast<std::uint8_t>(128 + std::clamp(gradient / 4, -127, 127));
  };
  for (std::size_t i = 0; i < feature_samples.size(); ++i) {
    const auto [du, dv] = feature_samples[i];
    const std::uint8_t *upper = image.row(v + dv - 1) + u + du, *middle = image.row(v + dv) + u + du,
                       *lower = image.row(v + dv + 1) + u + du;
    out[2 * i] = part(upper[1] - upper[-1] + 2 * (middle[1] - middle[-1]) + lower[1] - lower[-1]);
    out[2 * i + 1] = part(lower[-1] - upper[-1] + 2 * (lower[0] - upper[0]) + lower[1] - upper[1]);
  }
  return out;
}

}  // namespace

Responses responses(const PaddedImage& image) {
  Responses out;
  out.blob.resize(image.pixels.size());
  out.corner.resize(image.pixels.size());
  const auto length = static_cast<std::size_t>(image.stride);
  constexpr std::size_t edge = feature_lanes;
  std::vector<std::int16_t> lines(3 * (length + 2 * edge));
  std::int16_t *sum3 = lines.data() + edge, *sum5 = sum3 + length + 2 * edge,
               *step = sum5 + length + 2 * edge;
  for (int v = 2; v < image.height - 2; ++v) {
    feature_columns(image.row(v - 2), image.row(v - 1), image.row(v), image.row(v + 1), image.row(v + 2),
                    sum3, sum5, step, image.stride);
    std::int16_t* blob = out.blob.data() + static_cast<std::size_t>(v) * length;
    std::int16_t* corner = out.corner.data() + static_cast<std::size_t>(v) * length;
    feature_rows(sum3, sum5, step, image.row(v), blob, corner, image.stride);
    for (std::int16_t* row : {blob, corner}) {
      row[0] = row[1] = 0;
      std::fill(row + image.width - 2, row + image.stride, std::int16_t{0});
    }
  }
  return out;
}

FeatureSet find_features(const PaddedImage& whole, const FeatureSpec& spec) {
  const PaddedImage half = spec.half_resolution ? halved(whole) : PaddedImage{};
  const PaddedImage& image = spec.half_resolution ? half : whole;
  FeatureSet out;
  out.scale = spec.half_resolution ? 2 : 1;
  out.bucket_px = spec.bucket_px;
  out.columns = (image.width + spec.bucket_px - 1) / spec.bucket_px;
  out.rows = (image.height + spec.bucket_px - 1) / spec.bucket_px;
  const int squares = out.columns * out.rows;
  const FeatureGrid grid{out.bucket_px,
                         out.columns,
                         out.rows,
                         image.width,
                         image.height,
                         image.stride,
                         std::max(feature_margin_px, spec.nms_radius + 2)};

  const Responses found = responses(image);
  std::vector<std::uint64_t> keys;
  feature_extremes(grid, found.blob.data(), spec.nms_radius, spec.threshold, 0, keys);
  feature_extremes(grid, found.corner.data(), spec.nms_radius, spec.threshold, 2, keys);
  std::sort(keys.begin(), keys.end());

  out.first.reserve(static_cast<std::size_t>(feature_classes * squares) + 1);
  std::size_t at = 0;
  for (int kind = 0; kind < feature_classes; ++kind) {
    const std::int16_t* response = kind < 2 ? found.blob.data() : found.corner.data();
    for (int square = 0; square < squares; ++square) {
      out.first.push_back(static_cast<std::uint32_t>(out.features.size()));
      const std::uint64_t mine = static_cast<std::uint64_t>(kind) << 24 | static_cast<std::uint64_t>(square);
      for (int count = 0; at < keys.size() && keys[at] >> 38 == mine; ++at, ++count) {
        if (count >= spec.bucket_features) continue;
        const int u = static_cast<int>(keys[at] & 8191), v = static_cast<int>(keys[at] >> 13 & 8191);
        out.features.push_back({static_cast<std::int16_t>(u), static_cast<std::int16_t>(v),
                                response[v * image.stride + u], feature_descriptor(image, u, v)});
      }
    }
  }
  out.first.push_back(static_cast<std::uint32_t>(out.features.size()));
  return out;
}

bool sound(const FeatureSet& set, const PaddedImage& image) {
  if ((set.scale != 1 && set.scale != 2) || set.bucket_px < 1 || set.columns < 1 || set.rows < 1 ||
      set.columns > greatest_side_px || set.rows > greatest_side_px)
    return false;
  const std::size_t squares = static_cast<std::size_t>(set.columns) * static_cast<std::size_t>(set.rows);
  if (set.first.size() != feature_classes * squares + 1 || set.first.front() != 0 ||
      set.first.back() != set.features.size() || !std::is_sorted(set.first.begin(), set.first.end()))
    return false;
  return std::all_of(set.features.begin(), set.features.end(), [&](const Feature& f) {
    return f.u >= 0 && f.v >= 0 && f.u * set.scale < image.width && f.v * set.scale < image.height;
  });
}

}  // namespace sandlot::navigation::vo
