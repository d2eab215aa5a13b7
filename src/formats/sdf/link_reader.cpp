#include "formats/sdf/model_reader.h"

namespace sandlot::formats {
namespace {

constexpr double water_kgpm3 = 1000;
constexpr Range density_range{0, 1e6, true};

Status read_friction(const Xml& friction, model::Surface& out, Notes& notes) {
  notes.unused(friction, "ode", "bullet torsional");
  if (const Xml* const torsional = friction.child("torsional"))
    notes.warn(*torsional, "<torsional> friction is not used");
  const Xml* const ode = friction.child("ode");
  if (!ode) return {};
  notes.unused(*ode, "mu mu2 fdir1 slip1 slip2");
  SL_TRY(read_capped(*ode, "mu", not_negative, out.mu));
  // SDF's default for mu2 is 1 whatever mu is; who gives only mu means both directions.
  out.mu2 = out.mu;
  SL_TRY(read_capped(*ode, "mu2", not_negative, out.mu2));
  SL_TRY(read_child(*ode, "fdir1", position_range, out.fdir1));
  SL_TRY(read_capped(*ode, "slip1", not_negative, out.slip1));
  SL_TRY(read_capped(*ode, "slip2", not_negative, out.slip2));
  if (norm(out.fdir1) > 0) out.fdir1 = normalised(out.fdir1);
  return {};
}

/// Masks that let some things pass through others are not known to the engines.
void read_bitmask(const Xml& contact, Notes& notes) {
  for (const char* const key : {"collide_bitmask", "category_bitmask"}) {
    const Xml* const mask = contact.child(key);
    const bool all = !mask || mask->text == "65535" || mask->text == "0xFFFF" || mask->text == "0xffff";
    if (!all)
      notes.warn(*mask, std::string("<") + key + "> is not used", "everything collides with everything", key);
  }
}

}  // namespace

Result<model::Surface> read_surface(const Xml& collision, Notes& notes) {
  model::Surface out;
  const Xml* const surface = collision.child("surface");
  if (!surface) return out;
  notes.unused(*surface, "friction bounce contact", "soft_contact");
  if (const Xml* const friction = surface->child("friction")) SL_TRY(read_friction(*friction, out, notes));
  if (const Xml* const bounce = surface->child("bounce")) {
    notes.unused(*bounce, "restitution_coefficient threshold");
    SL_TRY(read_child(*bounce, "restitution_coefficient", {0, 1}, out.restitution));
    SL_TRY(read_capped(*bounce, "threshold", not_negative, out.restitution_threshold_mps));
  }
  if (const Xml* const contact = surface->child("contact")) {
    notes.unused(*contact, "ode",
                 "bullet collide_bitmask category_bitmask collide_without_contact "
                 "collide_without_contact_bitmask poissons_ratio elastic_modulus");
    read_bitmask(*contact, notes);
    if (const Xml* const ode = contact->child("ode")) {
      notes.unused(*ode, "soft_cfm soft_erp", "kp kd max_vel min_depth");
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

namespace {

/// The shapes of a collision or visual, named after it: the pieces of a mesh beyond the first get a number.
template <class Part>
Result<std::vector<Part>> read_parts(const Xml& element, const Part& pattern, Pose X_LG, const Reading& in) {
  SL_ASSIGN(const std::vector<Shape> shapes, read_shapes(element, X_LG, in));
  std::vector<Part> out;
  for (const Shape& shape : shapes) {
    Part part = pattern;
    if (!out.empty()) part.name += "_" + std::to_string(out.size() + 1);
    part.shape = shape;
    part.X_LC = X_LG;
    out.push_back(std::move(part));
  }
  return out;
}

Status read_collision(const Xml& element, model::Link& link, std::vector<double>& densities, double density,
                      const Reading& in) {
  in.notes.unused(element, "pose geometry surface density", "laser_retro max_contacts auto_inertia_params");
  model::Collision pattern{*element.attribute("name"), {}, Sphere{1}, {}, element.place};
  SL_ASSIGN(const Pose X_LC, in.pose(element));
  SL_ASSIGN(pattern.surface, read_surface(element, in.notes));
  SL_TRY(read_child(element, "density", density_range, density));
  SL_ASSIGN(std::vector<model::Collision> parts, read_parts(element, pattern, X_LC, in));
  for (model::Collision& part : parts) {
    link.collisions.push_back(std::move(part));
    densities.push_back(density);
  }
  return {};
}

Status read_visual(const Xml& element, model::Link& link, const Reading& in) {
  in.notes.unused(element, "pose geometry material transparency cast_shadows",
                  "laser_retro meta visibility_flags plugin");
  model::Visual pattern{*element.attribute("name"), {}, Sphere{1}, {}, true, element.place};
  SL_ASSIGN(const Pose X_LC, in.pose(element));
  SL_ASSIGN(pattern.material, read_material(element, in));
  SL_TRY(read_child(element, "cast_shadows", pattern.cast_shadows));
  SL_ASSIGN(std::vector<model::Visual> parts, read_parts(element, pattern, X_LC, in));
  for (model::Visual& part : parts) link.visuals.push_back(std::move(part));
  return {};
}

}  // namespace

Result<model::Link> read_link(const Xml& element, bool is_static, const Reading& in) {
  in.notes.unused(element, "pose inertial gravity collision* visual* sensor* light* plugin*",
                  "velocity_decay must_be_base_link self_collide kinematic enable_wind audio_source "
                  "audio_sink");
  model::Link link;
  link.name = *element.attribute("name");
  link.place = element.place;
  SL_ASSIGN(link.X_ML, in.pose(element));
  SL_TRY(read_child(element, "gravity", link.gravity));
  double density = water_kgpm3;
  const Xml* const inertial = element.child("inertial");
  if (inertial) SL_TRY(read_child(*inertial, "density", density_range, density));
  std::vector<double> densities;
  for (const Xml& child : element.children) {
    if (child.name == "collision") SL_TRY(read_collision(child, link, densities, density, in));
    if (child.name == "visual") SL_TRY(read_visual(child, link, in));
    if (child.name == "plugin") {
      const std::string* const name = child.attribute("name");
      in.notes.warn(child, "plugin '" + (name ? name->substr(0, 100) : "") + "' of a link is not used",
                    "plugins stand in the <model>", "link plugin");
    }
  }
  SL_ASSIGN(link.inertial, read_inertial(element, link, densities, is_static, in));
  return link;
}

}  // namespace sandlot::formats
