#include <nlohmann/json.hpp>

#include "app/verbs/info.h"
#include "geometry/height_grid.h"
#include "geometry/mesh.h"
#include "sim/load/device_settings.h"

namespace sandlot::app {
namespace {

using Json = nlohmann::ordered_json;

Json of(Vec3 v) { return {v.x, v.y, v.z}; }
Json of(const Pose& X) { return {{"position", of(X.p)}, {"orientation_wxyz", {X.q.w, X.q.x, X.q.y, X.q.z}}}; }
Json of(const Color& c) { return {c.r, c.g, c.b, c.a}; }
Json of(const Place& place) {
  if (!place.file) return nullptr;
  return {{"file", *place.file}, {"line", place.line}};
}
Json of(const Bounds& b) {
  if (b.empty()) return nullptr;
  return {{"low", of(b.low)}, {"high", of(b.high)}};
}

struct ShapeJson {
  Json& out;
  void operator()(const Box& s) const { out["size_m"] = of(s.size_m); }
  void operator()(const Sphere& s) const { out["radius_m"] = s.radius_m; }
  void operator()(const Plane& s) const { out["normal"] = of(s.normal); }
  void operator()(const Ellipsoid& s) const { out["radii_m"] = of(s.radii_m); }
  void operator()(const Mesh& s) const {
    out["triangles"] = s.mesh->triangles.size();
    out["size_m"] = of(bounds_of(Shape(s)).size());
    out["source"] = s.mesh->source;
  }
  void operator()(const Heightfield& s) const {
    out["samples"] = {s.grid->columns, s.grid->rows};
    out["size_m"] = of(bounds_of(Shape(s)).size());
    out["source"] = s.grid->source;
  }
  template <class Round>
  void operator()(const Round& s) const {
    out["radius_m"] = s.radius_m;
    out["length_m"] = s.length_m;
  }
};

Json of(const model::Link& link) {
  Json collisions = Json::array();
  for (const model::Collision& c : link.collisions) {
    Json one{{"name", c.name}, {"shape", shape_name(c.shape)}, {"pose", of(c.X_LC)}};
    std::visit(ShapeJson{one}, c.shape);
    collisions.push_back(std::move(one));
  }
  return {{"name", link.name},
          {"pose", of(link.X_ML)},
          {"mass_kg", link.inertial.mass_kg},
          {"centre_of_mass", of(link.inertial.X_LCo.p)},
          {"moments_kg_m2", of(link.inertial.moments)},
          {"products_kg_m2", of(link.inertial.products)},
          {"collisions", collisions},
          {"visuals", link.visuals.size()},
          {"place", of(link.place)}};
}

Json of(const model::Joint& joint, const model::Model& model) {
  Json out{{"name", joint.name},
           {"type", sandlot::name_of(joint.type)},
           {"parent", joint.parent == model::world_link ? "world" : model.links[joint.parent].name},
           {"child", model.links[joint.child].name},
           {"axis", of(joint.axis_J)}};
  const auto limit = [&](const char* key, double value) {
    out[key] = std::abs(value) < 1e15 ? Json(value) : Json(nullptr);
  };
  limit("lower", joint.lower);
  limit("upper", joint.upper);
  limit("max_effort", joint.max_effort);
  limit("max_velocity", joint.max_velocity);
  out["damping"] = joint.damping;
  out["friction"] = joint.friction;
  out["spring_stiffness"] = joint.spring_stiffness;
  if (joint.second) out["second_axis"] = of(joint.second->axis_J);
  if (joint.type == model::JointType::screw) out["thread_pitch_m"] = joint.thread_pitch_m;
  if (joint.mimic)
    out["mimic"] = {{"joint", model.joints[joint.mimic->joint].name},
                    {"multiplier", joint.mimic->multiplier},
                    {"offset", joint.mimic->offset}};
  out["place"] = of(joint.place);
  return out;
}

Json of(const model::Light& light) {
  return {{"name", light.name},
          {"type", sandlot::name_of(light.type)},
          {"pose", of(light.X_PLight)},
          {"color", of(light.color)},
          {"cast_shadows", light.cast_shadows}};
}

Json of(const Simulation::DeviceView& view, const Simulation::Device& device, const Kind& kind,
        const model::Model& model) {
  const model::DeviceDecl& decl = device.decl;
  Json topics = Json::object(), commands = Json::object(), orders = Json::object();
  for (const TopicBase* topic : view.topics) topics[topic->name()] = topic->type();
  for (const TopicBase* slot : view.commands) commands[slot->name()] = slot->type();
  for (const DeviceOrder* order : view.orders) orders[order->slot()] = order->type();
  const auto rate_hz = setting(decl, "rate");
  Json out{{"path", view.path},
           {"original_name", decl.name},
           {"kind", view.kind},
           {"link", model.links[decl.link].name},
           {"pose", of(decl.X_LS)},
           {"levels", view.active_levels},
           {"rate_hz", rate_hz ? Json(*rate_hz) : Json(nullptr)},
           {"topics", topics},
           {"commands", commands},
           {"orders", orders},
           {"mapped_from", decl.sdf_types},
           {"place", of(decl.place)}};
  if (device.keys) {
    const DeviceKeysSpec& keys = device.keys->spec;
    out["mass_kg"] = keys.mass_kg;
    out["max_rate_hz"] = keys.max_rate_hz;
    out["delay_s"] = keys.delay_s;
    out["command_errors"] = keys.command_errors.has_value();
    out["drain_W"] = keys.energy.drain_W;
    out["drain_per_use_J"] = keys.energy.per_use_J;
  }
  if (!kind.services.empty()) {
    Json& services = out["services"] = Json::object();
    for (const DeviceService& service : kind.services)
      services["/" + view.path + "/" + service.name] = service.type;
  }
  return out;
}

}  // namespace

Json info_json(const Simulation& simulation, const Diagnostics& diagnostics) {
  const model::Setup& setup = simulation.setup();
  const Overview overview = overview_of(simulation);
  Json root{{"name", setup.name},
            {"physics", setup.engine},
            {"step_s", setup.step.s()},
            {"substeps", setup.substeps},
            {"control_interval", setup.control_interval},
            {"seed", setup.seed},
            {"gravity_mps2", of(setup.gravity)},
            {"robots", overview.robots},
            {"moving_mass_kg", overview.moving_mass_kg},
            {"bounds", of(overview.bounds)},
            {"endless_ground", overview.endless_ground}};
  for (const auto& [list, declared] :
       {std::pair("media", &setup.media), {"rules", &setup.rules}, {"markers", &setup.markers}})
    for (const model::ElementDecl& each : *declared)
      root[list].push_back({{"name", each.name}, {"kind", each.kind}});
  if (setup.clock.mode == model::Clock::Mode::continuous)
    root["clock"] = {{"min_step_s", setup.clock.min_step.s()}, {"max_step_s", setup.clock.max_step.s()}};
  root["stop_s"] = setup.stop ? Json(setup.stop->s()) : Json(nullptr);
  Json& lights = root["lights"] = Json::array();
  for (const model::Light& light : setup.lights) lights.push_back(of(light));
  Json& instances = root["instances"] = Json::array();
  for (const auto& entity : simulation.entities()) {
    const model::Instance& instance = entity->instance;
    const model::Model& model = *instance.model;
    Json entry{{"name", instance.name},      {"original_name", instance.original_name},
               {"model", model.name},        {"role", role_of(instance)},
               {"robot", instance.is_robot}, {"static", model.is_static},
               {"team", instance.team},      {"pose", of(instance.X_WM)},
               {"place", of(instance.place)}};
    Json links = Json::array(), joints = Json::array(), frames = Json::array(), link_lights = Json::array(),
         devices = Json::array(), controllers = Json::array();
    for (const model::Link& link : model.links) links.push_back(of(link));
    for (const model::Joint& joint : model.joints) joints.push_back(of(joint, model));
    for (const model::Frame& frame : model.frames)
      frames.push_back(
          {{"name", frame.name}, {"link", model.links[frame.link].name}, {"pose", of(frame.X_LF)}});
    for (const model::LinkLight& light : model.lights) {
      link_lights.push_back(of(light.light));
      link_lights.back()["link"] = model.links[light.link].name;
    }
    const auto views = simulation.devices(instance.name);
    for (std::size_t i = 0; i < views.size(); ++i)
      devices.push_back(of(views[i], *entity->devices[i], simulation.kind(*entity->devices[i]), model));
    for (const model::ControllerDecl& controller : instance.controllers)
      controllers.push_back(
          {{"name", controller.name}, {"kind", controller.kind}, {"place", of(controller.place)}});
    entry["links"] = std::move(links);
    entry["joints"] = std::move(joints);
    entry["frames"] = std::move(frames);
    entry["lights"] = std::move(link_lights);
    entry["devices"] = std::move(devices);
    entry["controllers"] = std::move(controllers);
    if (instance.motion) entry["motion_keys"] = instance.motion->keys.size();
    instances.push_back(std::move(entry));
  }
  if (!simulation.setup().teams.empty()) root["teams"] = Json::array();
  for (const model::TeamDecl& team : simulation.setup().teams) {
    Json controllers = Json::array();
    for (const model::ControllerDecl& controller : team.controllers.get())
      controllers.push_back(
          {{"name", controller.name}, {"kind", controller.kind}, {"place", of(controller.place)}});
    root["teams"].push_back({{"name", team.name}, {"controllers", std::move(controllers)}});
  }
  Json& ignored = root["warnings"] = Json::array();
  for (const Error& warning : diagnostics.warnings)
    ignored.push_back({{"what", warning.what}, {"fix", warning.fix}, {"place", of(warning.place)}});
  return root;
}

}  // namespace sandlot::app
