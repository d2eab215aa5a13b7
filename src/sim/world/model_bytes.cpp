/// long file: one function for each struct of a Model, in their order; the writer and the reader of all are these.
#include "sim/world/model_bytes.h"

#include <algorithm>

#include "geometry/height_grid.h"
#include "geometry/mesh.h"

namespace sandlot {
namespace {

constexpr int max_node_depth = 64;

/// One description of each struct serves both directions: `io` is a Save or a Load.
struct Save {
  ByteWriter& w;
  std::vector<const TriangleMesh*> meshes{};
  std::vector<const HeightGrid*> grids{};
  static constexpr bool loading = false;
  template <class T>
  void value(const T& x) {
    write(w, x);
  }
  bool ok() const { return true; }
};
struct Load {
  ByteReader& r;
  std::vector<std::shared_ptr<const TriangleMesh>> meshes{};
  std::vector<std::shared_ptr<const HeightGrid>> grids{};
  static constexpr bool loading = true;
  template <class T>
  void value(T& x) {
    read(r, x);
  }
  bool ok() const { return r.ok(); }
};

template <class Io, class T, class Each>
void list(Io& io, T& items, Each&& each) {
  auto count = static_cast<std::uint32_t>(items.size());
  io.value(count);
  if constexpr (Io::loading) {
    items.clear();
    if (count > io.r.remaining()) return io.r.fail();
    items.resize(count);
  }
  for (auto& item : items)
    if (io.ok()) each(io, item);
}

/// As list().
template <class Io, class T, class Each>
void shared_list(Io& io, T& items, Each&& each) {
  if constexpr (Io::loading) list(io, items.edit(), each);
  else list(io, items.get(), each);
}

template <class Io, class T, class Each>
void optional(Io& io, T& item, Each&& each) {
  bool present = item.has_value();
  io.value(present);
  if constexpr (Io::loading) {
    item.reset();
    if (present) item.emplace();
  }
  if (item) each(io, *item);
}

void node(Save& io, const Node& n) {
  io.value(static_cast<std::uint8_t>(n.type()));
  if (n.is_scalar()) io.value(n.text());
  io.value(static_cast<std::uint32_t>(n.items().size()));
  for (const Node& item : n.items()) node(io, item);
  io.value(static_cast<std::uint32_t>(n.entries().size()));
  for (const Node::Entry& entry : n.entries()) {
    io.value(entry.key);
    node(io, entry.value);
  }
}

void node(Load& io, Node& n, int depth = 0) {
  std::uint8_t type = 0;
  io.value(type);
  if (depth > max_node_depth || type > 3) return io.r.fail();
  n = Node();
  if (type == static_cast<std::uint8_t>(Node::Type::scalar)) {
    std::string text;
    io.value(text);
    n = Node::scalar(std::move(text));
  }
  if (type == static_cast<std::uint8_t>(Node::Type::sequence)) n = Node::sequence();
  if (type == static_cast<std::uint8_t>(Node::Type::map)) n = Node::map();
  std::uint32_t count = 0;
  io.value(count);
  if (count > io.r.remaining() || (count && !n.is_sequence())) return io.r.fail();
  for (std::uint32_t i = 0; i < count && io.ok(); ++i) node(io, n.push(Node()), depth + 1);
  io.value(count);
  if (count > io.r.remaining() || (count && !n.is_map())) return io.r.fail();
  for (std::uint32_t i = 0; i < count && io.ok(); ++i) {
    std::string key;
    io.value(key);
    Node value;
    node(io, value, depth + 1);
    n.set(std::move(key), std::move(value));
  }
}

void color(auto& io, auto& c) {
  io.value(c.r);
  io.value(c.g);
  io.value(c.b);
  io.value(c.a);
}

void mesh(auto& io, auto& m) {
  io.value(m.vertices);
  io.value(m.triangles);
  io.value(m.texture_uv);
  list(io, m.parts, [](auto& i, auto& part) {
    i.value(part.name);
    i.value(part.first_triangle);
    i.value(part.triangles);
    color(i, part.color);
    i.value(part.texture);
  });
  io.value(m.source);
  io.value(m.source_scale);
  io.value(m.source_part);
  io.value(m.source_centred);
  io.value(m.is_hull);
}

void grid(auto& io, auto& g) {
  io.value(g.columns);
  io.value(g.rows);
  io.value(g.size_x_m);
  io.value(g.size_y_m);
  io.value(g.height_m);
  io.value(g.source);
  io.value(g.source_height_m);
}

bool consistent(const TriangleMesh& m) {
  for (const auto& triangle : m.triangles)
    for (const std::uint32_t corner : triangle)
      if (corner >= m.vertices.size()) return false;
  for (const MeshPart& part : m.parts)
    if (part.first_triangle > m.triangles.size() || part.triangles > m.triangles.size() - part.first_triangle)
      return false;
  return m.texture_uv.empty() || m.texture_uv.size() == m.vertices.size();
}

bool consistent(const HeightGrid& g) {
  return g.columns >= 2 && g.rows >= 2 && g.size_x_m > 0 && g.size_y_m > 0 &&
         g.height_m.size() == static_cast<std::size_t>(g.columns) * static_cast<std::size_t>(g.rows);
}

/// Shapes as their index in the variant and their numbers; meshes and terrain, which shapes share, as their place in
/// a table that is written once.
template <class T>
std::uint32_t place_in_table(std::vector<const T*>& table, const T* item) {
  const auto found = std::find(table.begin(), table.end(), item);
  if (found != table.end()) return static_cast<std::uint32_t>(found - table.begin());
  table.push_back(item);
  return static_cast<std::uint32_t>(table.size() - 1);
}

/// The first mention of a mesh or grid brings it along.
template <class T, class Each>
void shared(Save& io, std::vector<const T*>& table, const std::shared_ptr<const T>& item, Each&& each) {
  const std::size_t known = table.size();
  const std::uint32_t index = place_in_table(table, item.get());
  io.value(index);
  if (index == known) each(io, *item);
}
template <class T, class Each>
void shared(Load& io, std::vector<std::shared_ptr<const T>>& table, std::shared_ptr<const T>& item,
            Each&& each) {
  std::uint32_t index = 0;
  io.value(index);
  if (index > table.size()) return io.r.fail();
  if (index == table.size()) {
    auto fresh = std::make_shared<T>();
    each(io, *fresh);
    if (!io.ok() || !consistent(*fresh)) return io.r.fail();
    table.push_back(std::move(fresh));
  }
  item = table[index];
}

void shape(Save& io, const Shape& s) {
  std::array<double, 3> n{};
  if (const auto* b = std::get_if<Box>(&s)) n = {b->size_m.x, b->size_m.y, b->size_m.z};
  if (const auto* b = std::get_if<Sphere>(&s)) n = {b->radius_m, 0, 0};
  if (const auto* c = std::get_if<Cylinder>(&s)) n = {c->radius_m, c->length_m, 0};
  if (const auto* c = std::get_if<Capsule>(&s)) n = {c->radius_m, c->length_m, 0};
  if (const auto* p = std::get_if<Plane>(&s)) n = {p->normal.x, p->normal.y, p->normal.z};
  if (const auto* c = std::get_if<Cone>(&s)) n = {c->radius_m, c->length_m, 0};
  if (const auto* e = std::get_if<Ellipsoid>(&s)) n = {e->radii_m.x, e->radii_m.y, e->radii_m.z};
  if (const auto* b = std::get_if<Barrel>(&s)) n = {b->radius_m, b->profile_m, b->length_m};
  io.value(static_cast<std::uint8_t>(s.index()));
  io.value(n);
  if (const auto* m = std::get_if<Mesh>(&s))
    shared(io, io.meshes, m->mesh, [](auto& i, auto& x) { mesh(i, x); });
  if (const auto* h = std::get_if<Heightfield>(&s))
    shared(io, io.grids, h->grid, [](auto& i, auto& x) { grid(i, x); });
}
void shape(Load& io, Shape& s) {
  std::uint8_t index = 0;
  std::array<double, 3> n{};
  io.value(index);
  io.value(n);
  switch (index) {
    case 0: s = Box{{n[0], n[1], n[2]}}; break;
    case 1: s = Sphere{n[0]}; break;
    case 2: s = Cylinder{n[0], n[1]}; break;
    case 3: s = Capsule{n[0], n[1]}; break;
    case 4: s = Plane{{n[0], n[1], n[2]}}; break;
    case 5: s = Cone{n[0], n[1]}; break;
    case 6: s = Ellipsoid{{n[0], n[1], n[2]}}; break;
    case 7: {
      Mesh m;
      shared(io, io.meshes, m.mesh, [](auto& i, auto& x) { mesh(i, x); });
      if (m.mesh) s = std::move(m);
      break;
    }
    case 8: {
      Heightfield h;
      shared(io, io.grids, h.grid, [](auto& i, auto& x) { grid(i, x); });
      if (h.grid) s = std::move(h);
      break;
    }
    case 9: s = Barrel{n[0], n[1], n[2]}; break;
    default: io.r.fail();
  }
}

void surface(auto& io, auto& s) {
  io.value(s.mu);
  io.value(s.mu2);
  io.value(s.fdir1);
  io.value(s.slip1);
  io.value(s.slip2);
  io.value(s.restitution);
  io.value(s.restitution_threshold_mps);
  io.value(s.soft_erp);
  io.value(s.soft_cfm);
  io.value(s.stiffness_N_per_m);
  io.value(s.damping_N_s_per_m);
  io.value(s.max_correction_mps);
  optional(io, s.substance, [](auto& i, auto& x) {
    i.value(x.roughness);
    i.value(x.slip);
    i.value(x.hardness);
    i.value(x.elasticity);
  });
  optional(io, s.skin, [](auto& i, auto& x) {
    i.value(x.axis);
    i.value(x.ratio);
  });
  io.value(s.rolling_resistance_m);
  io.value(s.belt_velocity_mps);
  io.value(s.touches);
}

void collision(auto& io, auto& c) {
  io.value(c.name);
  io.value(c.X_LC);
  shape(io, c.shape);
  surface(io, c.surface);
}

void visual(auto& io, auto& v) {
  io.value(v.name);
  io.value(v.X_LC);
  shape(io, v.shape);
  color(io, v.material.diffuse);
  color(io, v.material.specular);
  color(io, v.material.emissive);
  io.value(v.material.shininess);
  io.value(v.material.texture);
  io.value(v.material.from_mesh);
  io.value(v.cast_shadows);
}

void link(auto& io, auto& l) {
  io.value(l.name);
  io.value(l.X_ML);
  io.value(l.inertial.mass_kg);
  io.value(l.inertial.X_LCo);
  io.value(l.inertial.moments);
  io.value(l.inertial.products);
  list(io, l.collisions, [](auto& i, auto& c) { collision(i, c); });
  list(io, l.visuals, [](auto& i, auto& v) { visual(i, v); });
  io.value(l.gravity);
}

void joint(auto& io, auto& j) {
  io.value(j.name);
  io.value(j.type);
  io.value(j.parent);
  io.value(j.child);
  io.value(j.X_CJ);
  io.value(j.axis_J);
  io.value(j.lower);
  io.value(j.upper);
  io.value(j.max_effort);
  io.value(j.max_velocity);
  io.value(j.damping);
  io.value(j.friction);
  io.value(j.spring_stiffness);
  io.value(j.spring_reference);
  io.value(j.thread_pitch_m);
  optional(io, j.second, [](auto& i, auto& s) {
    i.value(s.axis_J);
    i.value(s.lower);
    i.value(s.upper);
    i.value(s.damping);
    i.value(s.friction);
  });
  optional(io, j.mimic, [](auto& i, auto& m) {
    i.value(m.joint);
    i.value(m.multiplier);
    i.value(m.offset);
    i.value(m.reference);
  });
  optional(io, j.rollers, [](auto& i, auto& w) {
    i.value(w.radius_m);
    i.value(w.count);
    i.value(w.rows);
    i.value(w.row_spacing_m);
    i.value(w.angle_rad);
    i.value(w.roller_radius_m);
    i.value(w.roller_length_m);
    i.value(w.roller_mass_kg);
    i.value(w.bearing_friction_Nm);
    surface(i, w.surface);
  });
  io.value(j.roller_of);
}

void light(auto& io, auto& l) {
  io.value(l.type);
  io.value(l.name);
  io.value(l.X_PLight);
  color(io, l.color);
  color(io, l.specular);
  io.value(l.cast_shadows);
  io.value(l.range_m);
  io.value(l.constant);
  io.value(l.linear);
  io.value(l.quadratic);
  io.value(l.inner_rad);
  io.value(l.outer_rad);
  io.value(l.falloff);
}

void device(auto& io, auto& d) {
  io.value(d.name);
  io.value(d.kind);
  io.value(d.sdf_types);
  io.value(d.scope);
  io.value(d.link);
  io.value(d.X_LS);
  node(io, d.config);
}

void controller(auto& io, auto& c) {
  io.value(c.name);
  io.value(c.kind);
  node(io, c.config);
}

void whole_model(auto& io, auto& m) {
  io.value(m.name);
  io.value(m.label);
  io.value(m.is_static);
  io.value(m.self_collide);
  list(io, m.links, [](auto& i, auto& l) { link(i, l); });
  list(io, m.joints, [](auto& i, auto& j) { joint(i, j); });
  list(io, m.frames, [](auto& i, auto& f) {
    i.value(f.name);
    i.value(f.link);
    i.value(f.X_LF);
  });
  list(io, m.lights, [](auto& i, auto& l) {
    i.value(l.link);
    light(i, l.light);
  });
  list(io, m.devices, [](auto& i, auto& d) { device(i, d); });
}

void watched(auto& io, auto& s) {
  list(io, s.values, [](auto& i, auto& v) {
    i.value(v.name);
    i.value(v.expression);
  });
  list(io, s.events, [](auto& i, auto& e) {
    i.value(e.name);
    i.value(e.when);
    i.value(e.hold);
    i.value(e.once);
    i.value(e.stop);
  });
  io.value(s.addresses);
}

void setup_values(auto& io, auto& s) {
  io.value(s.name);
  io.value(s.engine);
  node(io, s.physics);
  io.value(s.gravity);
  io.value(s.step);
  io.value(s.clock.mode);
  io.value(s.clock.min_step);
  io.value(s.clock.max_step);
  io.value(s.substeps);
  io.value(s.control_interval);
  io.value(s.seed);
  io.value(s.errors);
  io.value(s.stop);
  list(io, s.plugins, [](auto& i, auto& p) {
    i.value(p.file);
    i.value(p.name);
    i.value(p.hash);
  });
  list(io, s.zones, [](auto& i, auto& z) {
    i.value(z.name);
    i.value(z.outline_W);
    i.value(z.centre_W);
    i.value(z.radius_m);
    surface(i, z.surface);
  });
  list(io, s.lights, [](auto& i, auto& l) { light(i, l); });
  color(io, s.ambient);
  color(io, s.background);
  optional(io, s.geography, [](auto& i, auto& g) {
    i.value(g.latitude_rad);
    i.value(g.longitude_rad);
    i.value(g.elevation_m);
    i.value(g.heading_rad);
  });
  io.value(s.magnetic_field_T);
  watched(io, s);
}

void instance_values(auto& io, auto& x) {
  io.value(x.name);
  io.value(x.original_name);
  io.value(x.X_WM);
  io.value(x.is_robot);
  io.value(x.team);
  io.value(x.label);
  io.value(x.errors);
  shared_list(io, x.devices, [](auto& i, auto& d) { device(i, d); });
  shared_list(io, x.controllers, [](auto& i, auto& c) { controller(i, c); });
  optional(io, x.motion, [](auto& i, auto& m) {
    list(i, m.keys, [](auto& each, auto& key) {
      each.value(key.time_s);
      each.value(key.X_WM);
    });
    i.value(m.delay_s);
    i.value(m.loop);
  });
}

/// A tick divides by all of these.
bool is_timing(const model::Setup& s) {
  return s.step.ns > 0 && s.substeps > 0 && s.control_interval > 0 &&
         (s.clock.mode == model::Clock::Mode::fixed ||
          (s.clock.min_step.ns > 0 && s.clock.min_step <= s.clock.max_step));
}

/// On errors.
bool is_factor(double x) { return x >= 0 && x <= 1000; }

/// An engine stops at an orientation that it cannot make a rotation of.
bool is_pose(const Pose& X) {
  const double length = norm(X.q);
  return is_finite(X) && length > 1e-6 && length < 1e6;
}

/// Indices that the rest of the program follows without asking, and poses.
bool consistent(const model::Model& m) {
  const auto links = static_cast<std::uint32_t>(m.links.size());
  if (links == 0) return false;
  for (const model::Link& l : m.links)
    if (!is_pose(l.X_ML)) return false;
  for (const model::Joint& j : m.joints)
    if ((j.parent >= links && j.parent != model::world_link) || j.child >= links ||
        j.type > model::JointType::screw || (j.mimic && j.mimic->joint >= m.joints.size()) ||
        (j.roller_of != model::Joint::no_joint && j.roller_of >= m.joints.size()))
      return false;
  for (const model::LinkLight& l : m.lights)
    if (l.link >= links) return false;
  for (const model::Frame& f : m.frames)
    if (f.link >= links) return false;
  for (const model::DeviceDecl& d : m.devices)
    if (d.link >= links) return false;
  return true;
}

bool consistent(const model::Instance& x) {
  if (x.motion && x.motion->keys.empty()) return false;
  if (!is_pose(x.X_WM) || !is_factor(x.errors)) return false;
  for (const model::DeviceDecl& d : x.devices)
    if (d.link >= x.model->links.size()) return false;
  return true;
}

}  // namespace

void write_setup(ByteWriter& w, const model::Setup& setup,
                 std::span<const model::Instance* const> instances) {
  Save io{w};
  setup_values(io, setup);
  std::vector<const model::Model*> models;
  std::vector<std::uint32_t> model_of;
  for (const model::Instance* instance : instances) {
    const auto* const m = instance->model.get();
    // Robots of one kind come in a row: look at the newest first.
    const auto found = std::find(models.rbegin(), models.rend(), m);
    if (found != models.rend()) {
      model_of.push_back(static_cast<std::uint32_t>(models.rend() - found - 1));
    } else {
      model_of.push_back(static_cast<std::uint32_t>(models.size()));
      models.push_back(m);
    }
  }
  io.value(static_cast<std::uint32_t>(models.size()));
  for (const model::Model* m : models) whole_model(io, *m);
  io.value(static_cast<std::uint32_t>(instances.size()));
  for (std::size_t i = 0; i < instances.size(); ++i) {
    instance_values(io, *instances[i]);
    io.value(model_of[i]);
  }
}

bool read_setup(ByteReader& r, model::Setup& setup) {
  Load io{r};
  setup_values(io, setup);
  if (!r.ok() || !is_timing(setup) || !is_factor(setup.errors)) return false;
  if (setup.clock.mode > model::Clock::Mode::continuous) return false;
  std::uint32_t count = 0;
  io.value(count);
  std::vector<std::shared_ptr<const model::Model>> models;
  for (std::uint32_t i = 0; i < count && r.ok(); ++i) {
    auto m = std::make_shared<model::Model>();
    whole_model(io, *m);
    if (!r.ok() || !consistent(*m)) return false;
    models.push_back(std::move(m));
  }
  io.value(count);
  setup.instances.clear();
  for (std::uint32_t i = 0; i < count && r.ok(); ++i) {
    model::Instance instance;
    instance_values(io, instance);
    std::uint32_t index = 0;
    io.value(index);
    if (!r.ok() || index >= models.size()) return false;
    instance.model = models[index];
    if (!consistent(instance)) return false;
    setup.instances.push_back(std::move(instance));
  }
  return r.ok();
}

void write_instance(ByteWriter& w, const model::Instance& instance) {
  Save io{w};
  whole_model(io, *instance.model);
  instance_values(io, instance);
}

bool read_instance(ByteReader& r, model::Instance& instance) {
  Load io{r};
  auto m = std::make_shared<model::Model>();
  whole_model(io, *m);
  instance_values(io, instance);
  if (!r.ok() || !consistent(*m)) return false;
  instance.model = std::move(m);
  return consistent(instance);
}

void write_device(ByteWriter& w, const model::DeviceDecl& decl) {
  Save io{w};
  device(io, decl);
}

bool read_device(ByteReader& r, model::DeviceDecl& decl) {
  Load io{r};
  device(io, decl);
  return r.ok();
}

void write_node(ByteWriter& w, const Node& n) {
  Save io{w};
  node(io, n);
}

bool read_node(ByteReader& r, Node& n) {
  Load io{r};
  node(io, n);
  return r.ok();
}

}  // namespace sandlot
