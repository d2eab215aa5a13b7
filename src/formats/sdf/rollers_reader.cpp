/// <sandlot:rollers> of a joint: omni and Mecanum wheels.
#include <algorithm>

#include "base/math.h"
#include "base/text.h"
#include "formats/sdf/reading.h"

namespace sandlot::formats {
namespace {

Result<int> read_count(const Xml& element, int least, int most) {
  SL_ASSIGN(const double x, read_double(element, {-1e6, 1e6}));
  if (x != std::floor(x) || x < least || x > most)
    return element.error("<" + element.name + "> is " + number_text(x),
                         "a whole number from " + std::to_string(least) + " to " + std::to_string(most));
  return static_cast<int>(x);
}

Status read_angle(const Xml& element, double& out) {
  SL_ASSIGN(out, read_double(element, angle_range));
  const std::string* const degrees = element.attribute("degrees");
  if (degrees && (*degrees == "true" || *degrees == "1")) out *= math::pi / 180;
  return {};
}

}  // namespace

Status read_rollers(const Xml& joint, model::Joint& out, const Reading& in) {
  const Xml* const rollers = joint.child("sandlot:rollers");
  if (!rollers) return {};
  static const std::vector<std::string> known{
      "radius",        "count",         "rows",        "row_spacing",      "angle",
      "roller_radius", "roller_length", "roller_mass", "bearing_friction", "surface"};
  for (const Xml& child : rollers->children)
    if (std::find(known.begin(), known.end(), child.name) == known.end())
      return child.error("<sandlot:rollers> has no <" + child.name.substr(0, 60) + ">",
                         suggestion(child.name, known));
  for (const char* const key : {"radius", "count", "roller_radius", "roller_length"})
    if (!rollers->child(key))
      return rollers->error(
          "<sandlot:rollers> has no <" + std::string(key) + ">",
          "it needs <radius> (of the wheel, over the rollers), <count> (per row), <roller_radius> "
          "and <roller_length>");
  in.notes.unused(
      *rollers,
      "radius count rows row_spacing angle roller_radius roller_length roller_mass bearing_friction "
      "surface");
  model::RollerWheel wheel;
  SL_TRY(read_child(*rollers, "radius", size_range, wheel.radius_m));
  SL_ASSIGN(wheel.count, read_count(*rollers->child("count"), 2, 200));
  if (const Xml* const rows = rollers->child("rows")) { SL_ASSIGN(wheel.rows, read_count(*rows, 1, 8)); }
  SL_TRY(read_child(*rollers, "row_spacing", size_range, wheel.row_spacing_m));
  if (const Xml* const angle = rollers->child("angle")) SL_TRY(read_angle(*angle, wheel.angle_rad));
  SL_TRY(read_child(*rollers, "roller_radius", size_range, wheel.roller_radius_m));
  SL_TRY(read_child(*rollers, "roller_length", size_range, wheel.roller_length_m));
  SL_TRY(read_child(*rollers, "roller_mass", size_range, wheel.roller_mass_kg));
  SL_TRY(read_child(*rollers, "bearing_friction", not_negative, wheel.bearing_friction_Nm));
  SL_ASSIGN(wheel.surface, read_surface(*rollers, in.notes));
  out.rollers = wheel;
  return {};
}

}  // namespace sandlot::formats
