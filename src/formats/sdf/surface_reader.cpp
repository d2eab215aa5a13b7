/// <surface>: SDF's own elements, and Sandlot's in its namespace.
#include "formats/sdf/reading.h"
#include "model/substance.h"

namespace sandlot::formats {
namespace {

/// SDF's default of kp, and what files write for "as hard as can be".
constexpr double hard_N_per_m = 1e12;

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

Status read_contact(const Xml& ode, model::Surface& out, Notes& notes) {
  notes.unused(ode, "soft_cfm soft_erp kp kd max_vel", "min_depth");
  const auto read = [&](const char* key, Range range, std::optional<double>& value) -> Status {
    const Xml* const element = ode.child(key);
    if (!element) return {};
    SL_ASSIGN(value, read_double(*element, range));
    return {};
  };
  SL_TRY(read("soft_cfm", {0, 1e6}, out.soft_cfm));
  SL_TRY(read("soft_erp", {0, 1}, out.soft_erp));
  double kp = hard_N_per_m;
  SL_TRY(read_capped(ode, "kp", not_negative, kp));
  if (kp < hard_N_per_m) {
    if (!(kp > 0)) return ode.child("kp")->error("a stiffness of 0 holds nothing", "kp is in N/m: 1e5");
    out.stiffness_N_per_m = kp;
    out.damping_N_s_per_m = 1;  // SDF's default
    SL_TRY(read_capped(ode, "kd", not_negative, *out.damping_N_s_per_m));
  }
  SL_TRY(read("max_vel", not_negative, out.max_correction_mps));
  return {};
}

Status read_skin(const Xml& element, model::Surface& out) {
  model::Skin skin;
  SL_TRY(read_child(element, "axis", position_range, skin.axis));
  if (!(norm(skin.axis) > 0))
    return element.child("axis")->error("the axis has no length", "give it a direction: 1 0 0");
  skin.axis = normalised(skin.axis);
  const Xml* const ratio = element.child("ratio");
  if (!ratio)
    return element.error("<sandlot:skin> has no <ratio>", "friction along the axis over that across: 0.1");
  SL_ASSIGN(skin.ratio, read_double(*ratio, {0, 1e3}));
  for (const Xml& child : element.children)
    if (child.name != "axis" && child.name != "ratio")
      return child.error("<sandlot:skin> has no <" + child.name.substr(0, 60) + ">",
                         "it has <axis> and <ratio>");
  out.skin = skin;
  return {};
}

Status read_own(const Xml& element, model::Surface& out, Notes& notes) {
  const std::string& name = element.name;
  if (name == "sandlot:substance") {
    auto read = model::substance_from(element.text);
    if (!read) return element.error(read.error().what, read.error().fix);
    if (!read->warning.empty()) notes.warn(element, read->warning);
    out.substance = read->substance;
  } else if (name == "sandlot:skin") {
    return read_skin(element, out);
  } else if (name == "sandlot:rolling_resistance") {
    SL_ASSIGN(out.rolling_resistance_m, read_double(element, {0, 1e3}));
  } else if (name == "sandlot:belt_velocity") {
    SL_ASSIGN(out.belt_velocity_mps, read_vec3(element, {-1e3, 1e3}));
  } else if (name == "sandlot:no_contact") {
    SL_ASSIGN(const bool none, read_flag(element));
    out.touches = !none;
  } else {
    return element.error("a <surface> has no <" + name.substr(0, 60) + ">",
                         "there are sandlot:substance, skin, rolling_resistance, belt_velocity, no_contact");
  }
  return {};
}

}  // namespace

Result<model::Surface> read_surface(const Xml& owner, Notes& notes) {
  model::Surface out;
  const Xml* const surface = owner.child("surface");
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
    if (const Xml* const ode = contact->child("ode")) SL_TRY(read_contact(*ode, out, notes));
  }
  for (const Xml& child : surface->children)
    if (child.name.rfind("sandlot:", 0) == 0) SL_TRY(read_own(child, out, notes));
  return out;
}

}  // namespace sandlot::formats
