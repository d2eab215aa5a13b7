#include "builders/parts.h"

#include "base/text.h"

namespace sandlot::builders {
namespace {

/// A symmetric tensor: xx yy zz, xy xz yz.
struct Tensor {
  Vec3 moments, products;
};

/// R diag(d) R^T
Tensor turned(Quat q, Vec3 d) {
  const Vec3 x = rotate(q, {1, 0, 0}), y = rotate(q, {0, 1, 0}), z = rotate(q, {0, 0, 1});
  const auto entry = [&](std::size_t i, std::size_t j) {
    return d.x * x[i] * x[j] + d.y * y[i] * y[j] + d.z * z[i] * z[j];
  };
  return {{entry(0, 0), entry(1, 1), entry(2, 2)}, {entry(0, 1), entry(0, 2), entry(1, 2)}};
}

/// Adds what a point mass at `r` has about the origin.
void add_point(Tensor& tensor, double mass_kg, Vec3 r) {
  tensor.moments += mass_kg * Vec3{r.y * r.y + r.z * r.z, r.x * r.x + r.z * r.z, r.x * r.x + r.y * r.y};
  tensor.products += -mass_kg * Vec3{r.x * r.y, r.x * r.z, r.y * r.z};
}

void add_inertia(model::Inertial& to, double mass_kg, Vec3 centre_L, const Tensor& about_centre) {
  if (mass_kg <= 0) return;
  const double total = to.mass_kg + mass_kg;
  const Vec3 centre = (to.mass_kg * to.X_LCo.p + mass_kg * centre_L) / total;
  Tensor sum{to.moments + about_centre.moments, to.products + about_centre.products};
  add_point(sum, to.mass_kg, to.X_LCo.p - centre);
  add_point(sum, mass_kg, centre_L - centre);
  to = {total, {centre, {}}, sum.moments, sum.products};
}

/// The pose that a file's reader makes of this one: it normalises rotations and knows no -0.
Pose settled(Pose X) {
  for (int i = 0; i < 4; ++i) X.q = normalised(X.q);
  for (std::size_t i = 0; i < Quat::extent; ++i) X.q[i] += 0.0;
  return X;
}

}  // namespace

std::uint32_t add_link(model::Model& model, std::string name, const Pose& X_ML) {
  model::Link link;
  link.name = std::move(name);
  link.X_ML = settled(X_ML);
  link.inertial = {0, {}, {}, {}};
  model.links.push_back(std::move(link));
  return static_cast<std::uint32_t>(model.links.size() - 1);
}

void add_part(model::Model& model, std::uint32_t to, const Part& raw) {
  Part part = raw;
  part.X_LP = settled(raw.X_LP);
  model::Link& link = model.links[to];
  add_inertia(link.inertial, part.mass_kg, part.X_LP.p,
              turned(part.X_LP.q, inertia_kg_m2(part.shape, part.mass_kg)));
  const auto name = [](const char* stem, std::size_t count) {
    return count == 0 ? std::string(stem) : numbered(stem, static_cast<int>(count) + 1);
  };
  if (part.touches)
    link.collisions.push_back(
        {name("collision", link.collisions.size()), part.X_LP, part.shape, part.surface, {}});
  if (!part.shown) return;
  model::Material material;
  material.diffuse = part.color;
  material.from_mesh = false;
  link.visuals.push_back({name("visual", link.visuals.size()), part.X_LP, part.shape, material, true, {}});
}

void add_mass(model::Model& model, std::uint32_t link, double mass_kg, double radius_m) {
  add_inertia(model.links[link].inertial, mass_kg, {}, {inertia_kg_m2(Sphere{radius_m}, mass_kg), {}});
}

std::uint32_t add_joint(model::Model& model, std::string name, std::uint32_t parent, std::uint32_t child,
                        Vec3 at_M, const JointOptions& options) {
  const Quat q_CM = conjugate(model.links[child].X_ML.q);
  model::Joint joint;
  joint.name = std::move(name);
  joint.type = options.type;
  joint.parent = parent;
  joint.child = child;
  joint.X_CJ = {inverse(model.links[child].X_ML) * at_M, {}};
  joint.axis_J = normalised(normalised(rotate(q_CM, options.axis_M)));
  joint.lower = options.lower;
  joint.upper = options.upper;
  joint.max_effort = options.max_effort;
  joint.max_velocity = options.max_velocity;
  joint.damping = options.damping;
  model.joints.push_back(std::move(joint));
  return static_cast<std::uint32_t>(model.joints.size() - 1);
}

void add_device(model::Model& model, std::string name, const char* kind, Keys keys, std::uint32_t link,
                const Pose& X_LS) {
  model::DeviceDecl device;
  device.name = std::move(name);
  device.kind = kind;
  device.link = link;
  device.X_LS = X_LS;
  device.config = Node::map();
  for (const auto& [key, value] : keys) device.config.set(key, value);
  model.devices.push_back(std::move(device));
}

void add_motor(model::Model& model, std::string name, std::uint32_t joint) {
  const bool turns = model.joints[joint].type == model::JointType::continuous;
  add_device(model, std::move(name), "joint_motor",
             {{"joint", model.joints[joint].name},
              {"level", turns ? "velocity" : "position"},
              {"servo", "exact"},
              {"initial_command", "0"}});
}

void add_senses(model::Model& model) {
  std::vector<std::string> joints;
  for (const model::Joint& joint : model.joints) joints.push_back(joint.name);
  add_device(model, "joints", "joint_state", {{"joints", joints}, {"rate", "50"}});
  add_device(model, "imu", "imu", {{"rate", "50"}});
}

void set_units(model::Model& model, Units units) {
  if (units == Units::si) return;
  for (model::DeviceDecl& device : model.devices) {
    if (device.kind == "joint_motor") device.config.set("commands", KeyValue("centred"));
    if (device.kind == "joint_state") device.config.set("units", KeyValue("centred"));
  }
}

Pose along(Vec3 axis, Vec3 at) { return {at, quat_between({0, 0, 1}, axis)}; }

std::string numbered(const char* stem, int number) {
  return std::string(stem) + "_" + std::to_string(number);
}

}  // namespace sandlot::builders
