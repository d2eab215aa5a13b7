#include "devices/acting/ball_handler/ball_handler.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/math.h"

namespace sandlot::ball_handler {
namespace {

/// Time in which the ball comes nearer to where it is held by a factor e.
constexpr double settling_s = 0.08;
/// Share of a difference of velocities that is taken away in a physics step.
constexpr double gain = 0.5;
/// Largest distance of a ball's middle from the origin of its link.
constexpr double margin_m = 0.5;

/// The sphere that a ball is.
const model::Collision* ball_of(const BodyName& name) {
  if (!name.link || !name.moves || name.link->collisions.size() != 1) return nullptr;
  const model::Collision& skin = name.link->collisions.front();
  const bool is_ball = skin.surface.touches && std::holds_alternative<Sphere>(skin.shape);
  return is_ball && norm(skin.X_LC.p) <= margin_m ? &skin : nullptr;
}

Vec3 centre_of_mass(const Engine& engine, BodyId body, const Pose& X_WB) {
  const model::Link* const link = engine.name(body).link;
  return X_WB * (link ? link->inertial.X_LCo.p : Vec3{});
}

Vec3 velocity_at(const BodyState& body, Vec3 point_W) {
  return body.V_WB.linear + cross(body.V_WB.angular, point_W - body.X_WB.p);
}

Vec3 level(Vec3 v) { return {v.x, v.y, 0}; }

/// `v` cut to a length.
Vec3 at_most(Vec3 v, double length) {
  const double size = norm(v);
  return size > length ? v * (length / size) : v;
}

}  // namespace

Status Spec::check(const Node& node, const std::string& path) const {
  if (hold_distance_m <= reach_m) return {};
  const Node* at = node.find("hold_distance");
  if (!at) at = node.find("reach");
  return (at ? *at : node)
      .error("the ball would be held beyond the reach", "give a smaller hold_distance, or more reach",
             path + "/hold_distance");
}

Result<BallHandler> BallHandler::create(const DeviceBuild& build, Spec spec) {
  BallHandler handler{spec};
  handler.body = build.body();
  handler.robot = build.instance.name;
  handler.X_LS = build.decl.X_LS;
  handler.planar = build.engine.planar;
  handler.state.strength = spec.strength;
  handler.hold = build.publish<msg::BallHandlerState>(0, "hold");
  handler.hold->message.header.frame_id = build.frame_id();
  handler.command = build.accept<msg::Float64>(0, "hold");
  return handler;
}

bool BallHandler::fits() const {
  return state.strength >= 0 && state.strength <= 1 && std::isfinite(state.impulse_Ns) &&
         std::isfinite(state.force_N);
}

/// The ball that is held if it is still within reach, else the nearest that is: ball, and the names in State.
void BallHandler::find_ball(const Engine& engine) {
  const auto bodies = engine.states();
  const Pose X_WS = bodies[body.index].X_WB * X_LS;
  const double farthest_m = spec.reach_m + margin_m;
  double nearest = std::numeric_limits<double>::infinity();
  BodyId best;
  bool kept = false;
  for (std::uint32_t index = 0; index < bodies.size(); ++index) {
    // Two subtractions tell nearly all bodies: much less than a query of shapes, of which wheels with rollers have many.
    if (!(std::abs(bodies[index].X_WB.p.x - X_WS.p.x) < farthest_m &&
          std::abs(bodies[index].X_WB.p.y - X_WS.p.y) < farthest_m))
      continue;
    const BodyId id = engine.body_at(index);
    const BodyName name = engine.name(id);
    const model::Collision* const skin = ball_of(name);
    if (!skin || name.instance == robot) continue;
    const Vec3 at = inverse(X_WS) * (bodies[index].X_WB * skin->X_LC.p);
    const double distance = math::hypot(at.x, at.y);
    if (distance > spec.reach_m || std::abs(math::atan2(at.y, at.x)) > spec.opening_rad / 2) continue;
    if (!planar && std::abs(at.z) > std::get<Sphere>(skin->shape).radius_m) continue;
    if (name.instance == state.instance && name.link->name == state.link) {
      ball = id;
      kept = true;
      break;
    }
    // Names and not indices decide between equals: a restored world may count them out differently.
    const bool nearer = distance < nearest ||
                        (distance == nearest && name.instance < engine.name(best).instance);
    if (!nearer) continue;
    nearest = distance;
    best = id;
  }
  if (kept) return;
  if (holds()) {
    ++state.losses;
    state.instance.clear();
    state.link.clear();
  }
  ball = best;
  if (nearest == std::numeric_limits<double>::infinity()) return;
  ++state.grips;
  const BodyName name = engine.name(best);
  state.instance = name.instance;
  state.link = name.link->name;
}

void BallHandler::actuate(PoolView<BallHandler> pool, const Context& context) {
  for (const std::uint32_t index : pool.due) {
    BallHandler& handler = pool.all[index];
    State& state = handler.state;
    if (handler.command->count != state.taken) {
      state.taken = handler.command->count;
      const double strength = handler.command->message.data;
      state.strength = strength > 0 ? std::min(strength, 1.0) : 0;  // not a number: released
    }
    state.impulse_Ns = 0;
    if (state.strength > 0) handler.find_ball(context.engine);
    else if (handler.holds()) state.instance.clear(), state.link.clear();
  }
}

void BallHandler::pull(const Context& context, double h_s) {
  const Engine& engine = context.engine;
  const std::array indices{body.index, ball.index};
  std::array<BodyState, 2> states;
  engine.states_of(indices, states);
  const BodyState &carrier = states[0], &held = states[1];
  const model::Link& link = *engine.name(ball).link;
  const model::Collision& skin = link.collisions.front();
  const Vec3 p = held.X_WB * skin.X_LC.p;
  const Vec3 hold_W = carrier.X_WB * X_LS * Vec3{spec.hold_distance_m, 0, 0};
  const Vec3 wanted = level(velocity_at(carrier, p) - (p - hold_W) / settling_s);
  const Vec3 v = level(velocity_at(held, p));
  const double mass_kg = link.inertial.mass_kg, most_N = state.strength * spec.max_force_N;
  const Vec3 force_N = at_most((wanted - v) * (gain * mass_kg / h_s), most_N);
  // Without height the ball's spin is unknown, and follows its way.
  const double radius_m = std::get<Sphere>(skin.shape).radius_m;
  const auto roll = [&](Vec3 velocity) { return cross(Vec3{0, 0, 1}, velocity) / radius_m; };
  const Vec3 missing = planar ? Vec3{} : level(roll(v) - held.V_WB.angular);
  const Vec3 torque_Nm = at_most(link.inertial.moments.x * (roll(force_N) / mass_kg + missing * (gain / h_s)),
                                 most_N * radius_m);
  state.impulse_Ns += norm(force_N) * h_s;
  context.actuation.wrenches.push_back(
      {ball, force_N, torque_Nm + cross(p - centre_of_mass(engine, ball, held.X_WB), force_N)});
  context.actuation.wrenches.push_back(
      {body, -force_N, -torque_Nm - cross(p - centre_of_mass(engine, body, carrier.X_WB), force_N)});
}

void BallHandler::pre_substep(PoolView<BallHandler> pool, const Context& context, double h_s) {
  for (const std::uint32_t index : pool.due)
    if (BallHandler& handler = pool.all[index]; handler.holds()) handler.pull(context, h_s);
}

void BallHandler::sense(PoolView<BallHandler> pool, const Context& context) {
  for (const std::uint32_t index : pool.due) {
    BallHandler& handler = pool.all[index];
    State& state = handler.state;
    state.force_N = state.impulse_Ns / context.tick.s();
    msg::BallHandlerState& message = handler.hold->message;
    message.engaged = handler.holds();
    message.force = state.force_N;
    message.grips = state.grips;
    message.losses = state.losses;
    message.object = state.instance;
    handler.hold->publish(context.now);
  }
}

namespace {
constexpr LevelInfo levels[] = {
    {"hold", msg::BallHandlerState::ros_type, msg::Float64::ros_type,
     "Holds a ball with the commanded strength and lets it roll; reports what is held."},
};
}  // namespace

constinit const Kind kind = make_kind<BallHandler>({
    .name = "ball_handler",
    .help = "Driven wheels that hold a ball in front of a robot while it rolls on, up to a largest force.",
    .levels = levels,
});

}  // namespace sandlot::ball_handler
