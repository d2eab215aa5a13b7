#include "optics/picture_tree.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include "base/check.h"

namespace sandlot::optics {
namespace {

using lanes::any;
using lanes::broadcast;
using lanes::F;
using lanes::F3;
using lanes::I;
using lanes::select;

constexpr float tree_infinity = std::numeric_limits<float>::infinity();
constexpr float largest_span = std::numeric_limits<float>::max();
/// Surfaces whose distances differ by less lie in one plane: what single precision leaves of it at grazing
/// angles.
constexpr float same_distance = 4e-6f;
/// Up to this many visuals that stand still are rebuilt with the moving ones: one tree is faster to search
/// than two.
constexpr std::size_t few = 256;

/// Context of the callbacks in addition to the packet: Embree hands it through to them.
struct Query : embree::QueryContext {
  const Rays* rays;
  std::uint32_t ignore_body;
};

// Both packets begin alike; fields of eight lanes each.
static_assert(offsetof(RTCRayHit8, ray) == 0 && offsetof(RTCRay8, tnear) == 32 * 3);
static_assert(offsetof(RTCRay8, tfar) == 32 * 8 && offsetof(RTCRay8, id) == 32 * 10);
static_assert(offsetof(RTCRayHit8, hit.u) == 32 * 15 && offsetof(RTCRayHit8, hit.primID) == 32 * 17 &&
              offsetof(RTCRayHit8, hit.geomID) == 32 * 18);
constexpr unsigned tfar_field = 8, u_field = 15, v_field = 16, visual_field = 17, triangle_field = 18;

F* field(void* packet, unsigned index) { return reinterpret_cast<F*>(packet) + index; }

/// Lanes of the packet in Embree's query. We give it eight at a time, and so does it: `id` holds the lane all
/// the same.
bool is_whole(unsigned n) { return n == unsigned{lanes::width}; }

void keep_nearest(I valid, F t, const Rays& rays, int visual, Hits& hits) {
  const F band = same_distance * hits.t;
  const I nearer = t < hits.t - band, tie = (t <= hits.t + band) & (hits.visual < visual);
  const I take = valid & (t >= rays.near) & (t <= rays.far) & (t <= largest_span) & (nearer | tie);
  hits.t = select(take, t, hits.t);
  hits.visual = select(take, broadcast(visual), hits.visual);
}

LocalSpread8 spread_over(const Solid& solid, const Rays& rays) {
  const Rays8 directions{rays.direction.x, rays.direction.y, rays.direction.z, rays.near};
  return to_local(solid, rays.base, Spread8{rays.from.x, rays.from.y, rays.from.z}, directions);
}

F3 to_floats(Vec3 a) {
  return {broadcast(static_cast<float>(a.x)), broadcast(static_cast<float>(a.y)),
          broadcast(static_cast<float>(a.z))};
}

F plane_distance(const Visual& plane, const Rays& rays) {
  const Vec3 n = plane.normal_W;
  const double below = dot(n, plane.point_W - Vec3{rays.base[0], rays.base[1], rays.base[2]});
  const F3 normal = to_floats(n);
  const F towards = dot(normal, rays.direction);
  if (rays.from_base) return static_cast<float>(below) / towards;
  return (static_cast<float>(below) - dot(normal, rays.from)) / towards;
}

void fill_rays(RTCRay8& ray, const Rays& rays) {
  lanes::store(ray.org_x, rays.from.x + static_cast<float>(rays.base[0]));
  lanes::store(ray.org_y, rays.from.y + static_cast<float>(rays.base[1]));
  lanes::store(ray.org_z, rays.from.z + static_cast<float>(rays.base[2]));
  lanes::store(ray.dir_x, rays.direction.x);
  lanes::store(ray.dir_y, rays.direction.y);
  lanes::store(ray.dir_z, rays.direction.z);
  lanes::store(ray.tnear, rays.near);
  lanes::store(ray.time, broadcast(0.0f));
  lanes::store(ray.mask, broadcast(-1));
  lanes::store(ray.id, I{0, 1, 2, 3, 4, 5, 6, 7});
  lanes::store(ray.flags, broadcast(0));
}

}  // namespace

void PictureTree::Layer::clear() {
  if (scene) rtcReleaseScene(scene);
  if (geometry) rtcReleaseGeometry(geometry);
  scene = nullptr;
  geometry = nullptr;
  visuals.clear();
}

void PictureTree::Layer::attach(RTCSceneFlags flags, RTCBuildQuality quality) {
  if (visuals.empty()) return;
  scene = rtcNewScene(embree::device());
  rtcSetSceneFlags(scene, flags);
  rtcSetSceneBuildQuality(scene, quality);
  geometry = rtcNewGeometry(embree::device(), RTC_GEOMETRY_TYPE_USER);
  rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(visuals.size()));
  rtcSetGeometryUserData(geometry, this);
  rtcSetGeometryBoundsFunction(geometry, PictureTree::bounds, nullptr);
  rtcSetGeometryIntersectFunction(geometry, PictureTree::intersect);
  rtcSetGeometryOccludedFunction(geometry, PictureTree::occluded);
  rtcAttachGeometry(scene, geometry);
}

PictureTree::PictureTree() { fixed_.owner = moving_.owner = this; }

PictureTree::~PictureTree() {
  fixed_.clear();
  moving_.clear();
}

void PictureTree::set(std::span<const PictureShape> shapes) {
  fixed_.clear();
  moving_.clear();
  visuals_.clear();
  planes_.clear();
  groups_ = 0;
  auto old = std::exchange(triangles_, {});
  const auto still = static_cast<std::size_t>(
      std::count_if(shapes.begin(), shapes.end(), [](const PictureShape& s) { return !s.moves; }));
  for (const PictureShape& shape : shapes) {
    const auto index = static_cast<std::uint32_t>(visuals_.size());
    Visual& visual = visuals_.emplace_back();
    visual.given = shape;
    visual.X_GC = shape.X_GC;
    groups_ = std::max(groups_, shape.group + 1);
    if (std::holds_alternative<Plane>(shape.shape)) {
      visual.is_plane = true;
      planes_.push_back(index);
      continue;
    }
    if (const void* const key = triangles_of(shape.shape)) {
      if (const auto known = old.find(key); known != old.end() && !triangles_.contains(key))
        triangles_[key] = std::move(known->second);
      Triangles& t = triangles_[key];
      if (!t.tree) {
        t.tree = std::make_unique<TriangleTree>(shape.shape);
        arena_.execute([&] { t.tree->commit(); });
      }
      std::unique_ptr<Skin>& skin = t.skins[shape.appearance.smooth ? 1 : 0];
      if (!skin) skin = std::make_unique<Skin>(shape.shape, shape.appearance.smooth);
      visual.tree = t.tree.get();
      visual.skin = skin.get();
      visual.X_GC = shape.X_GC * Pose{t.tree->centre_m(), {}};
      visual.solid = make_triangles(t.tree->half_size_m(), index);
    } else {
      visual.solid = make_solid(shape.shape, index);
    }
    (shape.moves || still <= few ? moving_ : fixed_).visuals.push_back(index);
  }
  fixed_.attach(RTC_SCENE_FLAG_NONE, RTC_BUILD_QUALITY_HIGH);
  moving_.attach(RTC_SCENE_FLAG_DYNAMIC, RTC_BUILD_QUALITY_MEDIUM);
}

void PictureTree::place(Layer& layer, std::span<const Pose> X_WG) {
  if (layer.visuals.empty()) return;
  double size_m = 0;
  for (const std::uint32_t i : layer.visuals) {
    Visual& v = visuals_[i];
    v.solid.place(X_WG[v.given.group] * v.X_GC);
    const Bounds box = optics::bounds(v.solid);
    for (std::size_t k = 0; k < 3; ++k)
      size_m = std::max({size_m, std::abs(box.lower[k]), std::abs(box.upper[k])});
  }
  // As the ray scene has it: boxes a few roundings too large lose no ray.
  layer.margin_m = static_cast<float>(1e-6 * size_m);
  rtcCommitGeometry(layer.geometry);
  arena_.execute([&] { rtcCommitScene(layer.scene); });
}

void PictureTree::place(std::span<const Pose> X_WG, bool fixed_too) {
  if (fixed_too) place(fixed_, X_WG);
  place(moving_, X_WG);
  for (const std::uint32_t i : planes_) {
    Visual& v = visuals_[i];
    const Pose X_WC = X_WG[v.given.group] * v.X_GC;
    const Vec3 normal_C = std::get<Plane>(v.given.shape).normal;
    const Quat q = X_WC.q * quat_between({0, 0, 1}, normal_C);
    v.point_W = X_WC.p;
    v.normal_W = rotate(X_WC.q, normal_C);
    v.u_W = rotate(q, {1, 0, 0});
    v.v_W = rotate(q, {0, 1, 0});
  }
}

void PictureTree::bounds(const RTCBoundsFunctionArguments* arguments) {
  const auto& layer = *static_cast<const Layer*>(arguments->geometryUserPtr);
  embree::fill_bounds(optics::bounds(layer.owner->visuals_[layer.visuals[arguments->primID]].solid),
                      layer.margin_m, *arguments->bounds_o);
}

void PictureTree::intersect(const RTCIntersectFunctionNArguments* arguments) {
  const auto& layer = *static_cast<const Layer*>(arguments->geometryUserPtr);
  const std::uint32_t index = layer.visuals[arguments->primID];
  const Visual& visual = layer.owner->visuals_[index];
  const auto& query = *static_cast<const Query*>(arguments->context);
  if (visual.given.body == query.ignore_body && visual.given.body != no_body) return;
  SL_CHECK_MSG(is_whole(arguments->N), "Embree splits packets");
  void* const packet = arguments->rayhit;
  const Rays& rays = *query.rays;
  const I valid = lanes::load<I>(arguments->valid);
  F& tfar = *field(packet, tfar_field);
  Hits hits{tfar, I(*field(packet, visual_field)), {}, {}, {}};
  if (visual.tree) {
    const LocalSpread8 spread = spread_over(visual.solid, rays);
    F& triangle = *field(packet, triangle_field);
    alignas(32) int lanes_in[lanes::width];
    lanes::store(lanes_in, valid);
    const TriangleTree::Hits found = visual.tree->nearest(spread, rays.near, tfar * (1 + 2 * same_distance),
                                                          lanes_in);
    const F before = hits.t;
    const I was = hits.visual;
    keep_nearest(valid, found.t, rays, static_cast<int>(index), hits);
    const I taken = (hits.visual != was) | (hits.t != before);
    triangle = F(select(taken, found.triangle, I(triangle)));
    F &u = *field(packet, u_field), &v = *field(packet, v_field);
    u = select(taken, found.b1, u);
    v = select(taken, found.b2, v);
  } else {
    const F t = rays.from_base
                    ? distance_to(visual.solid, rays.base,
                                  {rays.direction.x, rays.direction.y, rays.direction.z, rays.near})
                    : distance_to(visual.solid, spread_over(visual.solid, rays), rays.near);
    keep_nearest(valid, t, rays, static_cast<int>(index), hits);
  }
  tfar = hits.t;
  *field(packet, visual_field) = F(hits.visual);
}

void PictureTree::occluded(const RTCOccludedFunctionNArguments* arguments) {
  const auto& layer = *static_cast<const Layer*>(arguments->geometryUserPtr);
  const Visual& visual = layer.owner->visuals_[layer.visuals[arguments->primID]];
  if (!visual.given.cast_shadows) return;
  const auto& query = *static_cast<const Query*>(arguments->context);
  if (visual.given.body == query.ignore_body && visual.given.body != no_body) return;
  SL_CHECK_MSG(is_whole(arguments->N), "Embree splits packets");
  const Rays& rays = *query.rays;
  const I valid = lanes::load<I>(arguments->valid);
  const LocalSpread8 spread = spread_over(visual.solid, rays);
  I hit;
  if (visual.tree) {
    alignas(32) int lanes_in[lanes::width];
    lanes::store(lanes_in, valid);
    hit = valid & visual.tree->between(spread, rays.near, rays.far, lanes_in);
  } else {
    const F t = distance_to(visual.solid, spread, rays.near);
    hit = valid & (t >= rays.near) & (t <= rays.far) & (t <= largest_span);
  }
  F& tfar = *field(arguments->ray, tfar_field);
  tfar = select(hit, broadcast(-tree_infinity), tfar);
}

Hits PictureTree::trace(const Rays& rays, std::uint32_t ignore_body) const {
  Hits hits{rays.far, broadcast(-1), broadcast(-1), broadcast(0.0f), broadcast(0.0f)};
  for (const std::uint32_t i : planes_) {
    const Visual& plane = visuals_[i];
    if (plane.given.body == ignore_body && ignore_body != no_body) continue;
    keep_nearest(rays.valid, plane_distance(plane, rays), rays, static_cast<int>(i), hits);
  }
  if (!fixed_.scene && !moving_.scene) return hits;
  alignas(64) RTCRayHit8 packet;
  fill_rays(packet.ray, rays);
  lanes::store(packet.ray.tfar, hits.t);
  lanes::store(packet.hit.primID, hits.visual);
  lanes::store(packet.hit.geomID, hits.triangle);
  lanes::store(packet.hit.u, hits.b1);
  lanes::store(packet.hit.v, hits.b2);
  alignas(32) int valid[lanes::width];
  lanes::store(valid, rays.valid);
  Query query;
  embree::init_context(query);
  query.rays = &rays;
  query.ignore_body = ignore_body;
  for (const Layer* layer : {&moving_, &fixed_})
    if (layer->scene) embree::intersect8_coherent(valid, layer->scene, query, packet);
  return {lanes::load<F>(packet.ray.tfar), lanes::load<I>(packet.hit.primID),
          lanes::load<I>(packet.hit.geomID), lanes::load<F>(packet.hit.u), lanes::load<F>(packet.hit.v)};
}

I PictureTree::shadowed(const Rays& rays, I doubtful, std::uint32_t ignore_body) const {
  I dark{};
  for (const std::uint32_t i : planes_) {
    if (!visuals_[i].given.cast_shadows) continue;
    if (visuals_[i].given.body == ignore_body && ignore_body != no_body) continue;
    // Mostly all points lie above a ground that the light does not come through.
    const Vec3 n = visuals_[i].normal_W;
    const F3 normal = to_floats(n);
    const double above = dot(n, Vec3{rays.base[0], rays.base[1], rays.base[2]} - visuals_[i].point_W);
    const F height = static_cast<float>(above) + dot(normal, rays.from), climbs = dot(normal, rays.direction);
    if (!any(rays.valid & (height * climbs < 0))) continue;
    const F t = -height / climbs;
    dark |= rays.valid & (t >= rays.near) & (t <= rays.far) & (t <= largest_span);
  }
  const I open = doubtful & ~dark;
  if (!any(open) || (!fixed_.scene && !moving_.scene)) return dark;
  alignas(64) RTCRay8 packet;
  fill_rays(packet, rays);
  lanes::store(packet.tfar, rays.far);
  alignas(32) int valid[lanes::width];
  lanes::store(valid, open);
  Query query;
  embree::init_context(query);
  query.rays = &rays;
  query.ignore_body = ignore_body;
  for (const Layer* layer : {&moving_, &fixed_})
    if (layer->scene) embree::occluded8(valid, layer->scene, query, packet);
  return dark | (open & (lanes::load<F>(packet.tfar) < 0));
}

}  // namespace sandlot::optics
