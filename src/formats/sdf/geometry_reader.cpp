#include <algorithm>
#include <array>

#include "assets/image/image.h"
#include "assets/mesh/mesh.h"
#include "base/text.h"
#include "formats/sdf/reading.h"
#include "geometry/barrel.h"
#include "geometry/height_grid.h"
#include "geometry/mesh.h"

namespace sandlot::formats {
namespace {

constexpr const char* what_to_write =
    "give it a <box>, <sphere>, <cylinder>, <capsule>, <cone>, <ellipsoid>, <plane>, <mesh>, <heightmap>, "
    "<polyline> or <sandlot:barrel>";

/// A length that SDF has a default for.
Result<double> length_of(const Xml& form, const char* key, double standard, const Reading& in) {
  if (const Xml* const child = form.child(key)) return read_double(*child, size_range);
  in.notes.warn(form, "<" + form.name + "> has no <" + key + ">", "taken as " + number_text(standard) + " m");
  return standard;
}
Result<Vec3> lengths_of(const Xml& form, const char* key, const Reading& in) {
  if (const Xml* const child = form.child(key)) return read_vec3(*child, size_range);
  in.notes.warn(form, "<" + form.name + "> has no <" + key + ">", "taken as 1 1 1 m");
  return Vec3{1, 1, 1};
}

/// The shapes that need no file.
Result<std::optional<Shape>> read_primitive(const Xml& form, const Reading& in) {
  if (form.name == "box") {
    in.notes.unused(form, "size");
    SL_ASSIGN(const Vec3 edges, lengths_of(form, "size", in));
    return std::optional<Shape>(Box{edges});
  }
  if (form.name == "sphere") {
    in.notes.unused(form, "radius");
    SL_ASSIGN(const double radius, length_of(form, "radius", 1, in));
    return std::optional<Shape>(Sphere{radius});
  }
  if (form.name == "cylinder" || form.name == "capsule" || form.name == "cone") {
    in.notes.unused(form, "radius length");
    SL_ASSIGN(const double radius, length_of(form, "radius", form.name == "cylinder" ? 1 : 0.5, in));
    SL_ASSIGN(const double length, length_of(form, "length", 1, in));
    if (form.name == "cylinder") return std::optional<Shape>(Cylinder{radius, length});
    if (form.name == "capsule") return std::optional<Shape>(Capsule{radius, length});
    return std::optional<Shape>(Cone{radius, length});
  }
  if (form.name == "sandlot:barrel") {
    in.notes.unused(form, "radius profile length");
    for (const char* const key : {"radius", "profile", "length"})
      if (!form.child(key))
        return form.error("<sandlot:barrel> has no <" + std::string(key) + ">",
                          "it needs <radius>, <profile> (radius of the arc it is turned from) and <length>");
    SL_ASSIGN(const double radius, read_double(*form.child("radius"), size_range));
    SL_ASSIGN(const double profile, read_double(*form.child("profile"), size_range));
    SL_ASSIGN(const double length, read_double(*form.child("length"), size_range));
    const Barrel barrel{radius, profile, length};
    if (!is_barrel(barrel))
      return form.error(
          "this <sandlot:barrel> has no such arc",
          "its <profile> must reach to both ends (half the <length>), and the radius there must not "
          "fall below 0");
    return std::optional<Shape>(barrel);
  }
  if (form.name == "ellipsoid") {
    in.notes.unused(form, "radii");
    SL_ASSIGN(const Vec3 r, lengths_of(form, "radii", in));
    return std::optional<Shape>(Ellipsoid{r});
  }
  if (form.name == "plane") {
    in.notes.unused(form, "normal size");
    Vec3 normal{0, 0, 1};
    SL_TRY(read_child(form, "normal", position_range, normal));
    if (!(norm(normal) > 1e-6))
      return form.error("the normal of this <plane> is zero", "write <normal>0 0 1</normal>");
    return std::optional<Shape>(Plane{normalised(normal)});
  }
  return std::optional<Shape>();
}

Result<std::string> uri_of(const Xml& form) {
  const Xml* const uri = form.child("uri");
  if (!uri || uri->text.empty())
    return form.error("<" + form.name + "> has no <uri>", "name the file: <uri>meshes/body.dae</uri>");
  return uri->text;
}

/// An error of a mesh or an image, with the place of the element that names it if it has no place of its own.
Error placed_at(Error error, const Xml& form) {
  if (!error.place.file) error.place = form.place;
  return error;
}

Result<std::vector<Shape>> read_mesh_use(const Xml& form, bool collision, const std::string& said,
                                         const Reading& in) {
  in.notes.unused(form, "uri scale submesh", "convex_decomposition");
  assets::MeshOptions options;
  SL_ASSIGN(const std::string uri, uri_of(form));
  SL_TRY(read_child(form, "scale", {-1e6, 1e6}, options.scale));
  if (options.scale.x == 0 || options.scale.y == 0 || options.scale.z == 0)
    return form.child("scale")->error("a <mesh> cannot have a scale of 0", "write <scale>1 1 1</scale>");
  if (const Xml* const submesh = form.child("submesh")) {
    in.notes.unused(*submesh, "name center");
    if (const Xml* const name = submesh->child("name")) options.submesh = name->text;
    SL_TRY(read_child(*submesh, "center", options.centre));
  }
  options.textures = !collision;  // a collision has no look
  assets::Simplification simplification = assets::Simplification::none;
  if (const std::string* const wanted = form.attribute("optimization")) {
    if (*wanted == "convex_hull") simplification = assets::Simplification::convex_hull;
    else if (*wanted == "convex_decomposition") simplification = assets::Simplification::convex_decomposition;
    else if (!wanted->empty() && *wanted != "none")
      return form.error("optimization '" + wanted->substr(0, 40) + "' of a mesh is not known",
                        "write convex_hull or convex_decomposition");
  }
  const std::string without = said + " is left out";
  SL_ASSIGN(const std::optional<std::string> file, in.find(*form.child("uri"), uri, without.c_str()));
  if (!file) return std::vector<Shape>{};
  auto mesh = assets::read_mesh(*file, options, in.notes.diagnostics());
  if (!mesh) return placed_at(std::move(mesh.error()), form);
  if (!collision) return std::vector<Shape>{Mesh{std::move(*mesh)}};
  auto parts = assets::collision_meshes(std::move(*mesh), simplification);
  if (!parts) return placed_at(std::move(parts.error()), form);
  std::vector<Shape> shapes;
  for (auto& part : *parts) shapes.emplace_back(Mesh{std::move(part)});
  return shapes;
}

Result<std::vector<Shape>> read_heightmap_use(const Xml& form, Pose& X_LG, const std::string& said,
                                              const Reading& in) {
  in.notes.unused(form, "uri size pos", "texture* blend* use_terrain_paging sampling");
  Vec3 size_m{1, 1, 1};  // extent in x and y, height of the brightest pixel
  SL_ASSIGN(const std::string uri, uri_of(form));
  SL_TRY(read_child(form, "size", {0, 1e6}, size_m));
  if (!(size_m.x > 0 && size_m.y > 0))
    return form.child("size")->error("a <heightmap> needs an extent in x and y",
                                     "write <size>129 129 10</size>");
  Vec3 position;
  SL_TRY(read_child(form, "pos", position_range, position));
  X_LG = X_LG * Pose{position, {}};
  const std::string without = said + " is left out";
  SL_ASSIGN(const std::optional<std::string> file, in.find(*form.child("uri"), uri, without.c_str()));
  if (!file) return std::vector<Shape>{};
  auto grid = assets::read_heightmap(*file, size_m, {}, in.notes.diagnostics());
  if (!grid) return placed_at(std::move(grid.error()), form);
  return std::vector<Shape>{Heightfield{std::make_shared<const HeightGrid>(std::move(*grid))}};
}

/// Several <polyline>s of one <geometry> are the outline and the holes in it.
Result<std::vector<Shape>> read_polylines(const Xml& geometry, const Reading& in) {
  std::vector<std::vector<std::array<double, 2>>> loops;
  double height_m = 1;
  const Xml* first = nullptr;
  for (const Xml& form : geometry.children) {
    if (form.name != "polyline") continue;
    in.notes.unused(form, "point* height");
    if (!first) SL_TRY(read_child(form, "height", size_range, height_m));
    if (!first) first = &form;
    std::vector<std::array<double, 2>> loop;
    for (const Xml& child : form.children) {
      if (child.name != "point") continue;
      SL_ASSIGN(const auto point, read_point(child, position_range));
      loop.push_back(point);
    }
    if (loop.size() < 3)
      return form.error("a <polyline> needs three points at least", "write <point>x y</point>");
    if (loop.size() > 1 && loop.front() == loop.back()) loop.pop_back();
    loops.push_back(std::move(loop));
  }
  // Files give the outline anywhere among the holes: it is the largest.
  const auto area = [](const std::vector<std::array<double, 2>>& loop) {
    double twice = 0;
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const auto &a = loop[i], &b = loop[(i + 1) % loop.size()];
      twice += a[0] * b[1] - a[1] * b[0];
    }
    return std::abs(twice);
  };
  std::stable_sort(loops.begin(), loops.end(),
                   [&](const auto& a, const auto& b) { return area(a) > area(b); });
  auto mesh = std::make_shared<TriangleMesh>(extrude(loops, height_m));
  if (mesh->triangles.empty())
    return first->error("this <polyline> bounds no area", "its lines must not cross or touch each other");
  return std::vector<Shape>{Mesh{std::move(mesh)}};
}

}  // namespace

Result<std::vector<Shape>> read_shapes(const Xml& owner, Pose& X_LG, const Reading& in) {
  const Xml* const geometry = owner.child("geometry");
  const std::string said = "<" + owner.name + "> '" + *owner.attribute("name") + "'";
  if (!geometry) return owner.error(said + " has no <geometry>", what_to_write);
  if (geometry->children.empty()) return geometry->error("<geometry> is empty", what_to_write);
  const Xml& form = geometry->children.front();
  for (const Xml& second : geometry->children)
    if (&second != &form && !(second.name == "polyline" && form.name == "polyline"))
      in.notes.warn(second, "a second shape in one <geometry> is not used");
  SL_ASSIGN(const std::optional<Shape> primitive, read_primitive(form, in));
  if (primitive) return std::vector<Shape>{*primitive};
  if (form.name == "mesh") return read_mesh_use(form, owner.name == "collision", said, in);
  if (form.name == "heightmap") return read_heightmap_use(form, X_LG, said, in);
  if (form.name == "polyline") return read_polylines(*geometry, in);
  static const std::vector<std::string> known{"box",      "sphere",    "cylinder",      "capsule",   "cone",
                                              "plane",    "ellipsoid", "mesh",          "heightmap", "image",
                                              "polyline", "empty",     "sandlot:barrel"};
  if (std::find(known.begin(), known.end(), form.name) == known.end())
    return form.error("unknown geometry <" + form.name.substr(0, 60) + ">", suggestion(form.name, known));
  if (form.name != "empty")
    in.notes.warn(form, "geometry <" + form.name + "> is not supported", said + " is left out",
                  "geometry " + form.name);
  return std::vector<Shape>{};
}

}  // namespace sandlot::formats
