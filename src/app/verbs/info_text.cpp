#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>

#include "app/verbs/info.h"
#include "base/text.h"
#include "geometry/height_grid.h"
#include "geometry/mesh.h"
#include "model/substance.h"
#include "sim/load/device_settings.h"

namespace sandlot::app {
namespace {

/// Number for people: 0.3 for 0.30000000000000004.
std::string rounded(double x) { return fmt::format("{:.6g}", x); }

std::string numbers(Vec3 v) { return fmt::format("{:.4g} {:.4g} {:.4g}", v.x + 0.0, v.y + 0.0, v.z + 0.0); }

/// "1.6 4.65 0" and, when it is turned, "turned 0 0 1.571" (roll pitch yaw).
std::string pose_text(const Pose& X) {
  const auto clean = [](double x) { return std::abs(x) < 1e-9 ? 0.0 : x; };
  const Vec3 rpy = rpy_from_quat(X.q);
  std::string out = numbers({clean(X.p.x), clean(X.p.y), clean(X.p.z)});
  if (std::abs(rpy.x) > 1e-9 || std::abs(rpy.y) > 1e-9 || std::abs(rpy.z) > 1e-9)
    out += " turned " + numbers({clean(rpy.x), clean(rpy.y), clean(rpy.z)});
  return out;
}

std::string joined(const std::vector<std::string>& words, const char* between) {
  std::string out;
  for (const std::string& word : words) out += (out.empty() ? "" : between) + word;
  return out;
}

std::string counted(std::size_t n, const std::string& what, const std::string& plural = "") {
  return fmt::format("{} {}", n, n == 1 ? what : plural.empty() ? what + "s" : plural);
}

struct ShapeText {
  std::string operator()(const Box& s) const {
    return fmt::format("box {:.4g} x {:.4g} x {:.4g}", s.size_m.x, s.size_m.y, s.size_m.z);
  }
  std::string operator()(const Sphere& s) const { return fmt::format("sphere r {:.4g}", s.radius_m); }
  std::string operator()(const Plane& s) const {
    return s.normal == Vec3{0, 0, 1} ? "plane" : "plane facing " + numbers(s.normal);
  }
  std::string operator()(const Ellipsoid& s) const { return "ellipsoid r " + numbers(s.radii_m); }
  std::string operator()(const Mesh& s) const {
    const Vec3 size = bounds_of(Shape(s)).size();
    return fmt::format("mesh of {} triangles, {:.4g} x {:.4g} x {:.4g}", s.mesh->triangles.size(), size.x,
                       size.y, size.z);
  }
  std::string operator()(const Heightfield& s) const {
    const Vec3 size = bounds_of(Shape(s)).size();
    return fmt::format("terrain {:.4g} x {:.4g}, {:.4g} high, {} x {} samples", size.x, size.y, size.z,
                       s.grid->columns, s.grid->rows);
  }
  template <class Round>
  std::string operator()(const Round& s) const {
    return fmt::format("{} r {:.4g} l {:.4g}", shape_name(Shape(s)), s.radius_m, s.length_m);
  }
};

/// At most `few` shapes one by one, more as "23 boxes, 2 cylinders".
std::string shapes_text(const std::vector<model::Collision>& collisions, std::size_t few) {
  std::vector<std::string> words;
  if (collisions.size() <= few) {
    for (const model::Collision& c : collisions) words.push_back(std::visit(ShapeText{}, c.shape));
    return words.empty() ? "no collision" : joined(words, ", ");
  }
  std::array<std::size_t, std::variant_size_v<Shape>> count{};
  std::array<const char*, std::variant_size_v<Shape>> name{};
  for (const model::Collision& c : collisions)
    ++count[c.shape.index()], name[c.shape.index()] = shape_name(c.shape);
  for (std::size_t i = 0; i < count.size(); ++i)
    if (count[i] > 0)
      words.push_back(counted(count[i], name[i], std::string(name[i]) == "box" ? "boxes" : ""));
  return joined(words, ", ");
}

/// Rows whose columns are aligned; the last column is as long as it is.
class Table {
 public:
  void add(std::vector<std::string> cells) { rows_.push_back(std::move(cells)); }
  /// A line of its own below the last row.
  void below(std::string line) { rows_.push_back({std::string(1, '\0') + std::move(line)}); }
  std::string text(const std::string& indent) const {
    std::vector<std::size_t> width;
    for (const auto& row : rows_)
      for (std::size_t i = 0; i + 1 < row.size(); ++i) {
        if (width.size() <= i) width.resize(i + 1, 0);
        // One very long cell does not widen the column of all rows.
        width[i] = std::max(width[i], std::min<std::size_t>(row[i].size(), 48));
      }
    std::string out;
    for (const auto& row : rows_) {
      std::string line = indent;
      if (row.size() == 1 && !row[0].empty() && row[0][0] == '\0') {
        line += row[0].substr(1);
      } else {
        for (std::size_t i = 0; i < row.size(); ++i)
          line += i + 1 < row.size() ? fmt::format("{:<{}}  ", row[i], width[i]) : row[i];
      }
      while (!line.empty() && line.back() == ' ') line.pop_back();
      out += line + "\n";
    }
    return out;
  }

 private:
  std::vector<std::vector<std::string>> rows_;
};

std::string limits_text(const model::Joint& joint) {
  std::vector<std::string> words;
  const bool slides = joint.type == model::JointType::prismatic;
  const bool many = joint.type == model::JointType::ball || joint.type == model::JointType::fixed;
  if (!many && (joint.lower > -1e15 || joint.upper < 1e15))
    words.push_back(fmt::format("{:.4g} .. {:.4g} {}", joint.lower, joint.upper, slides ? "m" : "rad"));
  if (joint.max_effort < 1e15)
    words.push_back(fmt::format("at most {:.4g} {}", joint.max_effort, slides ? "N" : "Nm"));
  if (joint.max_velocity < 1e15)
    words.push_back(fmt::format("at most {:.4g} {}", joint.max_velocity, slides ? "m/s" : "rad/s"));
  if (joint.damping > 0) words.push_back(fmt::format("damping {:.4g}", joint.damping));
  if (joint.friction > 0) words.push_back(fmt::format("friction {:.4g}", joint.friction));
  if (joint.spring_stiffness > 0) words.push_back(fmt::format("spring {:.4g}", joint.spring_stiffness));
  if (joint.type == model::JointType::screw)
    words.push_back(fmt::format("{:.4g} m per turn", joint.thread_pitch_m));
  return joined(words, ", ");
}

/// Origin of a device: element of the file, its name there where that differs, and place. Places are left out
/// when objects are compared.
std::string origin_text(const model::DeviceDecl& decl, const std::string& address, bool places) {
  std::string out;
  if (!decl.sdf_types.empty()) out = "from " + decl.sdf_types.front() + " \"" + decl.name + "\"";
  else if (decl.name != address) out = "in the file: \"" + decl.name + "\"";
  if (places && decl.place.file) out += (out.empty() ? "" : " at ") + to_string(decl.place);
  return out;
}

struct Shown {
  std::string name;  ///< of the robot in addresses
  bool places = true;
};

std::string slot_text(const std::string& topic, const model::Instance& instance, const std::string& shown) {
  const std::string own = "/" + instance.name + "/";
  return starts_with(topic, own) ? "/" + shown + "/" + topic.substr(own.size()) : topic;
}

std::string topic_text(const TopicBase& topic, const model::Instance& instance, const std::string& shown) {
  return slot_text(topic.name(), instance, shown);
}

/// The common keys of a device: "mass 4.5 kg, delay 0.035 s".
std::string keys_text(const Simulation::Device& device) {
  if (!device.keys) return "";
  const DeviceKeysSpec& spec = device.keys->spec;
  std::vector<std::string> out;
  if (spec.mass_kg > 0) out.push_back(fmt::format("mass {:.4g} kg", spec.mass_kg));
  if (spec.max_rate_hz > 0) out.push_back(fmt::format("at most {:.4g} Hz", spec.max_rate_hz));
  if (spec.delay_s > 0) out.push_back(fmt::format("delay {:.4g} s", spec.delay_s));
  if (spec.command_errors) out.emplace_back("errors of commands");
  if (spec.energy.drain_W > 0) out.push_back(fmt::format("drain {:.4g} W", spec.energy.drain_W));
  if (spec.energy.per_use_J > 0) out.push_back(fmt::format("{:.4g} J per use", spec.energy.per_use_J));
  if (spec.errors != 1) out.push_back(fmt::format("errors {:.4g}", spec.errors));
  return joined(out, ", ");
}

std::string queue_text(const TopicBase& slot) {
  return slot.queue_limit() > 0 ? fmt::format(", up to {} waiting", slot.queue_limit()) : "";
}

void add_links(const model::Model& model, Table& table) {
  for (const model::Link& link : model.links) {
    table.add({"link", link.name, model.is_static ? "" : fmt::format("{:.4g} kg", link.inertial.mass_kg),
               link.visuals.empty() ? "" : counted(link.visuals.size(), "visual"),
               shapes_text(link.collisions, 8)});
  }
}

void add_joints(const model::Model& model, Table& table) {
  for (const model::Joint& joint : model.joints) {
    const bool axis = joint.type != model::JointType::fixed && joint.type != model::JointType::ball;
    std::string axes = axis ? "axis " + numbers(joint.axis_J) : "";
    if (joint.second) axes += " and " + numbers(joint.second->axis_J);
    std::string more = limits_text(joint);
    if (joint.mimic)
      more += fmt::format("{}follows {:.4g} x {}", more.empty() ? "" : ", ", joint.mimic->multiplier,
                          model.joints[joint.mimic->joint].name);
    table.add({"joint", joint.name, sandlot::name_of(joint.type),
               (joint.parent == model::world_link ? "world" : model.links[joint.parent].name) + " -> " +
                   model.links[joint.child].name,
               axes, more});
  }
}

/// Each device with its topics below it.
void add_devices(const Simulation& simulation, const Simulation::Entity& entity, const Shown& shown,
                 Table& table) {
  const auto views = simulation.devices(entity.instance.name);
  std::size_t width = 0;
  for (const Simulation::DeviceView& view : views)
    for (const auto* list : {&view.topics, &view.commands})
      for (const TopicBase* topic : *list)
        width = std::max(width, topic_text(*topic, entity.instance, shown.name).size());
  for (std::size_t i = 0; i < views.size(); ++i) {
    const Simulation::DeviceView& view = views[i];
    const model::DeviceDecl& decl = entity.devices[i]->decl;
    const std::string name = view.path.substr(entity.instance.name.size() + 1);
    const auto rate = setting(decl, "rate");
    table.add({"device", shown.name + "/" + name, view.kind, "level " + joined(view.active_levels, ", "),
               rate && *rate > 0 ? fmt::format("{:.4g} Hz", *rate) : "",
               "on " + entity.instance.model->links[decl.link].name, origin_text(decl, name, shown.places)});
    if (const std::string keys = keys_text(*entity.devices[i]); !keys.empty())
      table.below("  has        " + keys);
    for (const TopicBase* topic : view.topics)
      table.below(fmt::format("  publishes  {:<{}}  {}", topic_text(*topic, entity.instance, shown.name),
                              width, topic->type()));
    for (const TopicBase* slot : view.commands)
      table.below(fmt::format("  takes      {:<{}}  {}{}", topic_text(*slot, entity.instance, shown.name),
                              width, slot->type(), queue_text(*slot)));
    for (const DeviceService& service : simulation.kind(*entity.devices[i]).services)
      table.below(fmt::format("  offers     {:<{}}  {}", "/" + shown.name + "/" + name + "/" + service.name,
                              width, service.type));
    for (const DeviceOrder* order : view.orders)
      table.below(fmt::format("  orders     {:<{}}  {}",
                              slot_text(order->slot(), entity.instance, shown.name), width, order->type()));
  }
}

/// Parts of an object, without its own line. Objects with the same text under the name "*" and without places
/// are alike.
std::string parts_text(const Simulation& simulation, const Simulation::Entity& entity, const Shown& shown) {
  const model::Instance& instance = entity.instance;
  const model::Model& model = *instance.model;
  Table links, joints, others, devices;
  add_links(model, links);
  add_joints(model, joints);
  for (const model::Frame& frame : model.frames)
    others.add({"frame", frame.name, "on " + model.links[frame.link].name, "at " + pose_text(frame.X_LF)});
  for (const model::LinkLight& light : model.lights)
    others.add({"light", light.light.name, "on " + model.links[light.link].name,
                std::string(sandlot::name_of(light.light.type)) + " at " + pose_text(light.light.X_PLight)});
  add_devices(simulation, entity, shown, devices);
  for (const model::ControllerDecl& controller : instance.controllers)
    others.add({"controller", controller.name, controller.kind,
                shown.places && controller.place.file ? to_string(controller.place) : ""});
  if (instance.motion)
    others.add({"path", counted(instance.motion->keys.size(), "key"),
                fmt::format("{:.4g} s", instance.motion->keys.back().time_s),
                instance.motion->loop ? "again and again" : "once"});
  return links.text("  ") + joints.text("  ") + devices.text("  ") + others.text("  ");
}

double mass_of(const model::Model& model) {
  double mass = 0;
  for (const model::Link& link : model.links) mass += link.inertial.mass_kg;
  return mass;
}

struct Group {
  std::vector<const Simulation::Entity*> members;
};

/// Properties that are not printed but make two objects different.
void add_config(const Node& node, std::string& out) {
  out += node.text() + "(";
  for (const Node& item : node.items()) add_config(item, out);
  for (const Node::Entry& entry : node.entries()) {
    out += entry.key + "=";
    add_config(entry.value, out);
  }
  out += ")";
}
std::string hidden_text(const model::Instance& instance) {
  std::string out;
  const auto add = [&](auto... values) { ((out += number_text(values) + " "), ...); };
  const auto add_pose = [&](const Pose& X) { add(X.p.x, X.p.y, X.p.z, X.q.w, X.q.x, X.q.y, X.q.z); };
  for (const model::Link& link : instance.model->links) {
    const model::Inertial& i = link.inertial;
    add_pose(link.X_ML);
    add_pose(i.X_LCo);
    add(i.mass_kg, i.moments.x, i.moments.y, i.moments.z, i.products.x, i.products.y, i.products.z);
    for (const model::Collision& c : link.collisions) {
      add_pose(c.X_LC);
      const model::Surface& s = c.surface;
      add(s.mu, s.mu2, s.slip1, s.slip2, s.restitution, s.stiffness_N_per_m.value_or(0),
          s.damping_N_s_per_m.value_or(0), s.rolling_resistance_m, s.belt_velocity_mps.x,
          s.belt_velocity_mps.y, s.belt_velocity_mps.z, s.touches);
      if (s.substance) out += model::text_of(*s.substance) + " ";
      if (s.skin) add(s.skin->axis.x, s.skin->axis.y, s.skin->axis.z, s.skin->ratio);
      out += std::visit(ShapeText{}, c.shape);
    }
  }
  for (const model::Joint& joint : instance.model->joints) add_pose(joint.X_CJ);
  for (const model::DeviceDecl& device : instance.devices) {
    add_pose(device.X_LS);
    add_config(device.config, out);
  }
  for (const model::ControllerDecl& controller : instance.controllers) add_config(controller.config, out);
  return out;
}

/// Groups of objects that differ in name and pose alone, in the order of their first members.
std::vector<Group> groups_of(const Simulation& simulation) {
  std::vector<Group> groups;
  std::map<std::string, std::size_t> known;
  for (const auto& entity : simulation.entities()) {
    const model::Instance& instance = entity->instance;
    const std::string key = std::string(role_of(instance)) + "\n" + instance.team + "\n" +
                            parts_text(simulation, *entity, {"*", false}) + hidden_text(instance);
    const auto [entry, fresh] = known.try_emplace(key, groups.size());
    if (fresh) groups.push_back({});
    groups[entry->second].members.push_back(entity.get());
  }
  return groups;
}

/// "box1", or "box1 .. box500 (500 of model box)"; a few that fit are named one by one.
std::string names_of(const Group& group) {
  const model::Instance& first = group.members.front()->instance;
  if (group.members.size() == 1)
    return first.name +
           (first.original_name == first.name ? "" : " (in the file: \"" + first.original_name + "\")");
  std::vector<std::string> names;
  for (const Simulation::Entity* member : group.members) names.push_back(member->instance.name);
  std::string all = joined({names.begin(), names.begin() + std::min<std::ptrdiff_t>(4, std::ssize(names))},
                           ", ");
  if (names.size() > 4 || all.size() > 40) all = names.front() + " .. " + names.back();
  const bool one_model = std::all_of(group.members.begin(), group.members.end(), [&](const auto* e) {
    return e->instance.model->name == first.model->name;
  });
  return all + (one_model ? fmt::format(" ({} of model {})", names.size(), first.model->name)
                          : fmt::format(" ({} alike)", names.size()));
}

/// One link, and nothing on it.
bool is_simple(const Simulation::Entity& entity) {
  const model::Model& model = *entity.instance.model;
  return model.links.size() == 1 && model.joints.empty() && model.frames.empty() && model.lights.empty() &&
         entity.devices.empty() && entity.programs.empty() && !entity.instance.motion;
}

std::string where_text(const Group& group) {
  return group.members.size() == 1 ? "at " + pose_text(group.members.front()->instance.X_WM) : "";
}

std::string head_text(const std::string& file, const Simulation& simulation) {
  const model::Setup& setup = simulation.setup();
  const Overview o = overview_of(simulation);
  std::string out = setup.name + "  " + file + "\n";
  const model::Clock& clock = setup.clock;
  const std::string steps = clock.mode == model::Clock::Mode::continuous
                                ? fmt::format(
                                      "continuous clock, steps of {} to {} s in sub-steps of at most {} s",
                                      rounded(clock.min_step.s()), rounded(clock.max_step.s()),
                                      rounded(setup.step.s() / setup.substeps))
                                : fmt::format("step {} s in {}", rounded(setup.step.s()),
                                              counted(static_cast<std::size_t>(setup.substeps), "sub-step"));
  for (const auto& [list, declared] :
       {std::pair("media", &setup.media), {"rules", &setup.rules}, {"markers", &setup.markers}}) {
    if (declared->empty()) continue;
    std::vector<std::string> names;
    for (const model::ElementDecl& each : *declared)
      names.push_back(each.name == each.kind ? each.name : each.name + " (" + each.kind + ")");
    out += fmt::format("  {}: {}\n", list, joined(names, ", "));
  }
  out += fmt::format("  {} physics, {}, control every {}, seed {}{}\n", setup.engine, steps,
                     counted(static_cast<std::size_t>(setup.control_interval), "tick"), setup.seed,
                     setup.stop ? ", ends at " + number_text(setup.stop->s()) + " s" : "");
  std::vector<std::string> things;
  const auto add = [&](int n, const char* what, const char* plural) {
    if (n > 0) things.push_back(counted(static_cast<std::size_t>(n), what, plural));
  };
  add(o.robots, "robot", "robots");
  add(o.objects, "object", "objects");
  add(o.actors, "actor", "actors");
  add(o.statics, "static thing", "static things");
  out += fmt::format("  {}; {:.4g} kg move; gravity {}\n", things.empty() ? "nothing" : joined(things, ", "),
                     o.moving_mass_kg, numbers(setup.gravity));
  if (!o.bounds.empty()) {
    const Vec3 size = o.bounds.size();
    out += fmt::format("  {:.4g} x {:.4g} x {:.4g} m, from {} to {}{}\n", size.x, size.y, size.z,
                       numbers(o.bounds.low), numbers(o.bounds.high),
                       o.endless_ground ? ", on endless ground" : "");
  }
  return out;
}

}  // namespace

std::string info_text(const std::string& file, const Simulation& simulation, const Diagnostics& diagnostics) {
  std::string out = head_text(file, simulation);
  const std::vector<Group> groups = groups_of(simulation);
  Table simple;
  bool any = false;
  for (const Group& group : groups) {
    const Simulation::Entity& first = *group.members.front();
    if (!is_simple(first)) continue;
    const model::Link& link = first.instance.model->links[0];
    any = true;
    simple.add({role_of(first.instance), names_of(group),
                first.instance.model->is_static ? "" : fmt::format("{:.4g} kg", link.inertial.mass_kg),
                shapes_text(link.collisions, 2), where_text(group)});
  }
  Table lights;
  for (const model::Light& light : simulation.setup().lights)
    lights.add({"light", light.name, sandlot::name_of(light.type), "at " + pose_text(light.X_PLight)});
  if (any) out += "\n" + simple.text("");
  const std::string light_text = lights.text("");
  if (!light_text.empty()) out += "\n" + light_text;
  for (const Group& group : groups) {
    const Simulation::Entity& first = *group.members.front();
    if (is_simple(first)) continue;
    const model::Instance& instance = first.instance;
    out += fmt::format("\n{} {}", role_of(instance), names_of(group));
    if (!instance.team.empty()) out += ", team " + instance.team;
    if (!instance.model->is_static) out += fmt::format(", {:.4g} kg", mass_of(*instance.model));
    if (const std::string where = where_text(group); !where.empty()) out += ", " + where;
    if (instance.model->place.file) out += ", model of " + to_string(instance.model->place);
    out += "\n" + parts_text(simulation, first, {group.members.size() == 1 ? instance.name : "*", true});
  }
  for (const model::TeamDecl& team : simulation.setup().teams) {
    out += "\nteam " + team.name + "\n";
    Table controllers;
    for (const model::ControllerDecl& controller : team.controllers.get())
      controllers.add({"controller", controller.name, controller.kind,
                       controller.place.file ? to_string(controller.place) : ""});
    out += controllers.text("  ");
  }
  if (!diagnostics.warnings.empty()) {
    out += "\n" + counted(diagnostics.warnings.size(), "warning") + "\n";
    for (const Error& warning : diagnostics.warnings) out += "  " + warning.text() + "\n";
  }
  return out;
}

}  // namespace sandlot::app
