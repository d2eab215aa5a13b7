#include "devices/cameras/detector.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/math.h"

namespace sandlot::cameras {
namespace {

constexpr int across = 3;  // places per side
constexpr std::size_t places = across * across;
constexpr double spread =
    0.65;  // of the half extent: the corners of this grid lie within a sphere, 0.65 sqrt(2) = 0.92

Vec3 middle_of(const LabelledObject& target, const Context& context) {
  return context.engine.states()[target.bodies.front()].X_WB * target.bounds_B.centre();
}

bool in_picture(const optics::Lens& lens, Vec3 point_S) {
  const auto at = project(lens, point_S);
  return at && (*at)[0] >= -0.5 && (*at)[0] <= lens.width - 0.5 && (*at)[1] >= -0.5 &&
         (*at)[1] <= lens.height - 0.5;
}

/// Half the length of a box along a unit vector of its frame.
double half_extent(Vec3 size, Vec3 axis) {
  return 0.5 * (std::abs(axis.x) * size.x + std::abs(axis.y) * size.y + std::abs(axis.z) * size.z);
}

bool wanted(const ObjectKeys& keys, const std::string& label) {
  return keys.labels.empty() || std::find(keys.labels.begin(), keys.labels.end(), label) != keys.labels.end();
}

msg::ColorRGBA color_of(const LabelledObject& target) {
  return {target.color.r, target.color.g, target.color.b, target.color.a};
}

/// The labels a detector may mix up, in an order that is the same in every run.
void known_labels(const ObjectKeys& keys, const Context& context, std::vector<std::string_view>& out) {
  out.clear();
  for (const std::string& label : keys.labels) out.push_back(label);
  if (out.empty())
    for (const LabelledObject& target : context.labelled_objects) out.push_back(target.label);
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
}

/// One that is not `label`, if there is another.
std::string_view another(const std::vector<std::string_view>& labels, std::string_view label,
                         Stream& random) {
  const auto own = std::lower_bound(labels.begin(), labels.end(), label);
  const bool listed = own != labels.end() && *own == label;
  const std::size_t others = labels.size() - (listed ? 1 : 0);
  if (others == 0) return label;
  std::size_t pick = random.below(static_cast<std::uint32_t>(others));
  if (listed && pick >= static_cast<std::size_t>(own - labels.begin())) ++pick;
  return labels[pick];
}

/// Messages keep their elements' strings from sample to sample, so that filling them costs no heap.
template <class T>
class Filling {
 public:
  explicit Filling(std::vector<T>* list) : list_(list) {}
  explicit operator bool() const { return list_ != nullptr; }
  T& next() {
    if (used_ == list_->size()) list_->emplace_back();
    return (*list_)[used_++];
  }
  void done() {
    if (list_) list_->resize(used_);
  }

 private:
  std::vector<T>* list_;
  std::size_t used_ = 0;
};

Vec3 direction_of(double bearing, double elevation) {
  const auto b = math::sincos(bearing), e = math::sincos(elevation);
  return {e.cos * b.cos, e.cos * b.sin, e.sin};
}

struct Measured {
  double bearing, elevation, range;
};

Measured measure(Vec3 point_S) {
  const double range = norm(point_S);
  return {math::atan2(point_S.y, point_S.x),
          math::atan2(point_S.z, std::sqrt(point_S.x * point_S.x + point_S.y * point_S.y)), range};
}

void put(msg::Object& out, const Measured& m) {
  out.bearing = m.bearing;
  out.elevation = m.elevation;
  out.range = m.range;
  out.position = direction_of(m.bearing, m.elevation) * m.range;
}

/// Number of events in a sample for a mean of `mean` (Poisson).
int poisson(double mean, Stream& random) {
  const double limit = math::exp(-std::min(mean, 20.0));
  double product = random.uniform();
  int count = 0;
  for (; product > limit; ++count) product *= random.uniform();
  return count;
}

/// The places of one object that rays go to.
struct Look {
  std::array<double, places> distance_m;
  std::array<bool, places> shown;  ///< in the picture
  double deep_m = 0;               ///< half the object's extent along the line of sight
  double farthest_m = 0;           ///< of the places
  std::size_t first_ray = 0;
  bool any = false;  ///< none shown: no rays
};

/// @param direction_S  out: of `places` rays
Look look_at(const LabelledObject& target, const CameraMount& mount, const Pose& X_WS, const Context& context,
             std::span<Vec3> direction_S) {
  const Pose& X_WB = context.engine.states()[target.bodies.front()].X_WB;
  const Vec3 middle_W = middle_of(target, context);
  const Vec3 ahead_W = normalised(middle_W - X_WS.p);
  const Vec3 side_W = normalised(cross({0, 0, 1}, ahead_W), {0, 1, 0}), up_W = cross(ahead_W, side_W);
  const Vec3 size = target.bounds_B.size();
  const auto half = [&](Vec3 axis_W) { return half_extent(size, rotate_inverse(X_WB.q, axis_W)); };
  const double wide = spread * half(side_W), high = spread * half(up_W);

  Look look{.deep_m = half(ahead_W)};
  for (std::size_t i = 0; i < places; ++i) {
    const double u = static_cast<double>(i % across) - 1, v = static_cast<double>(i / across) - 1;
    const Vec3 place_W = middle_W + side_W * (u * wide) + up_W * (v * high);
    const Vec3 place_S = rotate_inverse(X_WS.q, place_W - X_WS.p);
    look.distance_m[i] = norm(place_S);
    direction_S[i] = normalised(place_S);
    look.shown[i] = in_picture(mount.lens(), place_S);
    look.any = look.any || look.shown[i];
    look.farthest_m = std::max(look.farthest_m, look.distance_m[i]);
  }
  return look;
}

/// The part of an object that is seen, from 0 to 1, from what its rays met. What lies behind the object counts as nothing.
double visible_part(const LabelledObject& target, const Look& look, std::span<const float> hit_m,
                    std::span<const std::uint32_t> hit) {
  int seen = 0, hidden = 0, open = 0;  // open: nothing is met where the thing might have been
  bool middle_open = false;
  for (std::size_t i = 0; i < places; ++i) {
    const bool met = static_cast<double>(hit_m[i]) <= look.farthest_m + look.deep_m;
    if (met && std::find(target.bodies.begin(), target.bodies.end(), hit[i]) != target.bodies.end()) {
      ++(look.shown[i] ? seen : hidden);
    } else if (met && static_cast<double>(hit_m[i]) < look.distance_m[i] - look.deep_m) {
      ++hidden;
    } else if (look.shown[i]) {
      ++open;
      middle_open = middle_open || i == places / 2;
    }
  }
  if (seen == 0 && middle_open) seen = open;
  return seen == 0 ? 0 : static_cast<double>(seen) / (seen + hidden);
}

/// Objects that are looked at together: rays of one job share what the ray caster finds out about their origin.
constexpr std::size_t at_once = 16;

/// An object that may be detected.
struct Candidate {
  const LabelledObject* target = nullptr;
  Measured truth{};
  double visible = 0;
};

/// Fills `visible` of those within range.
void look_at_all(std::span<Candidate> candidates, double max_range_m, const CameraMount& mount,
                 const Pose& X_WS, const Context& context) {
  std::array<Look, at_once> looks;
  std::array<Vec3, at_once * places> directions_S;
  std::array<float, at_once * places> hit_m;
  std::array<std::uint32_t, at_once * places> hit;
  std::size_t rays = 0;
  double reach_m = 0;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    looks[i] = {};
    if (!(candidates[i].truth.range <= max_range_m)) continue;
    looks[i] = look_at(*candidates[i].target, mount, X_WS, context,
                       std::span(directions_S).subspan(rays, places));
    if (!looks[i].any) continue;
    looks[i].first_ray = rays;
    rays += places;
    reach_m = std::max(reach_m, looks[i].farthest_m + looks[i].deep_m);
  }
  if (rays == 0) return;
  const RayJob job{.X_WS = X_WS,
                   .directions = std::span(directions_S).first(rays),
                   .min_m = 0,
                   .max_m = reach_m,
                   .ignore_body = mount.body,
                   .distance_m = std::span(hit_m).first(rays),
                   .body = std::span(hit).first(rays)};
  context.rays.cast({&job, 1});
  for (std::size_t i = 0; i < candidates.size(); ++i)
    if (looks[i].any)
      candidates[i].visible = visible_part(*candidates[i].target, looks[i],
                                           std::span(hit_m).subspan(looks[i].first_ray, places),
                                           std::span(hit).subspan(looks[i].first_ray, places));
}

}  // namespace

void detect(const ObjectKeys& keys, const WorldKeys& world, double errors, const CameraMount& mount,
            std::uint64_t sample, double since_s, const Context& context, msg::ObjectArray* objects,
            msg::ObjectPoseArray* poses) {
  Filling found(objects ? &objects->objects : nullptr);
  Filling placed(poses ? &poses->objects : nullptr);
  const Stream base = Stream(context.seed, mount.key, Purpose::noise, sample).fork(hash64("detector"));
  const Pose X_WS = mount.X_WS(context);
  std::vector<std::string_view> labels;
  const double confusion = std::min(1.0, errors * keys.confusion);
  const double ghosts = errors * keys.ghost_rate_hz * since_s;
  if (confusion > 0 || ghosts > 0) known_labels(keys, context, labels);

  const auto position_std = [&](double range) {
    return errors * (world.position_std_m + world.position_std_per_m * range);
  };
  const auto report = [&](const Candidate& candidate) {
    const LabelledObject& target = *candidate.target;
    const Measured& truth = candidate.truth;
    const double visible = candidate.visible;
    const bool anyway = placed && world.everything;
    const double miss = std::min(1.0, errors * (keys.miss_rate + keys.miss_rate_per_m * truth.range +
                                                keys.miss_rate_hidden * (1 - visible)));
    Stream random = base.fork(entity_key(target.name));
    // All numbers are drawn whether they are needed or not: each has its place in the stream.
    const bool missed = random.uniform() < miss;
    const bool confused = random.uniform() < confusion;
    std::array<double, 6> n;
    for (double& each : n) each = random.normal();
    const bool seen = visible > 0 && visible >= keys.min_visible && !missed;
    if (!seen && !anyway) return;
    const std::string_view label = confused ? another(labels, target.label, random) : target.label;
    const double confidence = (1 - miss) * visible;
    if (seen && found) {
      msg::Object& out = found.next();
      const double range_std = keys.range_std_m + keys.range_std_per_m * truth.range;
      out.label = label;
      out.name = keys.names ? target.name : std::string();
      out.color = color_of(target);
      put(out, {truth.bearing + errors * keys.bearing_std_rad * n[0],
                truth.elevation + errors * keys.bearing_std_rad * n[1],
                std::max(0.0, truth.range + errors * range_std * n[2])});
      out.visible = visible;
      out.confidence = confidence;
    }
    if (placed) {
      msg::ObjectPose& out = placed.next();
      out.label = label;
      out.name = keys.names ? target.name : std::string();
      out.color = color_of(target);
      out.position_std = position_std(truth.range);
      out.pose = context.engine.states()[target.bodies.front()].X_WB;
      out.pose.p += Vec3{n[3], n[4], 0} * out.position_std;
      out.pose.q = quat_from_axis_angle({0, 0, 1}, errors * world.heading_std_rad * n[5]) * out.pose.q;
      out.confidence = world.everything ? 1 : confidence;
    }
  };
  std::array<Candidate, at_once> candidates;
  std::size_t count = 0;
  const auto report_all = [&] {
    look_at_all(std::span(candidates).first(count), keys.max_range_m, mount, X_WS, context);
    for (std::size_t i = 0; i < count; ++i) report(candidates[i]);
    count = 0;
  };
  for (const LabelledObject& target : context.labelled_objects) {
    if (!wanted(keys, target.label)) continue;
    if (std::find(target.bodies.begin(), target.bodies.end(), mount.body) != target.bodies.end()) continue;
    const Vec3 middle_S = rotate_inverse(X_WS.q, middle_of(target, context) - X_WS.p);
    candidates[count++] = {&target, measure(middle_S)};
    if (count == at_once) report_all();
  }
  report_all();

  Stream random = base.fork(1);
  for (int left = ghosts > 0 && !labels.empty() ? poisson(ghosts, random) : 0; left > 0; --left) {
    const double u = random.uniform(-0.5, mount.lens().width - 0.5);
    const double v = random.uniform(-0.5, mount.lens().height - 0.5);
    const double range = random.uniform(0, keys.max_range_m);
    const double confidence = random.uniform(0, 0.5);
    const std::string_view label = labels[random.below(static_cast<std::uint32_t>(labels.size()))];
    const auto ray = ray_through(mount.lens(), u, v);
    if (!ray) continue;
    if (found) {
      msg::Object& out = found.next();
      out = {};
      out.label = label;
      put(out, measure(ray->direction * range));
      out.visible = 1;
      out.confidence = confidence;
    }
    if (placed) {
      msg::ObjectPose& out = placed.next();
      out = {};
      out.label = label;
      out.pose.p = X_WS * (ray->direction * range);
      out.position_std = position_std(range);
      out.confidence = confidence;
    }
  }
  found.done();
  placed.done();
}

}  // namespace sandlot::cameras
