#include "devices/inertial/altimeter/altimeter.h"

#include "devices/sdf_noise.h"

namespace sandlot::altimeter {
namespace {

Result<Node> from_sdf(const Node& element, Diagnostics& diagnostics) {
  using namespace sdf_element;
  Node config = Node::map(element.place());
  copy_rate(element, "update_rate", config);
  const Node* const own = find(element, "altimeter");
  if (!own || !own->is_map()) return config;
  warn_unknown(*own, {"vertical_position", "vertical_velocity", "topic"}, "<altimeter>", diagnostics);
  for (const auto& [path, key] :
       {std::pair{"vertical_position/noise", "position"}, std::pair{"vertical_velocity/noise", "velocity"}}) {
    const Node* const noise = find(*own, path);
    if (!noise) continue;
    SL_ASSIGN(Node errors, channel_noise(*noise, diagnostics));
    if (!errors.entries().empty()) config.set(key, std::move(errors));
  }
  return config;
}

}  // namespace

Result<Altimeter> Altimeter::create(const DeviceBuild& build, Spec spec) {
  Altimeter a{spec};
  a.key = build.key;
  a.body = build.body().index;
  a.p_LS = build.decl.X_LS.p;
  const model::Link& link = build.instance.model->links[build.decl.link];
  a.state.reference_m = (build.instance.X_WM * link.X_ML * a.p_LS).z;
  Stream random(build.seed, build.key, Purpose::initial, 0);
  a.state.position.reset(spec.position, random, "position");
  a.state.velocity.reset(spec.velocity, random, "velocity");
  a.height = build.publish<msg::Altimeter>(0, "height");
  a.height->message.header.frame_id = build.frame_id();
  return a;
}

void Altimeter::sense(PoolView<Altimeter> pool, const Context& context) {
  const auto states = context.engine.states();
  for (const std::uint32_t index : pool.due) {
    Altimeter& a = pool.all[index];
    const BodyState& body = states[a.body];
    const Vec3 arm = rotate(body.X_WB.q, a.p_LS);
    Stream random(context.seed, a.key, Purpose::noise, pool.sample[index]);
    const double dt_s = pool.since[index].s();
    msg::Altimeter& message = a.height->message;
    message.vertical_reference = a.state.reference_m;
    message.vertical_position = a.state.position.corrupt(
        a.spec.position, body.X_WB.p.z + arm.z - a.state.reference_m, dt_s, random, a.spec.errors);
    message.vertical_velocity = a.state.velocity.corrupt(
        a.spec.velocity, body.V_WB.linear.z + cross(body.V_WB.angular, arm).z, dt_s, random, a.spec.errors);
    a.height->publish(context.now);
  }
}

namespace {
constexpr LevelInfo levels[] = {
    {"height", msg::Altimeter::ros_type, "", "Height above the start and vertical velocity."},
};
constexpr const char* sdf_types[] = {"sensor:altimeter"};
}  // namespace

constinit const Kind kind = make_kind<Altimeter>({
    .name = "altimeter",
    .help = "Height above the start and vertical velocity.",
    .levels = levels,
    .sdf_types = sdf_types,
    .from_sdf = from_sdf,
    .sdf_note = "topic names",
});

}  // namespace sandlot::altimeter
