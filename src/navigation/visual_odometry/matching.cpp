#include "navigation/visual_odometry/matching.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sandlot::navigation::vo {
namespace {

struct MatchBox {
  int u0, u1, v0, v1;  ///< inclusive
};

std::size_t match_squares(const FeatureSet& set) {
  return static_cast<std::size_t>(set.columns) * static_cast<std::size_t>(set.rows);
}

/// Feature of a class with the nearest descriptor in a box; null when there is none.
const Feature* match_nearest(const FeatureSet& set, std::size_t kind, const Feature& feature,
                             const MatchBox& box) {
  const int column0 = std::max(box.u0, 0) / set.bucket_px,
            column1 = std::min(std::max(box.u1, -1) / set.bucket_px, set.columns - 1),
            row0 = std::max(box.v0, 0) / set.bucket_px,
            row1 = std::min(std::max(box.v1, -1) / set.bucket_px, set.rows - 1);
  const Feature* best = nullptr;
  int least = std::numeric_limits<int>::max();
  for (int row = row0; row <= row1; ++row) {
    // The squares of a row follow one another.
    const std::size_t square = kind * match_squares(set) +
                               static_cast<std::size_t>(row) * static_cast<std::size_t>(set.columns);
    if (column0 > column1) break;
    const std::size_t end = set.first[square + static_cast<std::size_t>(column1) + 1];
    for (std::size_t i = set.first[square + static_cast<std::size_t>(column0)]; i < end; ++i) {
      const Feature& other = set.features[i];
      if (other.u < box.u0 || other.u > box.u1 || other.v < box.v0 || other.v > box.v1) continue;
      const int difference = distance(feature, other);
      if (difference >= least) continue;
      least = difference;
      best = &other;
    }
  }
  return best;
}

MatchBox match_box(const Feature& feature, int left, int right, int rows) {
  return {feature.u - left, feature.u + right, feature.v - rows, feature.v + rows};
}

/// Match before refinement: features, in pixels of the whole image.
struct MatchFound {
  Vec2 left0, right0, left1, right1;
  int strength = 0;
  int square = 0;  ///< of left0, bucket_px wide
  Vec2 flow() const { return left1 - left0; }
};

/// Removes what fewer than two of at least four neighbours agree with.
std::vector<MatchFound> match_supported(const std::vector<MatchFound>& found, int columns, int rows,
                                        double tolerance_px) {
  // Matches come ordered by square: the first of each.
  std::vector<std::size_t> first(static_cast<std::size_t>(columns * rows) + 1, found.size());
  for (std::size_t i = found.size(); i-- > 0;) first[static_cast<std::size_t>(found[i].square)] = i;
  for (std::size_t i = first.size() - 1; i-- > 0;) first[i] = std::min(first[i], first[i + 1]);
  const auto near = [&](double a, double b, double size) {
    return std::abs(a - b) <= tolerance_px + 0.2 * size;
  };
  std::vector<MatchFound> out;
  for (const MatchFound& match : found) {
    const int row = match.square / columns, column = match.square % columns;
    const double flow = std::abs(match.flow().x) + std::abs(match.flow().y);
    const double disparity0 = match.left0.x - match.right0.x, disparity1 = match.left1.x - match.right1.x;
    int neighbours = -1, agree = -1;  // less itself
    for (int y = std::max(row - 1, 0); y <= std::min(row + 1, rows - 1); ++y) {
      const int x0 = std::max(column - 1, 0), x1 = std::min(column + 1, columns - 1);
      for (std::size_t i = first[static_cast<std::size_t>(y * columns + x0)];
           i < first[static_cast<std::size_t>(y * columns + x1) + 1]; ++i) {
        const MatchFound& other = found[i];
        ++neighbours;
        if (near(other.flow().x, match.flow().x, flow) && near(other.flow().y, match.flow().y, flow) &&
            near(other.left0.x - other.right0.x, disparity0, disparity0) &&
            near(other.left1.x - other.right1.x, disparity1, disparity1))
          ++agree;
      }
    }
    if (neighbours < 4 || agree >= 2) out.push_back(match);
  }
  return out;
}

/// Common part of both ways of matching: outliers, buckets, refined places.
/// @param refine  whether a match has refined places; it then stores them
template <class Refine>
void match_select(std::vector<MatchFound>& found, const PaddedImage& image, const MatchSpec& spec,
                  Refine&& refine) {
  const int columns = image.width / spec.bucket_px + 1, rows = image.height / spec.bucket_px + 1;
  for (MatchFound& match : found)
    match.square = static_cast<int>(match.left0.y) / spec.bucket_px * columns +
                   static_cast<int>(match.left0.x) / spec.bucket_px;
  // Stable: of equally strong ones in a square the order of the features decides.
  std::stable_sort(found.begin(), found.end(), [](const MatchFound& a, const MatchFound& b) {
    return a.square != b.square ? a.square < b.square : a.strength > b.strength;
  });
  int count = 0, square = -1;
  for (const MatchFound& match : match_supported(found, columns, rows, spec.outlier_px)) {
    if (match.square != square) count = 0;
    square = match.square;
    if (count < spec.bucket_matches && refine(match)) ++count;
  }
}

Vec2 match_place(const Feature& feature, int scale) {
  return {static_cast<double>(feature.u * scale), static_cast<double>(feature.v * scale)};
}

/// Distance from a feature within which its place is refined.
double match_reach(int scale) { return scale == 1 ? 2 : 3; }

}  // namespace

View view_of(const GreyImage& image, const FeatureSpec& spec) {
  const PaddedImage whole = padded(image);
  return {smoothed(whole), find_features(whole, spec)};
}

bool sound(const View& view) { return sound(view.image) && sound(view.features, view.image); }

std::vector<StereoMatch> match_circle(const StereoView& from, const StereoView& to, const MatchSpec& spec) {
  const FeatureSet& set = from.left.features;
  const int scale = set.scale, radius = std::max(spec.radius_px / scale, 1),
            disparity = std::max(spec.max_disparity_px / scale, 1),
            rows = (spec.epipolar_px + scale - 1) / scale;
  std::vector<MatchFound> found;
  for (std::size_t kind = 0; kind < feature_classes; ++kind)
    for (std::size_t i = set.first[kind * match_squares(set)]; i < set.first[(kind + 1) * match_squares(set)];
         ++i) {
      const Feature& left0 = set.features[i];
      const Feature* right0 = match_nearest(from.right.features, kind, left0,
                                            match_box(left0, disparity, 1, rows));
      if (!right0) continue;
      const Feature* right1 = match_nearest(to.right.features, kind, *right0,
                                            match_box(*right0, radius, radius, radius));
      if (!right1) continue;
      const Feature* left1 = match_nearest(to.left.features, kind, *right1,
                                           match_box(*right1, 1, disparity, rows));
      if (!left1) continue;
      if (match_nearest(set, kind, *left1, match_box(*left1, radius, radius, radius)) != &left0) continue;
      found.push_back({match_place(left0, scale), match_place(*right0, scale), match_place(*left1, scale),
                       match_place(*right1, scale), std::abs(left0.response)});
    }

  std::vector<StereoMatch> out;
  const double reach = match_reach(scale), rows_apart = spec.epipolar_px + 0.5;
  match_select(found, from.left.image, spec, [&](const MatchFound& match) {
    const auto patch = Patch::of(from.left.image, static_cast<int>(match.left0.x),
                                 static_cast<int>(match.left0.y));
    if (!patch) return false;
    const auto right0 = patch->find(from.right.image, match.right0, reach),
               left1 = patch->find(to.left.image, match.left1, reach),
               right1 = patch->find(to.right.image, match.right1, reach);
    if (!right0 || !left1 || !right1 || std::abs(right0->y - match.left0.y) > rows_apart ||
        std::abs(right1->y - left1->y) > rows_apart)
      return false;
    out.push_back({match.left0, *right0, *left1, *right1});
    return true;
  });
  return out;
}

std::vector<FlowMatch> match_flow(const View& from, const View& to, const MatchSpec& spec) {
  const FeatureSet& set = from.features;
  const int scale = set.scale, radius = std::max(spec.radius_px / scale, 1);
  std::vector<MatchFound> found;
  for (std::size_t kind = 0; kind < feature_classes; ++kind)
    for (std::size_t i = set.first[kind * match_squares(set)]; i < set.first[(kind + 1) * match_squares(set)];
         ++i) {
      const Feature& p0 = set.features[i];
      const Feature* p1 = match_nearest(to.features, kind, p0, match_box(p0, radius, radius, radius));
      if (!p1 || match_nearest(set, kind, *p1, match_box(*p1, radius, radius, radius)) != &p0) continue;
      const Vec2 a = match_place(p0, scale), b = match_place(*p1, scale);
      found.push_back({a, a, b, b, std::abs(p0.response)});
    }

  std::vector<FlowMatch> out;
  match_select(found, from.image, spec, [&](const MatchFound& match) {
    const auto patch = Patch::of(from.image, static_cast<int>(match.left0.x),
                                 static_cast<int>(match.left0.y));
    const auto p1 = patch ? patch->find(to.image, match.left1, match_reach(scale)) : std::nullopt;
    if (p1) out.push_back({match.left0, *p1});
    return p1.has_value();
  });
  return out;
}

}  // namespace sandlot::navigation::vo
