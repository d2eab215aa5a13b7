#include "devices/ranges/laser_scanner/segments.h"

#include <algorithm>
#include <cmath>

#include "base/math.h"

namespace sandlot::laser_scanner {
namespace {

constexpr int halvings = 5;

double cross_z(Vec2 a, Vec2 b) { return a.x * b.y - a.y * b.x; }
double length(Vec2 a) { return std::sqrt(dot(a, a)); }

/// Distance at which a ray from S's origin meets the line through two points; negative: not ahead.
double along(Vec2 direction, Vec2 a, Vec2 b) {
  const double across = cross_z(direction, b - a);
  return std::abs(across) > 1e-12 ? cross_z(a, b - a) / across : -1;
}

}  // namespace

/// Fills the directions of `fresh_`.
void SegmentFinder::aim() {
  angles_rad_.resize(fresh_.size());
  for (std::size_t i = 0; i < fresh_.size(); ++i) angles_rad_[i] = fresh_[i].angle_rad;
  sin_cos_.resize(fresh_.size());
  math::sincos(angles_rad_, sin_cos_);
  for (std::size_t i = 0; i < fresh_.size(); ++i) fresh_[i].direction_S = {sin_cos_[i].cos, sin_cos_[i].sin};
}

/// Casts the rays of `fresh_`.
void SegmentFinder::cast(const RayCaster& rays, RayJob job, double min_m) {
  directions_.resize(fresh_.size());
  for (std::size_t i = 0; i < fresh_.size(); ++i)
    directions_[i] = {fresh_[i].direction_S.x, fresh_[i].direction_S.y, 0};
  distances_m_.resize(fresh_.size());
  bodies_.assign(fresh_.size(), no_body);
  job.directions = directions_;
  job.distance_m = distances_m_;
  job.body = bodies_;
  rays.cast({&job, 1});
  for (std::size_t i = 0; i < fresh_.size(); ++i) {
    const auto distance_m = static_cast<double>(distances_m_[i]);
    const bool seen = std::isfinite(distance_m) && distance_m >= min_m;
    fresh_[i].body = seen ? bodies_[i] : no_body;
    fresh_[i].point_S = (seen ? distance_m : 0) * fresh_[i].direction_S;
    fresh_[i].range_m = length(fresh_[i].point_S);
  }
}

/// For each pair of neighbours: whether the line through one of them and its own neighbour leads to the
/// other.
void SegmentFinder::link(double tolerance_m) {
  const auto leads = [&](std::size_t from, std::size_t over, std::size_t to) {
    const Echo &a = echoes_[from], &b = echoes_[over], &c = echoes_[to];
    if (a.body != b.body) return false;
    const double expected_m = along(c.direction_S, a.point_S, b.point_S);
    return expected_m >= 0 && std::abs(expected_m - c.range_m) <= tolerance_m;
  };
  for (std::size_t i = 0; i + 1 < echoes_.size(); ++i) {
    Echo& echo = echoes_[i];
    echo.linked = echo.body != no_body && echo.body == echoes_[i + 1].body &&
                  ((i > 0 && leads(i - 1, i, i + 1)) || (i + 2 < echoes_.size() && leads(i + 2, i + 1, i)));
  }
  if (!echoes_.empty()) echoes_.back().linked = false;
}

/// Makes segments of a chain of linked echoes, cutting it where it bends.
void SegmentFinder::cut(std::size_t begin, std::size_t end, const Fan& fan,
                        std::vector<msg::LineSegment>& out) {
  pieces_.clear();
  pieces_.emplace_back(begin, end);
  while (!pieces_.empty()) {
    const auto [first, last] = pieces_.back();
    pieces_.pop_back();
    const Vec2 a = echoes_[first].point_S, b = echoes_[last].point_S;
    const double length_m = length(b - a);
    std::size_t farthest = first;
    double most_m = fan.tolerance_m;
    for (std::size_t i = first + 1; i < last; ++i) {
      const Vec2 p = echoes_[i].point_S;
      const double off_m = length_m > 1e-9 ? std::abs(cross_z(b - a, p - a)) / length_m : length(p - a);
      if (off_m > most_m) most_m = off_m, farthest = i;
    }
    if (farthest != first) {
      pieces_.emplace_back(farthest, last);  // the right piece is taken first
      pieces_.emplace_back(first, farthest);
    } else if (length_m >= fan.min_length_m) {
      out.push_back({{a.x, a.y, 0}, {b.x, b.y, 0}});
    }
  }
}

void SegmentFinder::find(const Fan& fan, const RayCaster& rays, RayJob job,
                         std::vector<msg::LineSegment>& out) {
  out.clear();
  const double fov_rad = fan.last_rad - fan.first_rad;
  const auto gaps = static_cast<std::size_t>(std::max(1.0, std::ceil(fov_rad / fan.step_rad - 1e-9)));
  const double step_rad = fov_rad / static_cast<double>(gaps);
  if (fan.first_rad != fan_.first_rad || fan.last_rad != fan_.last_rad || fan.step_rad != fan_.step_rad ||
      first_.empty()) {
    fan_ = fan;
    fresh_.clear();
    for (std::size_t i = 0; i <= gaps; ++i)
      fresh_.push_back({.angle_rad = fan.first_rad + step_rad * static_cast<double>(i)});
    aim();
    first_ = fresh_;
  }
  fresh_ = first_;
  cast(rays, job, fan.min_m);
  std::swap(echoes_, fresh_);
  const std::size_t most = 5 * echoes_.size() + 32;
  double gap_rad = step_rad;
  for (int round = 0; round < halvings; ++round, gap_rad *= 0.5) {
    link(fan.tolerance_m);
    fresh_.clear();
    for (std::size_t i = 0; i + 1 < echoes_.size() && echoes_.size() + fresh_.size() < most; ++i) {
      const Echo &a = echoes_[i], &b = echoes_[i + 1];
      const bool nothing = a.body == no_body && b.body == no_body;
      // Only the gaps that the round before has left this wide.
      if (nothing || a.linked || b.angle_rad - a.angle_rad > 1.5 * gap_rad) continue;
      fresh_.push_back({.angle_rad = 0.5 * (a.angle_rad + b.angle_rad)});
    }
    if (fresh_.empty()) break;
    aim();
    cast(rays, job, fan.min_m);
    merged_.clear();
    std::merge(echoes_.begin(), echoes_.end(), fresh_.begin(), fresh_.end(), std::back_inserter(merged_),
               [](const Echo& a, const Echo& b) { return a.angle_rad < b.angle_rad; });
    std::swap(echoes_, merged_);
  }
  link(fan.tolerance_m);
  for (std::size_t begin = 0; begin < echoes_.size();) {
    std::size_t end = begin;
    while (echoes_[end].linked) ++end;
    if (end > begin) cut(begin, end, fan, out);
    begin = end + 1;
  }
}

}  // namespace sandlot::laser_scanner
