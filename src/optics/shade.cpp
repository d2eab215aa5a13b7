#include "optics/shade.h"

#include <algorithm>
#include <cmath>

#include "base/math.h"
#include "geometry/mesh.h"
#include "optics/sample.h"

namespace sandlot::optics {
namespace {

using lanes::any;
using lanes::broadcast;
using lanes::F;
using lanes::F3;
using lanes::I;
using lanes::max;
using lanes::select;

/// Hits of the packet's rays, gathered visual by visual.
struct Met {
  F3 normal, face_normal;  ///< in W
  F3 diffuse, specular, emissive;
  F shininess;
  bool shiny = false;
  I convex = broadcast(-1);  ///< the visual of those that see the outside of a convex solid
};

int first_lane(I mask) {
  for (int i = 0; i < lanes::width; ++i)
    if (mask[i]) return i;
  return 0;
}

F3 broadcast(const Color& c) { return {broadcast(c.r), broadcast(c.g), broadcast(c.b)}; }
bool is_black(const Color& c) { return c.r == 0 && c.g == 0 && c.b == 0; }

F3 decoded(const F3& c, bool srgb) {
  return srgb ? F3{srgb_decoded(c.x), srgb_decoded(c.y), srgb_decoded(c.z)} : c;
}

F3 to_shape(const Solid& s, const F3& a) {
  const float* m = s.axes;
  return {m[0] * a.x + m[1] * a.y + m[2] * a.z, m[3] * a.x + m[4] * a.y + m[5] * a.z,
          m[6] * a.x + m[7] * a.y + m[8] * a.z};
}
F3 to_world(const Solid& s, const F3& a) {
  const float* m = s.axes;
  return {m[0] * a.x + m[3] * a.y + m[6] * a.z, m[1] * a.x + m[4] * a.y + m[7] * a.z,
          m[2] * a.x + m[5] * a.y + m[8] * a.z};
}
F3 broadcast(Vec3 a) {
  const float f[] = {static_cast<float>(a.x), static_cast<float>(a.y), static_cast<float>(a.z)};
  return lanes::broadcast3(f);
}

/// The pixel's cone cut by the surface: across it as wide as the cone, along it longer by 1 / cos.
Footprint8 footprint(const Surface8& s, const F3& direction, F width) {
  const F3& n = s.face_normal;
  const F3 nudge{broadcast(0.3f), broadcast(0.5f),
                 broadcast(0.7f)};  // looked at from straight above, any axis will do
  F cosine = dot(n, direction);
  F3 along = direction - cosine * n;
  along = select(dot(along, along) < 1e-6f, nudge - dot(nudge, n) * n, along);
  along = (1 / lanes::sqrt(max(dot(along, along), broadcast(1e-20f)))) * along;
  const F3 across{n.y * along.z - n.z * along.y, n.z * along.x - n.x * along.z,
                  n.x * along.y - n.y * along.x};
  const F length = width / max(lanes::abs(cosine), broadcast(1e-4f));
  return {s.u,
          s.v,
          {length * dot(s.u_gradient, along), width * dot(s.u_gradient, across)},
          {length * dot(s.v_gradient, along), width * dot(s.v_gradient, across)}};
}

/// Surface of the plane, relative to the base of the rays; texture coordinates modulo 1, found in double
/// precision.
Surface8 plane_surface(const Visual& plane, const Rays& rays, const F3& relative, bool textured) {
  Surface8 s;
  s.normal = s.face_normal = broadcast(plane.normal_W);
  if (!textured) return s;
  const double per_m = 1 / plane.given.appearance.tile_m;
  const Vec3 base = Vec3{rays.base[0], rays.base[1], rays.base[2]} - plane.point_W;
  const auto place = [&](Vec3 axis, F& value, F3& gradient) {
    const double at = dot(axis, base) * per_m;
    gradient = broadcast(axis * per_m);
    value = static_cast<float>(at - std::floor(at)) + dot(gradient, relative);
  };
  place(plane.u_W, s.u, s.u_gradient);
  place(plane.v_W, s.v, s.v_gradient);
  return s;
}

/// Adds the lanes of one visual (of a mesh with parts, of one of them) and returns which they are.
I gather(const Scenery& scenery, const Rays& rays, const Hits& hits, F cone, I todo, Met& met) {
  const int lane = first_lane(todo);
  const Visual& visual = scenery.tree->visual(static_cast<std::size_t>(hits.visual[lane]));
  const SurfaceAppearance& appearance = visual.given.appearance;
  I mask = todo & (hits.visual == hits.visual[lane]);
  Color diffuse = appearance.diffuse;
  const Texture* texture = appearance.texture.get();
  if (visual.skin && appearance.from_mesh && visual.skin->mesh() && !visual.skin->mesh()->parts.empty()) {
    const auto& parts = visual.skin->mesh()->parts;
    const std::uint32_t part = visual.skin->part(static_cast<std::uint32_t>(hits.triangle[lane]));
    if (parts.size() > 1)
      for (int i = 0; i < lanes::width; ++i)
        if (mask[i] && visual.skin->part(static_cast<std::uint32_t>(hits.triangle[i])) != part) mask[i] = 0;
    diffuse = parts[part].color;
    texture = part < appearance.part_textures.size() ? appearance.part_textures[part].get() : nullptr;
  }
  if (visual.skin && !visual.skin->has_texture_coordinates()) texture = nullptr;

  const bool textured = texture != nullptr;
  const F3 direction = visual.is_plane ? rays.direction : to_shape(visual.solid, rays.direction);
  // In one expression: a surface is expensive to copy.
  const Surface8 s = [&] {
    if (visual.is_plane) return plane_surface(visual, rays, rays.from + hits.t * rays.direction, textured);
    float origin[3];
    origin_in(visual.solid, rays.base, origin);
    F3 p = hits.t * direction + lanes::broadcast3(origin);
    if (!rays.from_base) p = p + to_shape(visual.solid, rays.from);
    if (!visual.skin) return surface_of(visual.solid, p, textured);
    return visual.skin->surface(mask, hits.triangle, hits.b1, hits.b2, p, textured);
  }();
  const auto in_world = [&](const F3& n) { return visual.is_plane ? n : to_world(visual.solid, n); };
  // Mostly a packet sees one thing.
  const bool alone = lanes::bits(mask) == lanes::bits(rays.valid & (hits.visual >= 0));
  const auto take = [&](const F3& from, F3& to) { to = alone ? from : select(mask, from, to); };
  if (!visual.is_plane && !visual.skin) met.convex = lanes::select(mask, hits.visual, met.convex);
  take(in_world(s.normal), met.normal);
  if (visual.skin) take(in_world(s.face_normal), met.face_normal);
  else take(met.normal, met.face_normal);
  F3 color = broadcast(diffuse);
  if (textured) color = color * sample(*texture, footprint(s, direction, cone * hits.t), mask);
  take(decoded(color, scenery.srgb), met.diffuse);
  if (!is_black(appearance.emissive))
    met.emissive = select(mask, decoded(broadcast(appearance.emissive), scenery.srgb), met.emissive);
  if (!is_black(appearance.specular) && appearance.shininess > 0) {
    met.shiny = true;
    met.specular = select(mask, decoded(broadcast(appearance.specular), scenery.srgb), met.specular);
    met.shininess = select(mask, broadcast(appearance.shininess), met.shininess);
  }
  return mask;
}

/// Adds what one light gives to the points, which are relative to the base.
void add_light(const Scenery& scenery, const LightNow& light, const Rays& rays, const Met& met, const F3& at,
               F lift, I hit, F3& sum) {
  F3 to_light;
  F far = broadcast(1e30f), strength = broadcast(1.0f);
  if (light.type == model::Light::Type::directional) {
    to_light = F3{broadcast(-light.shines[0]), broadcast(-light.shines[1]), broadcast(-light.shines[2])};
  } else {
    const F3 away = lanes::broadcast3(light.position) - at;
    far = lanes::sqrt(max(dot(away, away), broadcast(1e-12f)));
    to_light = (1 / far) * away;
    strength = 1 / max(light.constant + far * (light.linear + far * light.quadratic), broadcast(1e-6f));
    strength = select(far <= light.range, strength, broadcast(0.0f));
  }
  if (light.type == model::Light::Type::spot) {
    const F cosine = -dot(to_light, lanes::broadcast3(light.shines));
    const float band = std::max(light.cos_inner - light.cos_outer, 1e-6f);
    const F inside = lanes::clamp((cosine - light.cos_outer) / band, 0, 1);
    strength = strength * (light.falloff == 1 ? inside : lanes::power(inside, broadcast(light.falloff)));
  }
  const F cosine = dot(met.normal, to_light);
  I lit = hit & (cosine > 0) & (strength > 0);
  if (!any(lit)) return;
  if (light.shadows && scenery.shadows) {
    Rays shadow{rays.base, at + lift * met.face_normal, false, to_light, broadcast(0.0f), far - lift, lit};
    const I doubtful = light.grid.grid ? ShadowGrid::doubtful(light.grid, shadow.from, lit, met.convex) : lit;
    lit = lit & ~scenery.tree->shadowed(shadow, doubtful, scenery.shadowless_body);
    if (!any(lit)) return;
  }
  strength = select(lit, strength, broadcast(0.0f));
  F3 given = (strength * cosine) * (met.diffuse * lanes::broadcast3(light.diffuse));
  if (met.shiny) {
    const F3 half = normalised(to_light - rays.direction);
    const F highlight = strength * lanes::power(max(dot(met.normal, half), broadcast(0.0f)), met.shininess);
    given = given + highlight * (met.specular * lanes::broadcast3(light.specular));
  }
  sum = sum + given;
}

}  // namespace

F srgb_encoded(F x) {
  return select(x <= 0.0031308f, 12.92f * x,
                1.055f * lanes::power(max(x, broadcast(0.0f)), broadcast(1 / 2.4f)) - 0.055f);
}
F srgb_decoded(F x) {
  return select(x <= 0.04045f, x / 12.92f,
                lanes::power((max(x, broadcast(0.0f)) + 0.055f) / 1.055f, broadcast(2.4f)));
}

LightNow light_now(const PictureLight& given, std::span<const Pose> X_WG, const double base[3]) {
  const model::Light& light = given.light;
  const Pose X_WL = X_WG[given.group] * light.X_PLight;
  const Vec3 position = X_WL.p - Vec3{base[0], base[1], base[2]}, shines = rotate(X_WL.q, {0, 0, -1});
  LightNow now{};
  now.type = light.type;
  for (std::size_t i = 0; i < 3; ++i) {
    now.position[i] = static_cast<float>(position[i]);
    now.shines[i] = static_cast<float>(shines[i]);
  }
  const auto copy = [](const Color& from, float* to) { to[0] = from.r, to[1] = from.g, to[2] = from.b; };
  copy(light.color, now.diffuse);
  copy(light.specular, now.specular);
  now.constant = static_cast<float>(light.constant);
  now.linear = static_cast<float>(light.linear);
  now.quadratic = static_cast<float>(light.quadratic);
  now.range = static_cast<float>(light.range_m);
  now.cos_inner = static_cast<float>(math::cos(light.inner_rad / 2));
  now.cos_outer = static_cast<float>(math::cos(light.outer_rad / 2));
  now.falloff = static_cast<float>(light.falloff);
  now.shadows = light.cast_shadows;
  return now;
}

F3 light_at(const Scenery& scenery, const double* base, const F3& at, const F3& normal, I valid) {
  const F zero = broadcast(0.0f), one = broadcast(1.0f);
  const F3 black{zero, zero, zero}, away{-normal.x, -normal.y, -normal.z};
  const Met white{normal, normal, {one, one, one}, black, black, zero};
  const Rays rays{base, at, false, away, zero, broadcast(1e30f), valid};
  F3 sum = broadcast(scenery.surroundings.ambient);
  for (const LightNow& light : scenery.lights)
    add_light(scenery, light, rays, white, at, broadcast(2e-4f), valid, sum);
  return sum;
}

F3 shade(const Scenery& scenery, const Rays& rays, const Hits& hits, F cone) {
  const I hit = rays.valid & (hits.visual >= 0);
  const F zero = broadcast(0.0f);
  const F3 black{zero, zero, zero};
  const F3 background = decoded(broadcast(scenery.surroundings.background), scenery.srgb);
  if (!any(hit)) return background;
  Met met{black, black, black, black, black, zero};
  for (I todo = hit; any(todo);) todo &= ~gather(scenery, rays, hits, cone, todo, met);
  if (!scenery.lit) return select(hit, met.emissive + met.diffuse, background);
  // Both sides of a surface look alike.
  const I behind = dot(met.face_normal, rays.direction) > 0;
  met.convex |= behind;
  met.normal = select(behind, F3{-met.normal.x, -met.normal.y, -met.normal.z}, met.normal);
  met.face_normal = select(behind, F3{-met.face_normal.x, -met.face_normal.y, -met.face_normal.z},
                           met.face_normal);
  F3 sum = met.emissive + met.diffuse * broadcast(scenery.surroundings.ambient);
  F3 at = hits.t * rays.direction;
  if (!rays.from_base) at = at + rays.from;
  // Shadow rays leave a little above the surface, by more than rounding has moved the point.
  const F lift = 2e-4f + 1e-5f * hits.t;
  for (const LightNow& light : scenery.lights) add_light(scenery, light, rays, met, at, lift, hit, sum);
  return select(hit, sum, background);
}

}  // namespace sandlot::optics
