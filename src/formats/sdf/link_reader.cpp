#include "formats/sdf/model_reader.h"

namespace sandlot::formats {
namespace {

constexpr double water_kgpm3 = 1000;
constexpr Range density_range{0, 1e6, true};

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
