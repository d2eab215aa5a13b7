#include "devices/touch/contact/contact.h"

#include <algorithm>

#include "base/text.h"
#include "devices/sdf_noise.h"

namespace sandlot::contact {
namespace {

void name_shape(const Engine& engine, BodyId body, std::uint32_t shape, std::string& out) {
  const BodyName name = engine.name(body);
  out.assign(name.instance);
  if (!name.link) return;
  out += "::";
  out += name.link->name;
  if (shape >= name.link->collisions.size()) return;
  out += "::";
  out += name.link->collisions[shape].name;
}

Result<Node> from_sdf(const Node& element, Diagnostics& diagnostics) {
  using namespace sdf_element;
  Node config = Node::map(element.place());
  copy_rate(element, "update_rate", config);
  const Node* const contact = find(element, "contact");
  if (!contact || !contact->is_map()) return config;
  warn_unknown(*contact, {"collision", "topic"}, "<contact>", diagnostics);
  const Node* const named = contact->find("collision");
  if (!named) return config;
  Node list = Node::sequence(named->place());
  const auto push = [&](const Node& one) {
    const std::string name = text(&one);
    if (!name.empty() && name != "__default_topic__") list.push(Node::scalar(name, one.place()));
  };
  if (named->is_sequence())
    for (const Node& one : named->items()) push(one);
  else push(*named);
  if (!list.items().empty()) config.set("collision", std::move(list));
  return config;
}

}  // namespace

int Sensor::side(const Contact& c) const {
  const auto mine = [&](BodyId id, std::uint32_t shape) {
    return id == body && (merged || shape >= feels.size() || feels[shape]);
  };
  return mine(c.b, c.shape_b) ? 1 : mine(c.a, c.shape_a) ? -1 : 0;
}

Result<Sensor> Sensor::create(const DeviceBuild& build, Spec spec) {
  const model::Link& link = build.instance.model->links[build.decl.link];
  if (spec.threshold_N > 0 && !build.engine.contact_forces)
    return build.error("threshold",
                       "the engine '" + std::string(build.engine.name) + "' tells no contact forces",
                       "leave the threshold out, or use the engine 'rigid'");
  Sensor sensor{std::move(spec)};
  sensor.merged = build.engine.planar;
  // The disc of the planar engine belongs to the canonical link.
  sensor.body = sensor.merged && !build.instance.model->is_static ? build.bodies.front() : build.body();
  sensor.feels.assign(link.collisions.size(), sensor.spec.collision.empty());
  for (const std::string& name : sensor.spec.collision) {
    // Files may give more than the last part of the name.
    const auto split_at = name.rfind("::");
    const std::string last = split_at == std::string::npos ? name : name.substr(split_at + 2);
    std::vector<std::string> known;
    bool found = false;
    for (std::size_t i = 0; i < link.collisions.size(); ++i) {
      known.push_back(link.collisions[i].name);
      if (known.back() != name && known.back() != last) continue;
      sensor.feels[i] = found = true;
    }
    if (!found)
      return build.error("collision",
                         "link '" + link.name + "' has no collision '" + name.substr(0, 60) + "'",
                         suggestion(last, known));
  }
  sensor.contacts = build.publish<msg::ContactsState>(contact::contacts, "contacts");
  sensor.contacts->message.header.frame_id = "world";
  sensor.bumper = build.publish<msg::Bool>(contact::bumper, "bumper");
  return sensor;
}

void Sensor::pre_substep(PoolView<Sensor> pool, const Context& context, double) {
  for (const std::uint32_t index : pool.due) context.actuation.watch.contacts.push_back(pool.all[index].body);
}

void Sensor::post_substep(PoolView<Sensor> pool, const Context& context, double) {
  for (const std::uint32_t index : pool.due) {
    Sensor& sensor = pool.all[index];
    if (!(pool.levels[index] >> contact::bumper & 1)) continue;
    bool touched = false;
    Vec3 force;
    for (const Contact& c : context.engine.contacts()) {
      const int side = sensor.side(c);
      if (side == 0) continue;
      touched = true;
      force += side * c.force_W;
    }
    const double threshold = sensor.spec.threshold_N;
    if (touched && dot(force, force) >= threshold * threshold) sensor.state.pressed = true;
  }
}

void Sensor::sense(PoolView<Sensor> pool, const Context& context) {
  for (const std::uint32_t index : pool.due) {
    Sensor& sensor = pool.all[index];
    if (pool.levels[index] >> contact::bumper & 1) {
      sensor.bumper->message.data = sensor.state.pressed;
      sensor.state.pressed = false;
      sensor.bumper->publish(context.now);
    }
    if (!(pool.levels[index] >> contact::contacts & 1)) continue;
    std::vector<msg::ContactState>& states = sensor.contacts->message.states;
    std::size_t used = 0;
    const Contact* previous = nullptr;
    for (const Contact& c : context.engine.contacts()) {
      const int side = sensor.side(c);
      if (side == 0) continue;
      // Contacts of one pair of shapes come one after the other.
      const bool same = previous && previous->a == c.a && previous->b == c.b &&
                        previous->shape_a == c.shape_a && previous->shape_b == c.shape_b;
      previous = &c;
      if (!same) {
        if (used == states.size()) states.emplace_back();
        msg::ContactState& fresh = states[used++];
        name_shape(context.engine, side > 0 ? c.b : c.a, side > 0 ? c.shape_b : c.shape_a,
                   fresh.collision1_name);
        name_shape(context.engine, side > 0 ? c.a : c.b, side > 0 ? c.shape_a : c.shape_b,
                   fresh.collision2_name);
        fresh.wrenches.clear();
        fresh.total_wrench = {};
        fresh.contact_positions.clear();
        fresh.contact_normals.clear();
        fresh.depths.clear();
      }
      msg::ContactState& state = states[used - 1];
      const Vec3 force = side * c.force_W;
      state.wrenches.push_back({force, {}});
      state.total_wrench.force += force;
      // About the first point: the torque that the others make.
      if (!state.contact_positions.empty())
        state.total_wrench.torque += cross(c.point_W - state.contact_positions.front(), force);
      state.contact_positions.push_back(c.point_W);
      state.contact_normals.push_back(side * c.normal_W);
      state.depths.push_back(c.depth_m);
    }
    states.resize(used);
    sensor.contacts->publish(context.now);
  }
}

namespace {
constexpr LevelInfo levels[] = {
    {"contacts", msg::ContactsState::ros_type, "", "Points, normals and forces of all contacts."},
    {"bumper", msg::Bool::ros_type, "", "Whether the bumper was pressed since the previous sample."},
};
constexpr const char* sdf_types[] = {"sensor:contact", "plugin:gazebo_ros_bumper"};
}  // namespace

constinit const Kind kind = make_kind<Sensor>({
    .name = "contact",
    .help = "Contact sensor and bumper: contacts of a link, their places and forces.",
    .levels = levels,
    .sdf_types = sdf_types,
    .from_sdf = from_sdf,
    .sdf_note = "topic and frame names",
});

}  // namespace sandlot::contact
