#include <algorithm>
#include <numeric>

#include "base/text.h"
#include "formats/sdf/urdf_parts.h"

namespace sandlot::formats::urdf {
namespace {

constexpr const char* moment_keys[] = {"ixx", "iyy", "izz"};
constexpr const char* product_keys[] = {"ixy", "ixz", "iyz"};

struct Weight {
  double mass_kg = 0;
  bool has_moments = false;  ///< not all zero
};

Result<Weight> weight_of(const Xml& link) {
  Weight out;
  const Xml* const inertial = link.child("inertial");
  if (!inertial) return out;
  const Xml* const mass = inertial->child("mass");
  if (!mass)
    return inertial->error("<inertial> of link '" + link.attribute("name")->substr(0, 60) + "' has no <mass>",
                           "write <mass value=\"1\"/>");
  SL_ASSIGN(const std::string value, numbers(*mass, "value", 1, nullptr));
  out.mass_kg = values_of(value).front();
  // The SDF reader has words for this, but a negative mass must not get into sums before.
  if (out.mass_kg < 0)
    return mass->error("negative mass: " + number_text(out.mass_kg),
                       "it must be above 0; 0 makes the link a mere frame");
  const Xml* const inertia = inertial->child("inertia");
  if (!inertia) return out;
  for (const char* const key : moment_keys) {
    SL_ASSIGN(const std::string moment, numbers(*inertia, key, 1, out.mass_kg > 0 ? nullptr : "0"));
    out.has_moments = out.has_moments || values_of(moment).front() != 0;
  }
  for (const char* const key : product_keys) {
    SL_ASSIGN(const std::string product, numbers(*inertia, key, 1, "0"));
    out.has_moments = out.has_moments || values_of(product).front() != 0;
  }
  return out;
}

/// Links joined by fixed joints: per link the smallest index among them.
std::vector<std::size_t> rigid_parts(const Robot& robot) {
  std::vector<std::size_t> part(robot.links.size());
  std::iota(part.begin(), part.end(), std::size_t{0});
  const auto root = [&](std::size_t l) {
    while (part[l] != l) l = part[l] = part[part[l]];
    return l;
  };
  for (std::size_t j = 0; j < robot.joints.size(); ++j) {
    const std::string* const type = robot.joints[j]->attribute("type");
    if (!type || *type != "fixed") continue;
    const std::size_t a = root(robot.parent_link[j]), b = root(robot.child_link[j]);
    part[std::max(a, b)] = std::min(a, b);
  }
  for (std::size_t l = 0; l < part.size(); ++l) part[l] = root(l);
  return part;
}

/// A share of a part's mass that no sum of doubles with a relative error of 1e-9 shows, even some metres away.
constexpr double negligible_share = 1e-12;
/// [m] radius of gyration of what has no size.
constexpr double frame_radius_m = 0.01, point_radius_m = 1e-7;

void add_moments(Xml& inertial, const Xml& from, double moment) {
  Xml& inertia = add(inertial, "inertia", from);
  for (const char* const key : moment_keys) add(inertia, key, from, number_text(moment));
}

Status add_inertial(const Xml& link, const MassNote& note, Xml& out, Notes& notes) {
  const Xml* const inertial = link.child("inertial");
  if (inertial) {
    notes.unused(*inertial, "origin mass inertia");
    unused_attributes(*inertial, "", notes);
  }
  if (note.how == MassNote::How::negligible) {
    const Xml& from = inertial ? *inertial : link;
    Xml& sdf = add(out, "inertial", from);
    add(sdf, "mass", from, number_text(note.negligible_kg));
    add_moments(sdf, from, note.negligible_kg * frame_radius_m * frame_radius_m);
    return {};
  }
  if (!inertial) return {};
  const Xml* const mass = inertial->child("mass");
  const Xml* const inertia = inertial->child("inertia");
  SL_ASSIGN(const std::string kg, numbers(*mass, "value", 1, nullptr));
  unused_attributes(*mass, "value", notes);
  const double mass_kg = values_of(kg).front();
  if (mass_kg == 0) return {};  // left to the SDF reader
  Xml& sdf = add(out, "inertial", *inertial);
  SL_TRY(add_pose(*inertial, sdf, notes));
  add(sdf, "mass", *mass, kg);
  if (note.how == MassNote::How::point) {
    add_moments(sdf, inertia ? *inertia : *inertial, mass_kg * point_radius_m * point_radius_m);
  } else if (note.how == MassNote::How::as_written && inertia) {
    unused_attributes(*inertia, "ixx ixy ixz iyy iyz izz", notes);
    Xml& tensor = add(sdf, "inertia", *inertia);
    for (const auto* const keys : {&moment_keys, &product_keys})
      for (const char* const key : *keys) {
        SL_ASSIGN(std::string moment, numbers(*inertia, key, 1, "0"));
        add(tensor, key, *inertia, std::move(moment));
      }
  }
  return {};
}

Status add_geometry(const Xml& owner, const std::string& said, Xml& out, Notes& notes) {
  const Xml* const geometry = owner.child("geometry");
  constexpr const char* fix = "give it a <box>, <cylinder>, <sphere>, <capsule> or <mesh>";
  if (!geometry) return owner.error(said + " has no <geometry>", fix);
  if (geometry->children.empty()) return geometry->error("<geometry> is empty", fix);
  const Xml& form = geometry->children.front();
  if (geometry->children.size() > 1)
    notes.warn(geometry->children[1], "a second shape in one <geometry> is not used");
  Xml& shape = add(add(out, "geometry", *geometry), form.name, form);
  const auto take = [&](const char* key, std::size_t n) -> Status {
    SL_ASSIGN(std::string value, numbers(form, key, n, nullptr));
    add(shape, key, form, std::move(value));
    return {};
  };
  if (form.name == "box") {
    unused_attributes(form, "size", notes);
    return take("size", 3);
  }
  if (form.name == "sphere") {
    unused_attributes(form, "radius", notes);
    return take("radius", 1);
  }
  if (form.name == "cylinder" || form.name == "capsule") {
    unused_attributes(form, "radius length", notes);
    SL_TRY(take("radius", 1));
    return take("length", 1);
  }
  if (form.name == "mesh") {
    unused_attributes(form, "filename scale", notes);
    SL_ASSIGN(std::string file, required(form, "filename", "package://robot/meshes/part.stl"));
    add(shape, "uri", form, std::move(file));
    return form.attribute("scale") ? take("scale", 3) : Status();
  }
  static const std::vector<std::string> known{"box", "cylinder", "sphere", "capsule", "mesh"};
  return form.error("unknown geometry <" + form.name.substr(0, 60) + ">", suggestion(form.name, known));
}

Status add_material(const Xml& visual, const Materials& materials, Xml& out, Notes& notes) {
  const Xml* material = visual.child("material");
  if (!material) return {};
  unused_attributes(*material, "name", notes);
  notes.unused(*material, "color texture");
  if (!material->child("color") && !material->child("texture")) {
    const std::string* const name = material->attribute("name");
    const auto found = materials.find(name ? *name : "");
    if (found == materials.end()) {
      std::vector<std::string> known;
      for (const auto& [key, element] : materials) known.push_back(key);
      notes.warn(
          *material, "material '" + (name ? name->substr(0, 60) : "") + "' is not defined",
          known.empty() ? "give it a <color rgba=\"r g b a\"/>" : suggestion(name ? *name : "", known));
      return {};
    }
    material = found->second;
  }
  Xml sdf;
  sdf.name = "material";
  sdf.place = material->place;
  std::string rgba = "1 1 1 1";
  const Xml* const color = material->child("color");
  if (color) {
    unused_attributes(*color, "rgba", notes);
    SL_ASSIGN(rgba, numbers(*color, "rgba", 4, nullptr));
  }
  const Xml& from = color ? *color : *material;
  add(sdf, "ambient", from, rgba);
  add(sdf, "diffuse", from, std::move(rgba));
  if (const Xml* const texture = material->child("texture")) {
    SL_ASSIGN(std::string file, required(*texture, "filename", "package://robot/textures/wood.png"));
    add(add(add(sdf, "pbr", *texture), "metal", *texture), "albedo_map", *texture, std::move(file));
  }
  out.children.push_back(std::move(sdf));
  return {};
}

}  // namespace

Result<std::vector<MassNote>> weigh(const Robot& robot) {
  const std::size_t n = robot.links.size();
  const std::vector<std::size_t> part = rigid_parts(robot);
  std::vector<Weight> weights;
  struct Part {
    double mass_kg = 0;
    bool has_moments = false;
    std::size_t bearer = nothing;  ///< the link whose inertia is left to the SDF reader
    int rank = -1;
  };
  std::vector<Part> parts(n);
  for (std::size_t l = 0; l < n; ++l) {
    SL_ASSIGN(const Weight weight, weight_of(*robot.links[l]));
    weights.push_back(weight);
    Part& p = parts[part[l]];
    p.mass_kg += weight.mass_kg;
    p.has_moments = p.has_moments || (weight.mass_kg > 0 && weight.has_moments);
    const int rank = weight.mass_kg > 0 ? 2 : robot.links[l]->child("collision") ? 1 : 0;
    if (rank > p.rank) p.rank = rank, p.bearer = l;
  }
  std::vector<MassNote> out(n);
  for (std::size_t l = 0; l < n; ++l) {
    const Part& p = parts[part[l]];
    const bool still = robot.root_is_world && part[l] == part[robot.root];
    out[l].negligible_kg = negligible_share * (p.mass_kg > 0 ? p.mass_kg : 1.0);
    const Weight& weight = weights[l];
    if (weight.mass_kg > 0 && weight.has_moments) out[l].how = MassNote::How::as_written;
    else if (!p.has_moments && !still && l == p.bearer) out[l].how = MassNote::How::left_out;
    else out[l].how = weight.mass_kg > 0 ? MassNote::How::point : MassNote::How::negligible;
  }
  return out;
}

Status translate_link(const Xml& link, const MassNote& mass, const Materials& materials, Xml& out,
                      Notes& notes) {
  notes.unused(link, "inertial visual* collision*");
  unused_attributes(link, "name type", notes);
  SL_TRY(add_inertial(link, mass, out, notes));
  // Names are optional in URDF, and may come twice.
  std::map<std::string, int> numbers_of;
  std::set<std::string> taken;
  for (const Xml& part : link.children)
    if (const std::string* const name = part.attribute("name"); name && part.name == "visual")
      taken.insert("v" + *name);
    else if (name && part.name == "collision") taken.insert("c" + *name);
  std::set<std::string> used;
  for (const Xml& part : link.children) {
    const bool visual = part.name == "visual";
    if (!visual && part.name != "collision") continue;
    notes.unused(part, visual ? "origin geometry material" : "origin geometry", "verbose");
    unused_attributes(part, "name", notes);
    const std::string sort = visual ? "v" : "c";
    const std::string* const written = part.attribute("name");
    const bool named = written && !trim(*written).empty();
    const std::string stem = named ? *written : *out.attribute("name") + "_" + part.name;
    std::string name = stem;
    for (int& number = numbers_of[sort + stem];
         used.count(sort + name) > 0 || (taken.count(sort + name) > 0 && !(named && name == stem));)
      name = stem + "_" + std::to_string(++number);
    for (std::size_t at = name.find("::"); at != std::string::npos; at = name.find("::"))
      name.replace(at, 2, "__");
    used.insert(sort + name);
    Xml sdf;
    sdf.name = part.name;
    sdf.place = part.place;
    sdf.set_attribute("name", name);
    SL_TRY(add_pose(part, sdf, notes));
    SL_TRY(add_geometry(part, "<" + part.name + "> '" + name.substr(0, 60) + "'", sdf, notes));
    if (visual) SL_TRY(add_material(part, materials, sdf, notes));
    out.children.push_back(std::move(sdf));
  }
  return {};
}

namespace {

/// One direction of a URDF <ray>.
Status add_scan(const Xml& direction, Xml& scan, Notes& notes) {
  unused_attributes(direction, "samples resolution min_angle max_angle", notes);
  Xml& out = add(scan, direction.name, direction);
  static constexpr std::pair<const char*, const char*> keys[] = {
      {"samples", "1"}, {"resolution", "1"}, {"min_angle", "0"}, {"max_angle", "0"}};
  for (const auto& [key, fallback] : keys) {
    SL_ASSIGN(std::string value, numbers(direction, key, 1, fallback));
    add(out, key, direction, std::move(value));
  }
  return {};
}

Status add_camera(const Xml& camera, Xml& out, Notes& notes) {
  const Xml* const image = camera.child("image");
  if (!image)
    return camera.error(
        "<camera> has no <image>",
        "write <image width=\"640\" height=\"480\" format=\"RGB8\" hfov=\"1.2\" near=\"0.1\" far=\"50\"/>");
  unused_attributes(*image, "width height format hfov near far", notes);
  Xml& sdf = add(out, "camera", camera);
  SL_ASSIGN(std::string hfov, numbers(*image, "hfov", 1, nullptr));
  add(sdf, "horizontal_fov", *image, std::move(hfov));
  Xml size, clip;
  size.name = "image", clip.name = "clip";
  size.place = clip.place = image->place;
  for (const char* const key : {"width", "height"}) {
    SL_ASSIGN(std::string value, numbers(*image, key, 1, nullptr));
    add(size, key, *image, std::move(value));
  }
  if (const std::string* const format = image->attribute("format")) add(size, "format", *image, *format);
  for (const char* const key : {"near", "far"}) {
    SL_ASSIGN(std::string value, numbers(*image, key, 1, nullptr));
    add(clip, key, *image, std::move(value));
  }
  sdf.children.push_back(std::move(size));
  sdf.children.push_back(std::move(clip));
  return {};
}

}  // namespace

Result<Xml> translate_sensor(const Xml& sensor, Notes& notes) {
  unused_attributes(sensor, "name type update_rate", notes);
  Xml out;
  out.name = "sensor";
  out.place = sensor.place;
  out.set_attribute("name", *sensor.attribute("name"));
  const std::string* const type = sensor.attribute("type");
  const bool camera = sensor.child("camera"), ray = sensor.child("ray");
  if (!camera && !ray && !type)
    return sensor.error("sensor '" + sensor.attribute("name")->substr(0, 60) + "' is of no kind",
                        "give it a <camera> or a <ray>");
  out.set_attribute("type", camera ? "camera" : ray ? "ray" : *type);
  SL_TRY(add_pose(sensor, out, notes));
  if (sensor.attribute("update_rate")) {
    SL_ASSIGN(std::string rate, numbers(sensor, "update_rate", 1, nullptr));
    add(out, "update_rate", sensor, std::move(rate));
  }
  notes.unused(sensor, "parent origin camera ray");
  if (camera) SL_TRY(add_camera(*sensor.child("camera"), out, notes));
  if (ray) {
    Xml& scan = add(add(out, "ray", *sensor.child("ray")), "scan", *sensor.child("ray"));
    for (const Xml& direction : sensor.child("ray")->children)
      if (direction.name == "horizontal" || direction.name == "vertical")
        SL_TRY(add_scan(direction, scan, notes));
  }
  return out;
}

}  // namespace sandlot::formats::urdf
