#include <algorithm>

#include <Eigen/Eigenvalues>

#include "base/text.h"
#include "formats/sdf/model_reader.h"

namespace sandlot::formats {
namespace {

constexpr Range mass_range{0, 1e8, true};
constexpr Range moment_range{-1e12, 1e12};

/// Files round their moments: a flat plate's largest is the sum of the others, up to the last digit written.
constexpr double triangle_slack = 0.01;

Status check_inertia(const Xml& inertia, const model::Inertial& inertial) {
  const Vec3 d = inertial.moments, p = inertial.products;
  Eigen::Matrix3d tensor;
  tensor << d.x, p.x, p.y, p.x, d.y, p.z, p.y, p.z, d.z;
  const Eigen::Vector3d moments =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(tensor, Eigen::EigenvaluesOnly).eigenvalues();
  const std::string shown = number_text(moments[0]) + ", " + number_text(moments[1]) + ", " +
                            number_text(moments[2]);
  if (!(moments[0] > 0))
    return inertia.error("inertia is not physical: its principal moments are " + shown,
                         "all must be above 0");
  if (moments[0] + moments[1] < moments[2] * (1 - triangle_slack))
    return inertia.error("inertia is not physical: its principal moments are " + shown,
                         "no body has one that is larger than the sum of the others");
  return {};
}

Result<model::Inertial> read_inertial(const Xml& link, bool is_static, Notes& notes) {
  model::Inertial out;
  const Xml* const inertial = link.child("inertial");
  const auto missing = [&](const Xml& at, const char* what, const char* standing_in) {
    if (!is_static) notes.warn(at, "link '" + *link.attribute("name") + "' has no " + what, standing_in);
  };
  if (!inertial) {
    missing(link, "<inertial>", "taken as 1 kg with moments of 1 kg m^2");
    return out;
  }
  notes.unused(*inertial, "mass pose inertia", "frame");
  SL_TRY(read_child(*inertial, "mass", mass_range, out.mass_kg));
  SL_ASSIGN(out.X_LCo, read_child_pose(*inertial));
  const Xml* const inertia = inertial->child("inertia");
  if (!inertia) {
    missing(*inertial, "<inertia>", "its moments are taken as 1 kg m^2");
    return out;
  }
  notes.unused(*inertia, "ixx ixy ixz iyy iyz izz");
  SL_TRY(read_child(*inertia, "ixx", moment_range, out.moments.x));
  SL_TRY(read_child(*inertia, "iyy", moment_range, out.moments.y));
  SL_TRY(read_child(*inertia, "izz", moment_range, out.moments.z));
  SL_TRY(read_child(*inertia, "ixy", moment_range, out.products.x));
  SL_TRY(read_child(*inertia, "ixz", moment_range, out.products.y));
  SL_TRY(read_child(*inertia, "iyz", moment_range, out.products.z));
  if (!is_static) SL_TRY(check_inertia(*inertia, out));
  return out;
}

Status read_friction(const Xml& friction, model::Surface& out, Notes& notes) {
  notes.unused(friction, "ode", "bullet");
  const Xml* const ode = friction.child("ode");
  if (!ode) return {};
  notes.unused(*ode, "mu mu2 fdir1 slip1 slip2");
  SL_TRY(read_child(*ode, "mu", not_negative, out.mu));
  // SDF's default for mu2 is 1 whatever mu is; who gives only mu means both directions.
  out.mu2 = out.mu;
  SL_TRY(read_child(*ode, "mu2", not_negative, out.mu2));
  SL_TRY(read_child(*ode, "fdir1", position_range, out.fdir1));
  SL_TRY(read_child(*ode, "slip1", not_negative, out.slip1));
  SL_TRY(read_child(*ode, "slip2", not_negative, out.slip2));
  if (norm(out.fdir1) > 0) out.fdir1 = normalised(out.fdir1);
  return {};
}

Result<model::Surface> read_surface(const Xml& collision, Notes& notes) {
  model::Surface out;
  const Xml* const surface = collision.child("surface");
  if (!surface) return out;
  notes.unused(*surface, "friction bounce contact");
  if (const Xml* const friction = surface->child("friction")) SL_TRY(read_friction(*friction, out, notes));
  if (const Xml* const bounce = surface->child("bounce")) {
    notes.unused(*bounce, "restitution_coefficient threshold");
    SL_TRY(read_child(*bounce, "restitution_coefficient", {0, 1}, out.restitution));
    SL_TRY(read_child(*bounce, "threshold", not_negative, out.restitution_threshold_mps));
  }
  if (const Xml* const contact = surface->child("contact")) {
    notes.unused(*contact, "ode", "bullet");
    if (const Xml* const ode = contact->child("ode")) {
      notes.unused(*ode, "soft_cfm soft_erp");
      double value = 0;
      if (const Xml* const cfm = ode->child("soft_cfm")) {
        SL_ASSIGN(value, read_double(*cfm, {0, 1e6}));
        out.soft_cfm = value;
      }
      if (const Xml* const erp = ode->child("soft_erp")) {
        SL_ASSIGN(value, read_double(*erp, {0, 1}));
        out.soft_erp = value;
      }
    }
  }
  return out;
}

Result<model::Material> read_material(const Xml& visual) {
  model::Material out;
  double transparency = 0;
  SL_TRY(read_child(visual, "transparency", {0, 1}, transparency));
  if (const Xml* const material = visual.child("material")) {
    const Xml* const diffuse = material->child("diffuse");
    const Xml* const color = diffuse ? diffuse : material->child("ambient");
    if (color) { SL_ASSIGN(out.diffuse, read_color(*color)); }
    out.from_mesh = false;
  }
  out.diffuse.a *= static_cast<float>(1 - transparency);
  return out;
}

Result<Pose> pose_of(const Xml& element, const ResolvedFrames& frames) {
  const auto resolved = frames.poses.find(&element);
  if (resolved != frames.poses.end()) return resolved->second;
  return read_child_pose(element);
}

}  // namespace

Result<std::optional<Shape>> read_shape(const Xml& owner, Notes& notes) {
  const Xml* const geometry = owner.child("geometry");
  const std::string said = "<" + owner.name + "> '" + *owner.attribute("name") + "'";
  if (!geometry)
    return owner.error(said + " has no <geometry>",
                       "give it a <box>, <sphere>, <cylinder>, <capsule> or <plane>");
  if (geometry->children.empty())
    return geometry->error("<geometry> is empty",
                           "give it a <box>, <sphere>, <cylinder>, <capsule> or <plane>");
  const Xml& form = geometry->children.front();
  if (geometry->children.size() > 1)
    notes.warn(geometry->children[1], "a second shape in one <geometry> is not used");
  const auto need = [&](const char* key) -> Result<double> {
    const Xml* const child = form.child(key);
    if (!child) return form.error("<" + form.name + "> has no <" + key + ">");
    return read_double(*child, size_range);
  };
  if (form.name == "box") {
    notes.unused(form, "size");
    const Xml* const size = form.child("size");
    if (!size) return form.error("<box> has no <size>", "write <size>x y z</size>");
    SL_ASSIGN(const Vec3 edges, read_vec3(*size, size_range));
    return std::optional<Shape>(Box{edges});
  }
  if (form.name == "sphere") {
    notes.unused(form, "radius");
    SL_ASSIGN(const double radius, need("radius"));
    return std::optional<Shape>(Sphere{radius});
  }
  if (form.name == "cylinder" || form.name == "capsule") {
    notes.unused(form, "radius length");
    SL_ASSIGN(const double radius, need("radius"));
    SL_ASSIGN(const double length, need("length"));
    if (form.name == "cylinder") return std::optional<Shape>(Cylinder{radius, length});
    return std::optional<Shape>(Capsule{radius, length});
  }
  if (form.name == "plane") {
    notes.unused(form, "normal size");
    Vec3 normal{0, 0, 1};
    SL_TRY(read_child(form, "normal", position_range, normal));
    if (!(norm(normal) > 1e-6))
      return form.error("the normal of this <plane> is zero", "write <normal>0 0 1</normal>");
    return std::optional<Shape>(Plane{normalised(normal)});
  }
  static const std::vector<std::string> known{"box",   "sphere",   "cylinder",  "capsule",
                                              "plane", "mesh",     "heightmap", "ellipsoid",
                                              "cone",  "polyline", "image",     "empty"};
  if (std::find(known.begin(), known.end(), form.name) == known.end())
    return form.error("unknown geometry <" + form.name.substr(0, 60) + ">", suggestion(form.name, known));
  if (form.name != "empty")
    notes.warn(form, "geometry <" + form.name + "> is not supported yet", said + " is left out");
  return std::optional<Shape>();
}

Result<model::Link> read_link(const Xml& element, const ResolvedFrames& frames, bool is_static,
                              Notes& notes) {
  notes.unused(element, "pose inertial gravity collision* visual* sensor*",
               "velocity_decay must_be_base_link self_collide kinematic enable_wind");
  model::Link link;
  link.name = *element.attribute("name");
  link.place = element.place;
  SL_ASSIGN(link.X_ML, pose_of(element, frames));
  SL_ASSIGN(link.inertial, read_inertial(element, is_static, notes));
  SL_TRY(read_child(element, "gravity", link.gravity));
  for (const Xml& child : element.children) {
    if (child.name == "collision") {
      notes.unused(child, "pose geometry surface", "laser_retro max_contacts");
      SL_ASSIGN(const std::optional<Shape> shape, read_shape(child, notes));
      model::Collision collision{*child.attribute("name"), {}, Sphere{1}, {}, child.place};
      SL_ASSIGN(collision.X_LC, pose_of(child, frames));
      SL_ASSIGN(collision.surface, read_surface(child, notes));
      if (!shape) continue;
      collision.shape = *shape;
      link.collisions.push_back(std::move(collision));
    } else if (child.name == "visual") {
      notes.unused(child, "pose geometry material transparency",
                   "cast_shadows laser_retro meta visibility_flags plugin");
      SL_ASSIGN(const std::optional<Shape> shape, read_shape(child, notes));
      model::Visual visual{*child.attribute("name"), {}, Sphere{1}, {}, true, child.place};
      SL_ASSIGN(visual.X_LC, pose_of(child, frames));
      SL_ASSIGN(visual.material, read_material(child));
      if (!shape) continue;
      visual.shape = *shape;
      link.visuals.push_back(std::move(visual));
    }
  }
  return link;
}

}  // namespace sandlot::formats
