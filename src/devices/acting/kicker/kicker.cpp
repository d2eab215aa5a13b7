#include "devices/acting/kicker/kicker.h"

#include <algorithm>
#include <cmath>

#include "base/math.h"
#include "physics/distance.h"

namespace sandlot::kicker {
namespace {

constexpr double between_rays_rad = 5 * math::pi / 180;

/// Distance along a ray to a solid, by steps of the distance to it, which never pass it. Nothing: farther than `reach_m`.
std::optional<double> meets(const Shape& shape, const Pose& X_CW, Vec3 from_W, Vec3 along_W, double reach_m) {
  const Vec3 from = X_CW * from_W, along = rotate(X_CW.q, along_W);
  double at = 0;
  for (int step = 0; step < 200 && at <= reach_m; ++step) {
    const double gap = distance_m(shape, from + along * at, reach_m);
    if (gap <= 1e-7) return at;
    at += gap;
  }
  return std::nullopt;
}

/// What a kicker meets.
struct Met {
  BodyId body;
  BodyName name;
  Vec3 point_W;
};

std::optional<Met> first_in_front(const Kicker& kicker, const Pose& X_WS, const Engine& engine) {
  const Spec& spec = kicker.spec;
  const OverlapQuery ball{X_WS.p, spec.reach_m};
  std::vector<std::uint32_t> found, ends;
  engine.overlaps(std::span(&ball, 1), found, ends);
  const int to_a_side = static_cast<int>(std::ceil(0.5 * spec.opening_rad / between_rays_rad - 1e-9));
  std::optional<Met> met;
  double nearest = spec.reach_m;
  for (const std::uint32_t index : found) {
    const BodyId id = engine.body_at(index);
    const BodyName name = engine.name(id);
    if (!name.link || name.instance == kicker.robot) continue;
    for (const model::Collision& collision : name.link->collisions) {
      if (!collision.surface.touches) continue;
      const Pose X_CW = inverse(engine.states()[index].X_WB * collision.X_LC);
      for (int ray = -to_a_side; ray <= to_a_side; ++ray) {
        const double angle = ray == 0 ? 0 : 0.5 * spec.opening_rad * ray / to_a_side;
        const Vec3 along_W = rotate(X_WS.q, {math::cos(angle), math::sin(angle), 0});
        const auto at = meets(collision.shape, X_CW, X_WS.p, along_W, nearest);
        if (!at) continue;
        // Names and not indices decide between equals: a restored world may count them out differently.
        const bool nearer = !met || *at < nearest ||
                            std::pair(name.instance, std::string_view(name.link->name)) <
                                std::pair(met->name.instance, std::string_view(met->name.link->name));
        if (!nearer) continue;
        nearest = *at;
        met = Met{id, name, X_WS.p + along_W * *at};
      }
    }
  }
  return met;
}

/// An impulse at a point as a wrench over a step.
Wrench wrench_of(const Engine& engine, BodyId body, Vec3 point_W, Vec3 impulse_W_Ns, double h_s) {
  const Pose& X_WB = engine.states()[body.index].X_WB;
  const model::Link* const link = engine.name(body).link;
  const Vec3 centre_W = X_WB * (link ? link->inertial.X_LCo.p : Vec3{});
  const Vec3 force_N = impulse_W_Ns / h_s;
  return {body, force_N, cross(point_W - centre_W, force_N)};
}

}  // namespace

Result<Kicker> Kicker::create(const DeviceBuild& build, Spec spec) {
  if (build.engine.planar && spec.elevation_rad != 0)
    return build.error("elevation", "the engine '" + std::string(build.engine.name) + "' knows no height",
                       "0 there, or the engine rigid");
  Kicker kicker{spec};
  kicker.body = build.body();
  kicker.energy = build.energy;
  kicker.robot = build.instance.name;
  kicker.X_LS = build.decl.X_LS;
  kicker.kick = build.publish<msg::KickerState>(0, "kick");
  kicker.kick->message.header.frame_id = build.frame_id();
  kicker.command = build.accept<msg::Float64>(0, "kick");
  return kicker;
}

void Kicker::take(double impulse_Ns, const Context& context) {
  const double part = std::min(impulse_Ns / spec.max_impulse_Ns, std::sqrt(state.charge));
  state.charge = std::max(0.0, state.charge - part * part);
  ++state.kicks;
  state.impulse_Ns = 0;
  state.object.clear();
  const Pose X_WS = context.engine.states()[body.index].X_WB * X_LS;
  const auto met = first_in_front(*this, X_WS, context.engine);
  if (!met) return;
  ++state.hits;
  state.impulse_Ns = part * spec.max_impulse_Ns;
  state.object = met->name.instance;
  const Vec3 along_S{math::cos(spec.elevation_rad), 0, math::sin(spec.elevation_rad)};
  blow = Blow{met->body, met->point_W, rotate(X_WS.q, along_S) * state.impulse_Ns};
}

void Kicker::actuate(PoolView<Kicker> pool, const Context& context) {
  for (const std::uint32_t index : pool.due) {
    Kicker& kicker = pool.all[index];
    State& state = kicker.state;
    kicker.blow.reset();
    if (kicker.command->count != state.taken) {
      state.taken = kicker.command->count;
      const double impulse_Ns = kicker.command->message.data;
      if (impulse_Ns > 0) kicker.take(impulse_Ns, context);
    }
    if (state.charge < 1) {
      const double time_s = kicker.spec.recharge_time_s, room = 1 - state.charge;
      double filled = time_s > 0 ? std::min(room, context.tick.s() / time_s) : room;
      if (kicker.energy && kicker.spec.energy_J > 0) {
        kicker.energy->draw(filled * kicker.spec.energy_J);
        filled *= kicker.energy->state.share;
      }
      state.charge = filled < room ? state.charge + filled : 1;
    }
  }
}

void Kicker::pre_substep(PoolView<Kicker> pool, const Context& context, double h_s) {
  for (const std::uint32_t index : pool.due) {
    Kicker& kicker = pool.all[index];
    if (!kicker.blow) continue;
    const Blow& blow = *kicker.blow;
    const Engine& engine = context.engine;
    if (engine.name(blow.body).moves)
      context.actuation.wrenches.push_back(
          wrench_of(engine, blow.body, blow.point_W, blow.impulse_W_Ns, h_s));
    context.actuation.wrenches.push_back(
        wrench_of(engine, kicker.body, blow.point_W, -blow.impulse_W_Ns, h_s));
    kicker.blow.reset();
  }
}

void Kicker::sense(PoolView<Kicker> pool, const Context& context) {
  for (const std::uint32_t index : pool.due) {
    Kicker& kicker = pool.all[index];
    const State& state = kicker.state;
    msg::KickerState& message = kicker.kick->message;
    message.charge = state.charge;
    message.ready = state.charge >= 1;
    message.kicks = state.kicks;
    message.hits = state.hits;
    message.impulse = state.impulse_Ns;
    message.object = state.object;
    kicker.kick->publish(context.now);
  }
}

namespace {
constexpr LevelInfo levels[] = {
    {"kick", msg::KickerState::ros_type, msg::Float64::ros_type,
     "Kicks with the commanded impulse; reports the charge and what was met."},
};
}  // namespace

constinit const Kind kind = make_kind<Kicker>({
    .name = "kicker",
    .help = "Kicker that gives what stands in front of it an impulse, and recharges.",
    .levels = levels,
});

}  // namespace sandlot::kicker
