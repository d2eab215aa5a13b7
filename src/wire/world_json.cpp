#include <algorithm>
#include <cstring>
#include <set>

#include "base/field_json.h"
#include "base/text.h"
#include "kinematics/tree.h"
#include "sim/world/device_keys.h"
#include "wire/asset_table.h"

namespace sandlot::wire {
namespace {

using kinematics::KinematicTree;

/// Link or joint number; -1 for none.
void write_index(JsonWriter& w, std::uint32_t value) {
  if (value == KinematicTree::none) w.integer(-1);
  else w.integer(value);
}
void write_vector(JsonWriter& w, Vec3 v) { w.numbers({v.x, v.y, v.z}); }
void write_pose(JsonWriter& w, const Pose& X) {
  w.numbers({X.p.x, X.p.y, X.p.z, X.q.w, X.q.x, X.q.y, X.q.z});
}
void write_color(JsonWriter& w, Color c) {
  w.list([&] {
    for (const float value : {c.r, c.g, c.b, c.a}) w.number(value);
  });
}

struct ShapeWriter {
  JsonWriter& w;
  AssetTable& assets;
  void type(const char* name) const { w.key("type").text(name); }
  void round(const char* name, double radius_m, double length_m) const {
    type(name);
    w.key("radius").number(radius_m);
    w.key("length").number(length_m);
  }
  void operator()(const Box& s) const { type("box"), write_vector(w.key("size"), s.size_m); }
  void operator()(const Sphere& s) const { type("sphere"), w.key("radius").number(s.radius_m); }
  void operator()(const Cylinder& s) const { round("cylinder", s.radius_m, s.length_m); }
  void operator()(const Capsule& s) const { round("capsule", s.radius_m, s.length_m); }
  void operator()(const Cone& s) const { round("cone", s.radius_m, s.length_m); }
  void operator()(const Barrel& s) const {
    round("barrel", s.radius_m, s.length_m);
    w.key("profile").number(s.profile_m);
  }
  void operator()(const Plane& s) const { type("plane"), write_vector(w.key("normal"), s.normal); }
  void operator()(const Ellipsoid& s) const { type("ellipsoid"), write_vector(w.key("radii"), s.radii_m); }
  void operator()(const Mesh& s) const {
    type("mesh"), w.key("mesh").text("a" + std::to_string(assets.number_of(s.mesh)));
  }
  void operator()(const Heightfield& s) const {
    type("heightmap"), w.key("grid").text("g" + std::to_string(assets.number_of(s.grid)));
  }
};

void write_shape(JsonWriter& w, AssetTable& assets, const Shape& shape) {
  w.key("shape").object([&] { std::visit(ShapeWriter{w, assets}, shape); });
}

void write_visual(JsonWriter& w, AssetTable& assets, const model::Visual& visual) {
  w.object([&] {
    w.key("name").text(visual.name);
    write_pose(w.key("pose"), visual.X_LC);
    write_shape(w, assets, visual.shape);
    const model::Material& material = visual.material;
    w.key("material").object([&] {
      write_color(w.key("diffuse"), material.diffuse);
      write_color(w.key("specular"), material.specular);
      write_color(w.key("emissive"), material.emissive);
      w.key("shininess").number(material.shininess);
      w.key("texture").text(
          material.texture.empty() ? "" : "t" + std::to_string(assets.number_of_texture(material.texture)));
      w.key("from_mesh").flag(material.from_mesh);
    });
    w.key("cast_shadows").flag(visual.cast_shadows);
  });
}

void write_light(JsonWriter& w, const model::Light& light) {
  w.object([&] {
    w.key("type").text(sandlot::name_of(light.type));
    w.key("name").text(light.name);
    write_pose(w.key("pose"), light.X_PLight);
    write_color(w.key("color"), light.color);
    w.key("cast_shadows").flag(light.cast_shadows);
    w.key("range_m").number(light.range_m);
    w.key("constant").number(light.constant);
    w.key("linear").number(light.linear);
    w.key("quadratic").number(light.quadratic);
    w.key("inner_rad").number(light.inner_rad);
    w.key("outer_rad").number(light.outer_rad);
  });
}

/// A round zone has a radius, another one its corners; what it does only as far as a colour can show it.
void write_zone(JsonWriter& w, const model::SurfaceZone& zone) {
  w.object([&] {
    w.key("name").text(zone.name);
    write_vector(w.key("centre"), zone.centre_W);
    w.key("radius_m").number(zone.radius_m);
    w.key("corners").list([&] {
      for (const Vec3& corner : zone.outline_W) write_vector(w, corner);
    });
    w.key("friction").number(zone.surface.substance ? zone.surface.substance->roughness : zone.surface.mu);
    w.key("rolling_resistance_m").number(zone.surface.rolling_resistance_m);
    write_vector(w.key("belt_velocity"), zone.surface.belt_velocity_mps);
    w.key("hole").flag(!zone.surface.touches);
  });
}

void write_marker(JsonWriter& w, const WorldElements::NamedMarker& each) {
  w.object([&] {
    w.key("name").text(each.name);
    write_color(w.key("color"), each.marker->color());
    w.key("painted").flag(each.marker->visible());
    w.key("outlines").list([&] {
      for (const std::vector<Vec3>& outline : each.marker->outlines_W())
        w.list([&] {
          for (const Vec3& corner : outline) write_vector(w, corner);
        });
    });
  });
}

void write_link(JsonWriter& w, AssetTable& assets, const model::Model& model, const KinematicTree& tree,
                std::uint32_t index) {
  const model::Link& link = model.links[index];
  const KinematicTree::Branch& branch = tree.branches[tree.branch_of[index]];
  w.object([&] {
    w.key("name").text(link.name);
    write_pose(w.key("pose"), link.X_ML);
    write_index(w.key("parent"), branch.parent);
    write_index(w.key("joint"), branch.joint);
    w.key("visuals").list([&] {
      for (const model::Visual& visual : link.visuals) write_visual(w, assets, visual);
    });
    w.key("collisions").list([&] {
      for (const model::Collision& collision : link.collisions)
        w.object([&] {
          w.key("name").text(collision.name);
          write_pose(w.key("pose"), collision.X_LC);
          write_shape(w, assets, collision.shape);
        });
    });
    w.key("lights").list([&] {
      for (const model::LinkLight& each : model.lights)
        if (each.link == index) write_light(w, each.light);
    });
  });
}

void write_joint(JsonWriter& w, const model::Joint& joint) {
  w.object([&] {
    w.key("name").text(joint.name);
    w.key("type").text(sandlot::name_of(joint.type));
    write_index(w.key("parent"), joint.parent);
    write_index(w.key("child"), joint.child);
    write_pose(w.key("pose"), joint.X_CJ);
    write_vector(w.key("axis"), joint.axis_J);
    w.key("lower").number(joint.lower);
    w.key("upper").number(joint.upper);
    w.key("thread_pitch_m").number(joint.thread_pitch_m);
  });
}
static_assert(model::world_link == KinematicTree::none, "both are written as -1");

/// All but the id, as members of an object.
std::string model_content(AssetTable& assets, const std::shared_ptr<const model::Model>& model) {
  const KinematicTree tree = kinematics::forward_tree(*model);
  std::string out;
  JsonWriter w(out);
  w.key("name").text(model->name);
  w.key("static").flag(model->is_static);
  w.key("links").list([&] {
    for (std::uint32_t i = 0; i < model->links.size(); ++i) write_link(w, assets, *model, tree, i);
  });
  w.key("joints").list([&] {
    for (const model::Joint& joint : model->joints) write_joint(w, joint);
  });
  return out;
}

void write_topics(JsonWriter& w, const Kind& kind, const std::vector<Simulation::Slot>& slots) {
  w.list([&] {
    for (const Simulation::Slot& slot : slots)
      w.object([&] {
        w.key("name").text(slot.topic->name());
        w.key("type").text(slot.topic->type());
        w.key("level").text(slot.level < kind.levels.size() ? kind.levels[slot.level].name : "");
      });
  });
}

void write_part(JsonWriter& w, std::string_view name, std::string_view path, std::string_view kind) {
  w.object([&] {
    w.key("name").text(name);
    w.key("path").text(path);
    w.key("kind").text(kind);
  });
}

/// Topics that clients may publish for a program; not there where it reads none.
void write_inputs(JsonWriter& w, const Outputs& outputs) {
  if (outputs.inputs().empty()) return;
  w.key("inputs").list([&] {
    for (const Outputs::Input& input : outputs.inputs())
      w.object([&] {
        w.key("name").text(input.topic->name());
        w.key("type").text(input.topic->type());
      });
  });
}

void write_programs(JsonWriter& w, const Simulation::ProgramEntries& programs) {
  w.list([&] {
    for (const auto& program : programs)
      w.object([&] {
        w.key("name").text(program->decl.name);
        w.key("path").text(program->path);
        w.key("kind").text(program->decl.kind);
        if (program->inactive) w.key("inactive").flag(true);
        if (program->outputs) write_inputs(w, *program->outputs);
      });
  });
}

void write_instance(JsonWriter& w, const Simulation& simulation, const Simulation::Entity& entity,
                    const std::string& model_id) {
  const model::Instance& instance = entity.instance;
  w.object([&] {
    w.key("id").integer(static_cast<std::uint32_t>(entity.serial));
    w.key("name").text(instance.name);
    w.key("original").text(instance.original_name);
    w.key("model").text(model_id);
    w.key("robot").flag(instance.is_robot);
    w.key("team").text(instance.team);
    write_pose(w.key("pose"), simulation.engine().pose(entity.id));
    if (instance.is_robot) write_pose(w.key("start"), instance.X_WM);
    w.key("devices").list([&] {
      for (const auto& device : entity.devices) {
        const Kind& kind = simulation.kind(*device);
        w.object([&] {
          w.key("name").text(device->decl.name);
          w.key("path").text(device->path);
          w.key("kind").text(kind.name);
          write_index(w.key("link"), device->decl.link);
          write_pose(w.key("pose"), device->decl.X_LS);
          w.key("active").list([&] {
            for (std::size_t i = 0; i < kind.levels.size(); ++i)
              if (device->levels >> i & 1) w.text(kind.levels[i].name);
          });
          w.key("topics");
          write_topics(w, kind, device->topics);
          w.key("commands");
          write_topics(w, kind, device->commands);
          if (!kind.services.empty())
            w.key("services").list([&] {
              for (const DeviceService& service : kind.services)
                w.object([&] {
                  w.key("name").text("/" + device->path + "/" + service.name);
                  w.key("type").text(service.type);
                  w.key("help").text(service.help);
                });
            });
        });
      }
    });
    w.key("controllers");
    write_programs(w, entity.programs);
  });
}

/// What the run and its teams are judged by, with the address of the present value.
void write_criteria(JsonWriter& w, const model::Setup& setup) {
  const auto judged = [](const model::TeamDecl& team) { return team.criterion.has_value(); };
  if (!setup.criterion && std::none_of(setup.teams.begin(), setup.teams.end(), judged)) return;
  const auto write = [&](const std::string& team, const model::CriterionDecl& criterion) {
    w.object([&] {
      w.key("team").text(team);
      w.key("address").text(team.empty() ? "criterion" : team + ".criterion");
      w.key("value").text(criterion.value);
      if (!criterion.success.empty()) w.key("success").text(criterion.success);
    });
  };
  w.key("criteria").list([&] {
    if (setup.criterion) write("", *setup.criterion);
    for (const model::TeamDecl& team : setup.teams)
      if (team.criterion) write(team.name, *team.criterion);
  });
}

/// What belongs to no robot: media, rules, criteria, programs of teams; each list only where it has something.
void write_parts(JsonWriter& w, const Simulation& simulation) {
  for (const char* const list : {"media", "rules"}) {
    const auto& all = simulation.elements().parts();
    const auto is_of = [&](const WorldElements::Part& part) { return first_part(part.path) == list; };
    if (std::none_of(all.begin(), all.end(), is_of)) continue;
    w.key(list).list([&] {
      for (const WorldElements::Part& part : all)
        if (is_of(part)) write_part(w, part.path.substr(std::strlen(list) + 1), part.path, part.kind);
    });
  }
  write_criteria(w, simulation.setup());
  if (simulation.teams().empty()) return;
  w.key("teams").list([&] {
    for (const Simulation::Team& team : simulation.teams())
      w.object([&] {
        w.key("name").text(team.decl.name);
        w.key("programs");
        write_programs(w, team.programs);
      });
  });
}

}  // namespace

WorldJsonWriter::ByContent::iterator WorldJsonWriter::written_model(
    const std::shared_ptr<const model::Model>& model) {
  if (const auto known = known_models_.find(model.get());
      known != known_models_.end() && !known->second.model.expired())
    return known->second.written;
  const auto [place, fresh] = models_.try_emplace(model_content(*assets_.table_, model));
  if (fresh) place->second.number = next_model_++;
  known_models_[model.get()] = {model, place};
  return place;
}

const std::string& WorldJsonWriter::kind_json(const void* kind, const char* help,
                                              std::span<const LevelInfo> levels,
                                              std::vector<FieldInfo> (*describe)(),
                                              const Kind* common_keys_of) {
  std::string& out = kinds_[{kind, common_keys_of != nullptr}];
  if (!out.empty()) return out;
  JsonWriter w(out);
  w.object([&] {
    w.key("help").text(help);
    w.key("levels").list([&] {
      for (const LevelInfo& level : levels)
        w.object([&] {
          w.key("name").text(level.name);
          w.key("message").text(level.message);
          w.key("command").text(level.command);
          w.key("help").text(level.help);
        });
    });
    w.key("fields").list([&] {
      const auto add = [&](const std::vector<FieldInfo>& fields) {
        for (const FieldInfo& field : fields)
          w.object([&] {
            w.key("path").text(field.path);
            write_field(w, field);
          });
      };
      add(describe());
      if (common_keys_of) add(device_key_fields(*common_keys_of));
    });
  });
  return out;
}

std::string WorldJsonWriter::write(const Simulation& simulation, std::uint64_t epoch) {
  std::string out;
  JsonWriter w(out);
  const model::Setup& setup = simulation.setup();
  w.object([&] {
    w.key("revision").integer(simulation.revision());
    w.key("epoch").integer(epoch);
    w.key("name").text(setup.name);
    w.key("engine").text(setup.engine);
    w.key("step_s").number(setup.step.s());
    w.key("seed").integer(setup.seed);
    write_vector(w.key("gravity"), setup.gravity);
    write_color(w.key("ambient"), setup.ambient);
    write_color(w.key("background"), setup.background);
    w.key("lights").list([&] {
      for (const model::Light& light : setup.lights) write_light(w, light);
    });
    if (!setup.zones.empty())
      w.key("zones").list([&] {
        for (const model::SurfaceZone& zone : setup.zones) write_zone(w, zone);
      });
    if (!simulation.elements().markers().empty())
      w.key("markers").list([&] {
        for (const auto& marker : simulation.elements().markers()) write_marker(w, marker);
      });
    write_parts(w, simulation);
    for (auto& [content, model] : models_) model.used = false;
    std::vector<ByContent::iterator> models;
    w.key("models").list([&] {
      for (const auto& entity : simulation.entities()) {
        const auto model = models.emplace_back(written_model(entity->instance.model));
        if (std::exchange(model->second.used, true)) continue;
        w.raw("{\"id\":\"m" + std::to_string(model->second.number) + "\"," + model->first + "}");
      }
    });
    w.key("instances").list([&] {
      std::size_t place = 0;
      for (const auto& entity : simulation.entities())
        write_instance(w, simulation, *entity, "m" + std::to_string(models[place++]->second.number));
    });
    // Devices go before controllers of the same name: fields of both are found by the kind that a path has.
    std::map<std::string_view, const std::string*> kinds;
    std::set<const Kind*> keyed;  // kinds of which some device has common keys
    for (const auto& entity : simulation.entities())
      for (const auto& device : entity->devices)
        if (device->keys) keyed.insert(&simulation.kind(*device));
    for (const auto& entity : simulation.entities())
      for (const auto& device : entity->devices) {
        const Kind& kind = simulation.kind(*device);
        kinds.try_emplace(kind.name, &kind_json(&kind, kind.help, kind.levels, kind.describe,
                                                keyed.contains(&kind) ? &kind : nullptr));
      }
    const auto add_programs = [&](const Simulation::ProgramEntries& programs) {
      const auto add = [&](const auto& all, const std::string& wanted) {
        for (const auto* const kind : all)
          if (wanted == kind->name)
            kinds.try_emplace(kind->name, &kind_json(kind, kind->help, {}, kind->describe));
      };
      for (const auto& program : programs) {
        add(simulation.controller_kinds(), program->decl.kind);
        add(simulation.program_kinds(), program->decl.kind);
      }
    };
    for (const auto& entity : simulation.entities()) add_programs(entity->programs);
    for (const Simulation::Team& team : simulation.teams()) add_programs(team.programs);
    // A rule may be called as a device is: its list goes before its name.
    std::map<std::string, const std::string*> elements;
    for (const WorldElements::Part& part : simulation.elements().parts())
      elements.try_emplace(
          std::string(first_part(part.path)) + "/" + part.kind,
          &kind_json(reinterpret_cast<const void*>(part.describe), part.help, {}, part.describe));
    w.key("kinds").object([&] {
      for (const auto& [name, json] : kinds) w.key(name).raw(*json);
      for (const auto& [name, json] : elements) w.key(name).raw(*json);
    });
  });
  std::erase_if(known_models_, [](const auto& each) {
    return each.second.model.expired() || !each.second.written->second.used;
  });
  std::erase_if(models_, [](const auto& each) { return !each.second.used; });
  return out;
}

}  // namespace sandlot::wire
