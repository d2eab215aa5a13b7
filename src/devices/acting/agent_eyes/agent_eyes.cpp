#include "devices/acting/agent_eyes/agent_eyes.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/math.h"
#include "devices/acting/property_message.h"

namespace sandlot::agent_eyes {
namespace {

bool is_part(const LabelledObject& target, std::uint32_t body) {
  return std::find(target.bodies.begin(), target.bodies.end(), body) != target.bodies.end();
}

bool reports(const Spec& spec, const LabelledObject& target) {
  return (target.moves || spec.fixed) &&
         (spec.labels.empty() ||
          std::find(spec.labels.begin(), spec.labels.end(), target.label) != spec.labels.end());
}

/// Half of what a box spans along an axis. @param axis_B  unit, in the frame of the box
double half_extent(Vec3 size, Vec3 axis_B) {
  return 0.5 * (size.x * std::abs(axis_B.x) + size.y * std::abs(axis_B.y) + size.z * std::abs(axis_B.z));
}

}  // namespace

Result<AgentEyes> AgentEyes::create(const DeviceBuild& build, Spec spec) {
  AgentEyes eyes{std::move(spec)};
  eyes.body = build.body();
  eyes.X_LS = build.decl.X_LS;
  eyes.objects = build.publish<msg::VisibleObjectArray>(0, "objects");
  eyes.objects->message.header.frame_id = build.frame_id();
  return eyes;
}

std::uint32_t AgentEyes::first_body(const Pose& X_WS, Vec3 place_W, double behind_m,
                                    const LabelledObject* self, const Context& context) const {
  const Vec3 place_S = rotate_inverse(X_WS.q, place_W - X_WS.p), direction = normalised(place_S, {1, 0, 0});
  double from_m = 0;
  for (int own = 0; own < 8; ++own) {
    float hit_m = 0;
    std::uint32_t hit = no_body;
    const RayJob job{.X_WS = X_WS,
                     .directions = {&direction, 1},
                     .min_m = from_m,
                     .max_m = norm(place_S) + behind_m,
                     .ignore_body = body.index,
                     .distance_m = {&hit_m, 1},
                     .body = {&hit, 1}};
    context.rays.cast({&job, 1});
    if (!std::isfinite(hit_m)) return no_body;
    if (!self || !is_part(*self, hit)) return hit;
    from_m = static_cast<double>(hit_m) + 1e-4;  // a link of its own does not hide anything
  }
  return no_body;
}

bool AgentEyes::sees(const LabelledObject& target, const Pose& X_WS, Vec3 middle_W,
                     const LabelledObject* self, const Context& context) const {
  const Pose& X_WB = context.engine.states()[target.bodies.front()].X_WB;
  const Vec3 ahead_W = normalised(middle_W - X_WS.p, {1, 0, 0});
  const Vec3 side_W = normalised(cross({0, 0, 1}, ahead_W), {0, 1, 0}), up_W = cross(ahead_W, side_W);
  const Vec3 size = target.bounds_B.size();
  const auto reach = [&](Vec3 axis_W) { return half_extent(size, rotate_inverse(X_WB.q, axis_W)); };
  const Vec3 side = side_W * (0.8 * reach(side_W)), up = up_W * (0.8 * reach(up_W));
  const std::array<Vec3, 5> places_W{middle_W, middle_W + side, middle_W - side, middle_W + up,
                                     middle_W - up};
  const double behind = reach(ahead_W);
  for (std::size_t i = 0; i < places_W.size(); ++i) {
    const std::uint32_t met = first_body(X_WS, places_W[i], behind, self, context);
    if (met == no_body ? i == 0 : is_part(target, met)) return true;
  }
  return false;
}

void AgentEyes::sense(PoolView<AgentEyes> pool, const Context& context) {
  const auto states = context.engine.states();
  for (const std::uint32_t index : pool.due) {
    AgentEyes& eyes = pool.all[index];
    const Spec& spec = eyes.spec;
    const Pose X_WS = states[eyes.body.index].X_WB * eyes.X_LS;
    std::vector<msg::VisibleObject>& reported = eyes.objects->message.objects;
    std::size_t count = 0;
    const auto own = std::find_if(context.labelled_objects.begin(), context.labelled_objects.end(),
                                  [&](const LabelledObject& each) { return is_part(each, eyes.body.index); });
    const LabelledObject* const self = own == context.labelled_objects.end() ? nullptr : &*own;
    for (const LabelledObject& target : context.labelled_objects) {
      if (!reports(spec, target) || &target == self) continue;
      const BodyState& state = states[target.bodies.front()];
      const Vec3 middle_W = state.X_WB * (0.5 * (target.bounds_B.low + target.bounds_B.high));
      const Vec3 middle_S = rotate_inverse(X_WS.q, middle_W - X_WS.p);
      const double range = norm(middle_S), bearing = math::atan2(middle_S.y, middle_S.x);
      if (range > spec.range_m || std::abs(bearing) > spec.fov_rad / 2) continue;
      if (!spec.through_walls && !eyes.sees(target, X_WS, middle_W, self, context)) continue;
      if (count == reported.size())
        reported.emplace_back();  // else: the place of an earlier sample and its memory
      msg::VisibleObject& object = reported[count++];
      object.name = target.name;
      object.label = target.label;
      object.team = target.team;
      object.robot = target.is_robot;
      object.color = {target.color.r, target.color.g, target.color.b, target.color.a};
      object.pose = inverse(X_WS) * state.X_WB;
      object.velocity.linear = rotate_inverse(X_WS.q, state.V_WB.linear);
      object.velocity.angular = rotate_inverse(X_WS.q, state.V_WB.angular);
      object.range = range;
      object.bearing = bearing;
      object.size = target.bounds_B.size();
      object.mass = target.mass_kg;
      object.properties.resize(target.properties.size());
      for (std::size_t i = 0; i < target.properties.size(); ++i)
        acting::fill(object.properties[i], target.properties[i]);
    }
    reported.resize(count);
    eyes.objects->publish(context.now);
  }
}

namespace {
constexpr LevelInfo levels[] = {
    {"objects", msg::VisibleObjectArray::ros_type, "",
     "All robots and objects in sight with their properties."},
};
}  // namespace

constinit const Kind kind = make_kind<AgentEyes>({
    .name = "agent_eyes",
    .help = "Eyes of a high-level agent: all objects in sight with pose, velocity, size, mass and the user's "
            "properties.",
    .levels = levels,
    .needs_render_scene = true,
});

}  // namespace sandlot::agent_eyes
