#include "model/model_bytes.h"

#include <algorithm>
#include <cmath>

#include "geometry/height_grid.h"
#include "geometry/mesh.h"
#include "model/rollers.h"

namespace sandlot {
namespace {

constexpr int max_node_depth = 64;

/// No engine and no camera can make a rotation of any other.
bool is_pose(const Pose& X) {
  const double length = norm(X.q);
  return is_finite(X) && length > 1e-6 && length < 1e6;
}

/// Numbers of a model are finite: readers of files take 1e16 for "no limit".
template <class T>
bool is_finite_value(const T& x) {
  if constexpr (std::is_floating_point_v<T>) {
    return std::abs(x) <= T(1e16);  // false for NaN
  } else if constexpr (FixedVector<T>) {
    bool all = true;
    for (std::size_t i = 0; i < T::extent; ++i) all = all && is_finite_value(x[i]);
    return all;
  } else if constexpr (is_array<T>::value || is_vector<T>::value) {
    return std::all_of(x.begin(), x.end(), [](const auto& each) { return is_finite_value(each); });
  } else {
    return true;
  }
}

/// Both directions are one walk over the lists of fields: `io` is a Save or a Load.
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
    if (!is_finite_value(x)) r.fail();
  }
  bool ok() const { return r.ok(); }
};

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

template <class Io, class T>
void walk(Io& io, T& x);

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
template <class T>
void shared(Save& io, std::vector<const T*>& table, const std::shared_ptr<const T>& item) {
  const std::size_t known = table.size();
  const std::uint32_t index = place_in_table(table, item.get());
  io.value(index);
  if (index == known) walk(io, *item);
}
template <class T>
void shared(Load& io, std::vector<std::shared_ptr<const T>>& table, std::shared_ptr<const T>& item) {
  std::uint32_t index = 0;
  io.value(index);
  if (index > table.size()) return io.r.fail();
  if (index == table.size()) {
    auto fresh = std::make_shared<T>();
    walk(io, *fresh);
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
  if (const auto* m = std::get_if<Mesh>(&s)) shared(io, io.meshes, m->mesh);
  if (const auto* h = std::get_if<Heightfield>(&s)) shared(io, io.grids, h->grid);
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
      shared(io, io.meshes, m.mesh);
      if (m.mesh) s = std::move(m);
      break;
    }
    case 8: {
      Heightfield h;
      shared(io, io.grids, h.grid);
      if (h.grid) s = std::move(h);
      break;
    }
    case 9: s = Barrel{n[0], n[1], n[2]}; break;
    default: io.r.fail();
  }
}

template <class T>
struct is_shared_list : std::false_type {};
template <class T>
struct is_shared_list<SharedList<T>> : std::true_type {};

/// A value of a model: its fields in the order of their list; nodes, shapes and plain values in forms of their own.
template <class Io, class T>
void walk(Io& io, T& x) {
  using Value = std::remove_const_t<T>;
  if constexpr (std::is_same_v<Value, Node>) {
    node(io, x);
  } else if constexpr (std::is_same_v<Value, Shape>) {
    shape(io, x);
  } else if constexpr (Fielded<Value>) {
    Value::fields(x, [&](const Field&, auto& member) { walk(io, member); });
    if constexpr (Io::loading && std::is_same_v<Value, Pose>)
      if (!is_pose(x)) io.r.fail();
  } else if constexpr (is_shared_list<Value>::value) {
    if constexpr (Io::loading) walk(io, x.edit());
    else walk(io, x.get());
  } else if constexpr (is_optional<Value>::value) {
    bool present = x.has_value();
    io.value(present);
    if constexpr (Io::loading) {
      x.reset();
      if (present) x.emplace();
    }
    if (x) walk(io, *x);
  } else if constexpr (is_vector<Value>::value) {
    if constexpr (Fielded<typename Value::value_type>) {
      auto count = static_cast<std::uint32_t>(x.size());
      io.value(count);
      if constexpr (Io::loading) {
        x.clear();
        // Every element takes at least one byte: a damaged length cannot ask for more than there is.
        if (count > io.r.remaining()) return io.r.fail();
        x.resize(count);
      }
      for (auto& element : x)
        if (io.ok()) walk(io, element);
    } else {
      io.value(x);
    }
  } else {
    io.value(x);
  }
}

/// A tick divides by all of these.
bool is_timing(const model::Setup& s) {
  return s.step.ns > 0 && s.substeps > 0 && s.control_interval > 0 &&
         (s.clock.mode == model::Clock::Mode::fixed ||
          (s.clock.min_step.ns > 0 && s.clock.min_step <= s.clock.max_step));
}

/// On errors.
bool is_factor(double x) { return x >= 0 && x <= 1000; }

/// As readers of files and builders leave them: engines take them for bounds.
bool are_limits(double lower, double upper, double damping, double friction) {
  return lower <= upper && damping >= 0 && friction >= 0;
}
bool consistent(const model::Joint& j) {
  return are_limits(j.lower, j.upper, j.damping, j.friction) && j.max_effort >= 0 && j.max_velocity >= 0 &&
         j.spring_stiffness >= 0 && (!j.rollers || model::is_wheel(*j.rollers)) &&
         (!j.second || are_limits(j.second->lower, j.second->upper, j.second->damping, j.second->friction));
}

/// Indices that the rest of the program follows without asking, and limits.
bool consistent(const model::Model& m) {
  const auto links = static_cast<std::uint32_t>(m.links.size());
  if (links == 0) return false;
  for (const model::Joint& j : m.joints)
    if ((j.parent >= links && j.parent != model::world_link) || j.child >= links ||
        (j.mimic && j.mimic->joint >= m.joints.size()) ||
        (j.roller_of != model::Joint::no_joint && j.roller_of >= m.joints.size()) || !consistent(j))
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
  if (!is_factor(x.errors)) return false;
  for (const model::PropertyDecl& each : x.properties)
    if (!(each.value >= each.min && each.value <= each.max)) return false;
  for (const model::DeviceDecl& d : x.devices)
    if (d.link >= x.model->links.size()) return false;
  return true;
}

}  // namespace

void write_setup(ByteWriter& w, const model::Setup& setup,
                 std::span<const model::Instance* const> instances) {
  Save io{w};
  walk(io, setup);
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
  for (const model::Model* m : models) walk(io, *m);
  io.value(static_cast<std::uint32_t>(instances.size()));
  for (std::size_t i = 0; i < instances.size(); ++i) {
    walk(io, *instances[i]);
    io.value(model_of[i]);
  }
}

bool read_setup(ByteReader& r, model::Setup& setup) {
  Load io{r};
  walk(io, setup);
  if (!r.ok() || !is_timing(setup) || !is_factor(setup.errors)) return false;
  std::uint32_t count = 0;
  io.value(count);
  std::vector<std::shared_ptr<const model::Model>> models;
  for (std::uint32_t i = 0; i < count && r.ok(); ++i) {
    auto m = std::make_shared<model::Model>();
    walk(io, *m);
    if (!r.ok() || !consistent(*m)) return false;
    models.push_back(std::move(m));
  }
  io.value(count);
  setup.instances.clear();
  for (std::uint32_t i = 0; i < count && r.ok(); ++i) {
    model::Instance instance;
    walk(io, instance);
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
  walk(io, *instance.model);
  walk(io, instance);
}

bool read_instance(ByteReader& r, model::Instance& instance) {
  Load io{r};
  auto m = std::make_shared<model::Model>();
  walk(io, *m);
  walk(io, instance);
  if (!r.ok() || !consistent(*m)) return false;
  instance.model = std::move(m);
  return consistent(instance);
}

void write_device(ByteWriter& w, const model::DeviceDecl& decl) {
  Save io{w};
  walk(io, decl);
}

bool read_device(ByteReader& r, model::DeviceDecl& decl) {
  Load io{r};
  walk(io, decl);
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
