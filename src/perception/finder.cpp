#include "perception/finder.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/math.h"

namespace sandlot::perception {
namespace {

constexpr float nan = std::numeric_limits<float>::quiet_NaN();
/// Rays flatter than that (sine) meet the ground anywhere.
constexpr double flat = 0.026;
constexpr std::uint32_t no_run = ~0u;
constexpr int sectors = 48;

Vec3 wide(const std::array<float, 3>& v) { return {v[0], v[1], v[2]}; }
std::array<float, 3> narrow(Vec3 v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

/// A line of pixels, at most two wide: where two surfaces meet, a pixel of both has a colour between theirs,
/// and that between a yellow goal and a magenta robot is the ball's.
bool is_edge(const Blob& patch) {
  const int longest = std::max(patch.right - patch.left, patch.bottom - patch.top) + 1;
  const double thickness = static_cast<double>(patch.pixels) / longest;
  return thickness < 2 && longest > 4 * thickness;
}

/// Two things do not stand in one place: patches of one target nearer to each other than most of its width
/// are pieces of one thing that a net or a post parts. The largest takes the others in.
void join_pieces(const FinderSpec& spec, std::vector<Found>& found) {
  std::stable_sort(found.begin(), found.end(),
                   [](const Found& a, const Found& b) { return a.patch.pixels > b.patch.pixels; });
  std::size_t kept = 0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    const Found& piece = found[i];
    const double within = 0.8 * spec.targets[piece.target].size_m;
    std::size_t whole = 0;
    while (whole < kept && !(found[whole].target == piece.target &&
                             norm(found[whole].position_B - piece.position_B) < within))
      ++whole;
    if (whole == kept) {
      if (kept != i) found[kept] = piece;
      ++kept;
      continue;
    }
    Found& all = found[whole];
    const double part = static_cast<double>(piece.patch.pixels) / (all.patch.pixels + piece.patch.pixels);
    all.position_B += part * (piece.position_B - all.position_B);
    all.bearing_rad = math::atan2(all.position_B.y, all.position_B.x);
    all.range_m = math::hypot(all.position_B.x, all.position_B.y);
    all.visible = std::min(1.0, all.visible + piece.visible);
    all.confidence = std::min(1.0, all.confidence + piece.confidence);
    all.patch.u += part * (piece.patch.u - all.patch.u);
    all.patch.v += part * (piece.patch.v - all.patch.v);
    all.patch.pixels += piece.patch.pixels;
    all.patch.left = std::min(all.patch.left, piece.patch.left);
    all.patch.right = std::max(all.patch.right, piece.patch.right);
    all.patch.top = std::min(all.patch.top, piece.patch.top);
    all.patch.bottom = std::max(all.patch.bottom, piece.patch.bottom);
  }
  found.resize(kept);
}

}  // namespace

Finder::Finder(FinderSpec spec, const CameraModel& camera, const Pose& X_BS)
    : spec_(std::move(spec)), width_(camera.width()), height_(camera.height()), eye_B_(X_BS.p) {
  std::vector<ColourRange> ranges;
  for (const Target& target : spec_.targets) ranges.push_back(target.colour);
  colours_ = ColourTable(ranges);

  const auto pixels = static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
  directions_B_.assign(pixels, {nan, nan, nan});
  bool moved = false;
  std::vector<Vec3> origins(pixels, eye_B_);
  for (std::size_t i = 0; i < pixels; ++i) {
    const auto column = static_cast<double>(i % static_cast<std::size_t>(width_)),
               row = static_cast<double>(i / static_cast<std::size_t>(width_));
    const std::optional<SightRay> ray = camera.ray(column, row);
    if (!ray) continue;
    directions_B_[i] = narrow(rotate(X_BS.q, ray->direction));
    origins[i] = X_BS * ray->origin;
    moved = moved || ray->origin != Vec3{};
  }
  if (moved)
    for (const Vec3 origin : origins) origins_B_.push_back(narrow(origin));

  // The solid angle of a pixel: what its neighbours' directions span.
  solid_angle_.assign(pixels, 0);
  const auto between = [&](int column, int row, int du, int dv) {
    const auto at = [&](int k) -> const std::array<float, 3>* {
      const int u = column + k * du, v = row + k * dv;
      if (u < 0 || v < 0 || u >= width_ || v >= height_) return nullptr;
      const auto& d = directions_B_[static_cast<std::size_t>(v) * static_cast<std::size_t>(width_) +
                                    static_cast<std::size_t>(u)];
      return std::isnan(d[0]) ? nullptr : &d;
    };
    const auto *low = at(-1), *middle = at(0), *high = at(1);
    const int steps = (low ? 1 : 0) + (high ? 1 : 0);
    if (middle == nullptr || steps == 0) return Vec3{};
    return (wide(high ? *high : *middle) - wide(low ? *low : *middle)) / steps;
  };
  for (int row = 0; row < height_; ++row)
    for (int column = 0; column < width_; ++column)
      solid_angle_[static_cast<std::size_t>(row) * static_cast<std::size_t>(width_) +
                   static_cast<std::size_t>(column)] =
          static_cast<float>(norm(cross(between(column, row, 1, 0), between(column, row, 0, 1))));
}

Vec3 Finder::foot_on(std::size_t pixel, double height_B) const {
  const Vec3 ray = wide(directions_B_[pixel]), origin = origins_B_.empty() ? eye_B_ : wide(origins_B_[pixel]);
  // The edge is where the pixel ends, half of its height below its middle.
  const Vec3 upwards = normalised(Vec3{0, 0, 1} - ray.z * ray, {0, 0, 0});
  const Vec3 direction = ray - (0.5 * std::sqrt(static_cast<double>(solid_angle_[pixel]))) * upwards;
  return origin + ((height_B - origin.z) / direction.z) * direction;
}

bool Finder::ball(const Target& target, const Sum& sum, const Blob& patch, Found& out) const {
  if (is_edge(patch)) return false;
  const double radius = 0.5 * target.size_m;
  const Vec3 direction = normalised(sum.direction);
  // A cone of half angle rho has the solid angle 2 pi (1 - cos rho), and the ball fills it: sin rho = radius
  // / distance.
  const double cos_rho = std::max(-1.0, 1 - sum.solid_angle / (2 * math::pi));
  const double by_size = radius / std::max(1e-6, std::sqrt(std::max(0.0, 1 - cos_rho * cos_rho)));
  double distance = by_size;
  const double drop = eye_B_.z - (radius - spec_.base_height_m);
  if (drop > 0 && direction.z < -flat) distance = drop / -direction.z;
  if (!(distance > radius)) return false;
  const double sin_rho = radius / distance;
  const double expected = 2 * math::pi * (1 - std::sqrt(1 - sin_rho * sin_rho));
  const double seen = sum.solid_angle / expected;
  // Pixels of the edge count wholly or not at all: about two of the square roots of their number.
  const double slack = 1 + 4 / std::sqrt(static_cast<double>(patch.pixels));
  if (seen < spec_.min_visible / slack || seen > 1.6 * slack) return false;
  out.position_B = eye_B_ + distance * direction;
  out.visible = std::min(1.0, seen);
  return true;
}

bool Finder::standing(const Target& target, std::uint32_t blob, const Sum& sum, Found& out) {
  if (!(sum.lowest < -1e-3)) return false;
  const Vec3 middle = normalised(sum.direction);
  const double plane = target.foot_m - spec_.base_height_m;
  // Directions are given by the tangent of the angle to the middle, in the ground plane; +-63 degrees are
  // enough.
  const Vec3 ahead = normalised(Vec3{middle.x, middle.y, 0}), left{-ahead.y, ahead.x, 0};
  double widest = 0;
  const auto each_pixel = [&](auto&& f) {
    for (std::uint32_t i = first_run_[blob]; i != no_run; i = next_run_[i]) {
      const Run& run = blobs_.runs()[i];
      for (std::size_t u = run.begin; u < run.end; ++u) {
        const std::size_t pixel = std::size_t{run.row} * static_cast<std::size_t>(width_) + u;
        const auto& d = directions_B_[pixel];
        if (std::isnan(d[0])) continue;
        const Vec3 direction = wide(d);
        const double forward = dot(direction, ahead);
        if (!(forward > 0)) continue;
        const double side = dot(direction, left) / forward, climb = direction.z / forward;
        if (std::abs(side) < 2) f(pixel, side, climb);
      }
    }
  };
  each_pixel([&](std::size_t, double side, double) { widest = std::max(widest, std::abs(side)); });
  struct Lowest {
    double climb = 1e9;
    std::size_t pixel = 0;
  };
  std::array<Lowest, sectors> lowest;
  each_pixel([&](std::size_t pixel, double side, double climb) {
    const double place = widest > 0 ? (side / widest + 1) * 0.5 * (sectors - 1) : 0;
    Lowest& low = lowest[static_cast<std::size_t>(std::clamp(place, 0.0, sectors - 1.0))];
    if (climb < low.climb) low = {climb, pixel};
  });
  double nearest = 1e9;
  std::array<Vec3, sectors> point;
  std::array<double, sectors> range;
  for (std::size_t i = 0; i < sectors; ++i) {
    range[i] = 1e9;
    if (lowest[i].climb > -1e-3) continue;
    point[i] = foot_on(lowest[i].pixel, plane);
    if (!is_finite(point[i]) || dot(point[i] - eye_B_, ahead) <= 0) continue;
    range[i] = math::hypot(point[i].x - eye_B_.x, point[i].y - eye_B_.y);
    nearest = std::min(nearest, range[i]);
  }
  if (!(nearest < 1e8)) return false;
  if (2 * widest * nearest < spec_.min_visible * target.size_m)
    return false;  // a highlight on something else
  // The points near the nearest one are the front of a body, whether round or wide.
  Vec3 front;
  int points = 0;
  const double within = 1.15 * nearest + 0.25 * target.depth_m;
  for (std::size_t i = 0; i < sectors; ++i)
    if (range[i] <= within) front += point[i], ++points;
  front = front / points;
  out.position_B = front + target.depth_m * normalised(Vec3{front.x - eye_B_.x, front.y - eye_B_.y, 0});
  return true;
}

Status Finder::find(const ImageView& picture, std::vector<Found>& out) {
  out.clear();
  if (picture.width != width_ || picture.height != height_)
    return Error{"a picture of " + std::to_string(picture.width) + " x " + std::to_string(picture.height) +
                 " pixels from a camera of " + std::to_string(width_) + " x " + std::to_string(height_)};
  blobs_.find(picture, colours_, spec_.gap, spec_.min_pixels);
  const auto blobs = blobs_.blobs();
  const auto runs = blobs_.runs();
  sums_.assign(blobs.size(), {});
  first_run_.assign(blobs.size(), no_run);
  next_run_.assign(runs.size(), no_run);
  for (std::size_t k = runs.size(); k-- > 0;) {
    const Run& run = runs[k];
    if (run.blob == no_blob) continue;
    next_run_[k] = first_run_[run.blob];
    first_run_[run.blob] = static_cast<std::uint32_t>(k);
    Sum& sum = sums_[run.blob];
    for (std::size_t u = run.begin; u < run.end; ++u) {
      const std::size_t pixel = std::size_t{run.row} * static_cast<std::size_t>(width_) + u;
      const auto& d = directions_B_[pixel];
      if (std::isnan(d[0])) continue;
      sum.solid_angle += solid_angle_[pixel];
      sum.direction += static_cast<double>(solid_angle_[pixel]) * wide(d);
      sum.lowest = std::min(sum.lowest, static_cast<double>(d[2]));
    }
  }
  for (std::uint32_t i = 0; i < blobs.size(); ++i) {
    const Sum& sum = sums_[i];
    if (!(sum.solid_angle > 0) || !(norm(sum.direction) > 0)) continue;
    Found found;
    found.target = blobs[i].colour;
    found.patch = blobs[i];
    const Target& target = spec_.targets[found.target];
    if (!(target.form == Form::ball ? ball(target, sum, blobs[i], found) : standing(target, i, sum, found)))
      continue;
    found.bearing_rad = math::atan2(found.position_B.y, found.position_B.x);
    found.range_m = math::hypot(found.position_B.x, found.position_B.y);
    if (!(found.range_m <= spec_.max_range_m)) continue;
    const double pixels = blobs[i].pixels;
    found.confidence = found.visible * pixels / (pixels + spec_.min_pixels);
    out.push_back(found);
  }
  join_pieces(spec_, out);
  std::stable_sort(out.begin(), out.end(),
                   [](const Found& a, const Found& b) { return a.range_m < b.range_m; });
  return {};
}

}  // namespace sandlot::perception
