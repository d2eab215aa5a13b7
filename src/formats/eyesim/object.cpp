/// Objects of EyeSim: a mesh with its mass, collider and scale.
#include <cmath>

#include "base/text.h"
#include "builders/parts.h"
#include "formats/eyesim/robi.h"
#include "formats/eyesim/shapes.h"

namespace sandlot::formats::eyesim {
namespace {

struct Object {
  std::string name = "object", mesh;
  std::optional<Line> mesh_line;
  double scale = 1, mass_kg = 1;
  std::optional<Vec3> centre_m;
  std::vector<std::pair<Shape, Pose>> solids;
  bool fixed = false;
};

Vec3 point(const std::vector<double>& n, std::size_t first) {
  return from_model_space({n[first] * mm, n[first + 1] * mm, n[first + 2] * mm});
}

Status collider(const Line& line, Object& out) {
  const std::string kind = line.arguments() < 1 ? "" : lower(line.words[1]);
  std::string axis = "y";
  Line numbers = line;
  if (kind == "capsule" && line.arguments() >= 1 && !is_number(line.words.back())) {
    axis = lower(line.words.back());
    numbers.words.pop_back();
  }
  SL_ASSIGN(const std::vector<double> n, numbers_from(numbers, 2));
  const std::size_t sizes = kind == "box" ? 3 : kind == "capsule" ? 2 : 1;
  if (kind != "box" && kind != "capsule" && kind != "sphere")
    return line.error("'" + kind.substr(0, 40) + "' is not a collider", "known are box, sphere and capsule");
  if (n.size() < sizes + 3)
    return line.error("a collider " + kind + " has its centre and its size", "all in mm");
  for (std::size_t i = 3; i < 3 + sizes; ++i)
    if (!(n[i] > 0)) return line.error("the size of a collider is above 0");
  Pose X{point(n, 0), {}};
  if (kind == "box") {
    out.solids.emplace_back(Box{{n[5] * mm, n[3] * mm, n[4] * mm}}, X);
  } else if (kind == "sphere") {
    out.solids.emplace_back(Sphere{n[3] * mm}, X);
  } else {
    if (axis != "x" && axis != "y" && axis != "z") return line.error("the axis of a capsule is x, y or z");
    const Vec3 along = from_model_space(axis == "x"   ? Vec3{1, 0, 0}
                                        : axis == "y" ? Vec3{0, 1, 0}
                                                      : Vec3{0, 0, 1});
    X.q = quat_between({0, 0, 1}, along);
    const double length = std::max(0.0, n[4] - 2 * n[3]) * mm;
    if (length > 0) out.solids.emplace_back(Capsule{n[3] * mm, length}, X);
    else out.solids.emplace_back(Sphere{n[3] * mm}, X);
  }
  return {};
}

Status take(const Line& line, Object& out, Diagnostics& diagnostics) {
  const std::string word = lower(line.keyword());
  if (word == "obj" || word == "name") {
    if (line.arguments() < 1 || line.words[1].empty()) return line.error("'" + word + "' is empty");
    (word == "obj" ? out.mesh : out.name) = line.words[1];
    if (word == "obj") out.mesh_line = line;
    return {};
  }
  if (word == "scale") {
    SL_ASSIGN(out.scale, number_at(line, 1, "a factor"));
    return out.scale > 0 ? Status() : line.error("a scale is above 0");
  }
  if (word == "mass") {
    SL_ASSIGN(out.mass_kg, number_at(line, 1, "a mass in kg"));
    if (!(out.mass_kg > 0))
      return line.error("the mass of an object is above 0", "'fixed' keeps it in its place");
    SL_ASSIGN(const std::vector<double> n, numbers_from(line, 2));
    if (n.size() >= 3) out.centre_m = point(n, 0);
    return {};
  }
  if (word == "collider") return collider(line, out);
  if (word == "fixed") return out.fixed = true, Status();
  if (word == "buoyancy") {
    SL_ASSIGN(const double volume, number_at(line, 1, "a volume"));
    if (volume != 0) diagnostics.warn(line.error("there is no water: 'buoyancy' is left out"));
    return {};
  }
  warn_unknown(line, diagnostics);
  return {};
}

}  // namespace

Result<model::Instance> read_object(std::string_view text, const std::string& file,
                                    const ReadOptions& options, Diagnostics& diagnostics) {
  SL_ASSIGN(const std::vector<Line> lines, lines_of(text, file));
  Object object;
  for (const Line& line : lines) SL_TRY(take(line, object, diagnostics));
  const auto nowhere = std::make_shared<const std::string>(file);
  std::shared_ptr<const TriangleMesh> mesh;
  if (object.mesh_line) {
    const double scale = object.scale * mm;
    SL_ASSIGN(mesh, mesh_of(*object.mesh_line, object.mesh, {scale, scale, scale}, file, options, diagnostics,
                            !object.solids.empty()));
  }
  if (!mesh && object.solids.empty())
    return Error{"the object has neither a mesh nor a collider", "name a mesh: obj can.obj", {nowhere, 0, 0}};
  model::Model model;
  model.name = object.name;
  model.is_static = object.fixed;
  model.place = lines.front().place;
  const std::uint32_t link = builders::add_link(model, "link", {});
  double whole = 0;
  for (const auto& [shape, X] : object.solids) whole += volume_m3(shape);
  for (const auto& [shape, X] : object.solids)
    builders::add_part(model, link,
                       {.shape = shape,
                        .X_LP = X,
                        .mass_kg = object.mass_kg * volume_m3(shape) / whole,
                        .color = builders::colors::teal,
                        .shown = !mesh});
  if (mesh && object.solids.empty())
    builders::add_part(model, link,
                       {.shape = Mesh{mesh}, .X_LP = {{}, from_mesh_space}, .mass_kg = object.mass_kg});
  else if (mesh)
    model.links[link].visuals.push_back({"model", {{}, from_mesh_space}, Mesh{mesh}, {}, true, {}});
  if (object.centre_m) model.links[link].inertial.X_LCo.p = *object.centre_m;
  model::Instance out;
  out.name = out.original_name = object.name;
  out.place = model.place;
  out.model = std::make_shared<const model::Model>(std::move(model));
  return out;
}

}  // namespace sandlot::formats::eyesim
