#include <algorithm>
#include <map>
#include <set>

#include "base/text.h"
#include "formats/sdf/write.h"
#include "formats/sdf/write_parts.h"
#include "geometry/mesh.h"

namespace sandlot::formats {
namespace {

using namespace writing;

constexpr std::uint32_t none = ~0u;

std::string plain(std::string name) {
  for (std::size_t at = name.find("::"); at != std::string::npos; at = name.find("::", at))
    name.replace(at, 2, "__");
  return name;
}

void add_origin(Xml& parent, const Pose& X) {
  if (X == Pose()) return;
  Xml& origin = add(parent, "origin");
  origin.set_attribute("xyz", text_of(X.p));
  origin.set_attribute("rpy", text_of(rpy_from_quat(normalised(X.q))));
}

class UrdfWriter {
 public:
  UrdfWriter(const model::Instance& instance, Diagnostics& diagnostics)
      : instance_(instance), m_(*instance.model), diagnostics_(diagnostics) {}

  Result<Xml> write() {
    SL_TRY(find_tree());
    SL_TRY(check_names());
    if (!(instance_.X_WM == Pose()))
      warn("where the model stands cannot be said in URDF", "say it in the scenario", instance_.place);
    out_ = element("robot");
    out_.set_attribute("name", instance_.original_name);
    if (on_world_) add(out_, "link").set_attribute("name", "world");
    const auto is_roller = [&](std::uint32_t joint) {
      return joint != none && m_.joints[joint].roller_of != model::Joint::no_joint;
    };
    for (const model::Joint& joint : m_.joints)
      if (joint.rollers)
        warn("joint '" + joint.name + "': URDF has no wheels with rollers",
             "its wheel is written without them", joint.place);
    for (std::uint32_t l = 0; l < m_.links.size(); ++l)
      if (!is_roller(parent_joint_[l])) write_link(l);
    for (std::uint32_t j = 0; j < m_.joints.size(); ++j)
      if (!is_roller(j)) write_joint(m_.joints[j]);
    for (const model::Frame& frame : m_.frames) write_frame(frame);
    write_rest();
    return std::move(out_);
  }

 private:
  void warn(const std::string& what, const std::string& fix, const Place& place) {
    diagnostics_.warn({what, fix, place});
  }

  Status find_tree() {
    parent_joint_.assign(m_.links.size(), none);
    joined_.assign(m_.links.size(), false);
    for (std::uint32_t j = 0; j < m_.joints.size(); ++j) {
      const model::Joint& joint = m_.joints[j];
      using Type = model::JointType;
      if (joint.type == Type::ball || joint.type == Type::universal || joint.type == Type::screw)
        return Error{"joint '" + joint.name + "' is of a type that URDF does not have",
                     "it has fixed, revolute, continuous and prismatic ones", joint.place};
      std::uint32_t& parent = parent_joint_[joint.child];
      if (parent != none)
        return Error{"link '" + m_.links[joint.child].name + "' is the child of joints '" +
                         m_.joints[parent].name + "' and '" + joint.name + "'",
                     "URDF describes trees", joint.place};
      parent = j;
      on_world_ = on_world_ || joint.parent == model::world_link;
      if (joint.type != Type::fixed) continue;
      joined_[joint.child] = true;
      if (joint.parent != model::world_link) joined_[joint.parent] = true;
    }
    for (const model::Link& link : m_.links) total_kg_ += link.inertial.mass_kg;
    std::uint32_t root = none;
    for (std::uint32_t l = 0; l < m_.links.size(); ++l) {
      if (parent_joint_[l] != none) continue;
      if (root != none || on_world_)
        return Error{"link '" + m_.links[l].name + "' hangs from nothing, beside " +
                         (on_world_ ? std::string("what is fixed to the world")
                                    : "link '" + m_.links[root].name + "'"),
                     "a robot in URDF has one root", m_.links[l].place};
      root = l;
    }
    std::vector<int> state(m_.links.size(), 0);
    for (std::uint32_t start = 0; start < m_.links.size(); ++start) {
      std::vector<std::uint32_t> walked;
      std::uint32_t at = start;
      while (at < m_.links.size() && state[at] == 0) {
        state[at] = 1;
        walked.push_back(at);
        at = parent_joint_[at] == none ? none : m_.joints[parent_joint_[at]].parent;
      }
      if (at < m_.links.size() && state[at] == 1)
        return Error{"the joints run in a circle through link '" + m_.links[at].name + "'",
                     "URDF describes trees", m_.links[at].place};
      for (const std::uint32_t each : walked) state[each] = 2;
    }
    if (root != none && !(m_.links[root].X_ML == Pose()))
      warn("the root link lies at the origin of a robot in URDF, link '" + m_.links[root].name + "' does not",
           "the robot stands elsewhere by that", m_.links[root].place);
    return {};
  }

  Status check_names() {
    std::set<std::string> links, joints;
    for (const model::Link& link : m_.links)
      if (!links.insert(plain(link.name)).second)
        return Error{"two links are called '" + plain(link.name) + "' in URDF", "rename one", link.place};
    for (const model::Joint& joint : m_.joints)
      if (!joints.insert(plain(joint.name)).second)
        return Error{"two joints are called '" + plain(joint.name) + "' in URDF", "rename one", joint.place};
    return {};
  }

  /// The link's frame in URDF, which is that of its joint, in the link's own.
  Pose shift(std::uint32_t l) const {
    return parent_joint_[l] == none ? Pose() : m_.joints[parent_joint_[l]].X_CJ;
  }
  Pose shifted(std::uint32_t l, const Pose& X_LC) const {
    const Pose X = shift(l);
    return X == Pose() ? X_LC : inverse(X) * X_LC;
  }

  /// Frames without mass get a trifle from the reader of URDF; here they become frames again.
  bool is_frame(std::uint32_t l) const {
    return joined_[l] && m_.links[l].inertial.mass_kg < 1e-11 * total_kg_;
  }

  bool write_geometry(const Shape& shape, const std::string& owner, const Place& place, Xml& out) {
    Xml geometry = element("geometry");
    Xml& form = add(geometry, shape_name(shape));
    const auto set = [&](const char* key, double x) { form.set_attribute(key, number_text(x)); };
    if (const auto* const box = std::get_if<Box>(&shape)) form.set_attribute("size", text_of(box->size_m));
    else if (const auto* const ball = std::get_if<Sphere>(&shape)) set("radius", ball->radius_m);
    else if (const auto* const can = std::get_if<Cylinder>(&shape))
      set("radius", can->radius_m), set("length", can->length_m);
    else if (const auto* const pill = std::get_if<Capsule>(&shape))
      set("radius", pill->radius_m), set("length", pill->length_m);
    else if (const auto* const mesh = std::get_if<Mesh>(&shape)) {
      const TriangleMesh& m = *mesh->mesh;
      if (m.source.empty()) {
        warn(owner + ": its triangles came from no mesh file", "it is left out", place);
        return false;
      }
      form.set_attribute("filename", m.source);
      if (m.source_scale != Vec3{1, 1, 1}) form.set_attribute("scale", text_of(m.source_scale));
      if (!m.source_part.empty() || m.is_hull)
        warn(owner + ": URDF names whole mesh files only",
             "the part or hull of '" + m.source + "' becomes all of it", place);
    } else {
      warn(owner + ": URDF has no shape " + std::string(shape_name(shape)), "it is left out", place);
      return false;
    }
    add(out, std::move(geometry));
    return true;
  }

  void write_link(std::uint32_t l) {
    const model::Link& link = m_.links[l];
    Xml out = element("link");
    Xml extra = element("gazebo");
    out.set_attribute("name", plain(link.name));
    extra.set_attribute("reference", plain(link.name));
    if (!is_frame(l)) {
      Xml& inertial = add(out, "inertial");
      add_origin(inertial, shifted(l, link.inertial.X_LCo));
      add(inertial, "mass").set_attribute("value", number_text(link.inertial.mass_kg));
      Xml& tensor = add(inertial, "inertia");
      const Xml said = inertial_of(link.inertial);
      for (const Xml& moment : said.child("inertia")->children)
        tensor.set_attribute(moment.name, moment.text);
    }
    if (!link.gravity) add(extra, "turnGravityOff", "true");
    for (const model::Visual& visual : link.visuals) {
      Xml each = element("visual");
      each.set_attribute("name", visual.name);
      add_origin(each, shifted(l, visual.X_LC));
      if (!write_geometry(visual.shape, "visual '" + visual.name + "'", visual.place, each)) continue;
      if (material_of(visual.material)) {
        Xml& material = add(each, "material");
        material.set_attribute("name", plain(link.name) + "_" + visual.name);
        add(material, "color").set_attribute("rgba", text_of(visual.material.diffuse));
        if (!visual.material.texture.empty())
          add(material, "texture").set_attribute("filename", visual.material.texture);
      }
      add(out, std::move(each));
    }
    for (const model::Collision& collision : link.collisions) {
      Xml each = element("collision");
      each.set_attribute("name", collision.name);
      add_origin(each, shifted(l, collision.X_LC));
      if (!write_geometry(collision.shape, "collision '" + collision.name + "'", collision.place, each))
        continue;
      add(out, std::move(each));
      if (auto surface = surface_of(collision.surface)) {
        Xml& said = add(extra, "collision");
        said.set_attribute("name", collision.name);
        add(said, std::move(*surface));
      }
    }
    add(out_, std::move(out));
    for (const model::LinkLight& light : m_.lights) {
      if (light.link != l) continue;
      model::Light moved = light.light;
      moved.X_PLight = shifted(l, moved.X_PLight);
      add(extra, light_of(moved));
    }
    if (!extra.children.empty()) extras_.push_back(std::move(extra));
  }

  void write_joint(const model::Joint& joint) {
    using Type = model::JointType;
    const bool to_world = joint.parent == model::world_link;
    const bool unlimited_turn = joint.type == Type::revolute && joint.lower <= -unlimited &&
                                joint.upper >= unlimited;
    const bool continuous = joint.type == Type::continuous || unlimited_turn;
    Xml& out = add(out_, "joint");
    out.set_attribute("name", plain(joint.name));
    out.set_attribute("type", joint.type == Type::fixed       ? "fixed"
                              : joint.type == Type::prismatic ? "prismatic"
                              : continuous                    ? "continuous"
                                                              : "revolute");
    const Pose X_MC = m_.links[joint.child].X_ML * joint.X_CJ;
    const Pose X_MP = to_world ? Pose() : m_.links[joint.parent].X_ML * shift(joint.parent);
    add_origin(out, X_MP == Pose() ? X_MC : inverse(X_MP) * X_MC);
    add(out, "parent").set_attribute("link", to_world ? "world" : plain(m_.links[joint.parent].name));
    add(out, "child").set_attribute("link", plain(m_.links[joint.child].name));
    if (joint.type == Type::fixed) return;
    add(out, "axis").set_attribute("xyz", direction_text(joint.axis_J));
    Xml limit = element("limit");
    if (!continuous) {
      limit.set_attribute("lower", number_text(joint.lower));
      limit.set_attribute("upper", number_text(joint.upper));
    }
    limit.set_attribute("effort", number_text(joint.max_effort));
    limit.set_attribute("velocity", number_text(joint.max_velocity));
    if (!continuous || joint.max_effort != unlimited || joint.max_velocity != unlimited)
      add(out, std::move(limit));
    if (joint.damping != 0 || joint.friction != 0) {
      Xml& dynamics = add(out, "dynamics");
      dynamics.set_attribute("damping", number_text(joint.damping));
      dynamics.set_attribute("friction", number_text(joint.friction));
    }
    if (joint.safety) {
      Xml& safety = add(out, "safety_controller");
      if (joint.safety->soft_lower != -unlimited)
        safety.set_attribute("soft_lower_limit", number_text(joint.safety->soft_lower));
      if (joint.safety->soft_upper != unlimited)
        safety.set_attribute("soft_upper_limit", number_text(joint.safety->soft_upper));
      safety.set_attribute("k_position", number_text(joint.safety->k_position));
      safety.set_attribute("k_velocity", number_text(joint.safety->k_velocity));
    }
    if (joint.mimic) {
      Xml& mimic = add(out, "mimic");
      mimic.set_attribute("joint", plain(m_.joints[joint.mimic->joint].name));
      mimic.set_attribute("multiplier", number_text(joint.mimic->multiplier));
      mimic.set_attribute(
          "offset", number_text(joint.mimic->offset - joint.mimic->multiplier * joint.mimic->reference));
    }
    if (joint.spring_stiffness != 0 || joint.spring_reference != 0) {
      Xml extra = element("gazebo");
      extra.set_attribute("reference", plain(joint.name));
      add_number(extra, "springStiffness", joint.spring_stiffness);
      add_number(extra, "springReference", joint.spring_reference);
      extras_.push_back(std::move(extra));
    }
  }

  /// A frame of SDF is a link without mass in URDF.
  void write_frame(const model::Frame& frame) {
    const std::string name = plain(frame.name);
    add(out_, "link").set_attribute("name", name);
    Xml& joint = add(out_, "joint");
    joint.set_attribute("name", name + "_joint");
    joint.set_attribute("type", "fixed");
    add_origin(joint, shifted(frame.link, frame.X_LF));
    add(joint, "parent").set_attribute("link", plain(m_.links[frame.link].name));
    add(joint, "child").set_attribute("link", name);
  }

  void write_rest() {
    for (Xml& extra : extras_) add(out_, std::move(extra));
    for (const model::DeviceDecl& device : instance_.devices) {
      Xml& gazebo = add(out_, "gazebo");
      const bool on_link = is_native(device) || is_sensor(device);
      const std::string joint = is_native(device) ? "" : joint_of(device);
      if (on_link)
        gazebo.set_attribute("reference", joint.empty() ? plain(m_.links[device.link].name) : plain(joint));
      add(gazebo, device_of(device, shifted(device.link, device.X_LS)));
    }
    if (m_.is_static) add(add(out_, "gazebo"), "static", "true");
    if (m_.self_collide) add(add(out_, "gazebo"), "self_collide", "true");
  }

  const model::Instance& instance_;
  const model::Model& m_;
  Diagnostics& diagnostics_;
  Xml out_;
  std::vector<Xml> extras_;
  std::vector<std::uint32_t> parent_joint_;  ///< per link
  std::vector<bool> joined_;                 ///< per link: by a fixed joint
  double total_kg_ = 0;
  bool on_world_ = false;
};

}  // namespace

Result<Xml> urdf_of(const model::Instance& instance, Diagnostics& diagnostics) {
  return UrdfWriter(instance, diagnostics).write();
}

}  // namespace sandlot::formats
