/// Commands about what stands in the world: where it is, what comes and goes.
#include <algorithm>
#include <cmath>
#include <set>

#include "base/text.h"
#include "base/units.h"
#include "console/command.h"
#include "console/line_parsing.h"
#include "geometry/bounds.h"
#include "sim/load/load.h"
#include "sim/world/pull.h"

namespace sandlot::console {
namespace {

/// For people: to a tenth of a millimetre or milliradian.
std::string rounded(double x) { return number_text(std::round(x * 1e4) / 1e4 + 0.0); }

std::string pose_text(const Pose& X) {
  const Vec3 rpy = rpy_from_quat(X.q);
  std::string text = rounded(X.p.x) + " " + rounded(X.p.y) + " " + rounded(X.p.z) + " m";
  if (rounded(rpy.x) != "0" || rounded(rpy.y) != "0")
    text += ", roll " + rounded(rpy.x) + " pitch " + rounded(rpy.y) + " rad";
  return text + ", yaw " + rounded(rpy.z) + " rad";
}

/// All numbers behind the name; the first three are lengths, then come angles.
Result<std::vector<double>> pose_numbers(std::span<const std::string> words) {
  static constexpr const char* as_yaw[] = {"X", "Y", "Z", "YAW"};
  static constexpr const char* as_rpy[] = {"X", "Y", "Z", "ROLL", "PITCH", "YAW"};
  std::vector<double> out;
  while (!words.empty()) {
    if (out.size() == 6)
      return Error{"'" + words.front().substr(0, 40) + "' is too much", "X Y Z ROLL PITCH YAW"};
    const char* const name = out.size() < 4 ? as_yaw[out.size()] : as_rpy[out.size()];
    SL_ASSIGN(const double number, take_quantity(words, name, out.size() < 3 ? "m" : "rad"));
    out.push_back(number);
  }
  if (out.size() == 1 || out.size() == 5)
    return Error{"a pose is X Y [Z] [YAW], or X Y Z ROLL PITCH YAW", "m and rad"};
  return out;
}

Bounds bounds_at(const model::Model& model, const Pose& X_WM) {
  Bounds bounds, seen;
  for (const model::Link& link : model.links) {
    for (const model::Collision& each : link.collisions)
      bounds.include(bounds_of(each.shape, X_WM * link.X_ML * each.X_LC));
    for (const model::Visual& each : link.visuals)
      seen.include(bounds_of(each.shape, X_WM * link.X_ML * each.X_LC));
  }
  return bounds.empty() ? seen : bounds;
}

/// How high the world is below a footprint: the highest of nine rays from above.
double support_m(const Simulation& simulation, const Bounds& footprint) {
  constexpr double from_m = 100;
  if (simulation.engine().capabilities().planar) return 0;
  const Vec3 down[] = {{0, 0, -1}};
  double highest = -from_m;
  bool hit = false;
  for (int i = 0; i < 9; ++i) {
    // A hair within its edges: what it only touches is beside it.
    const double x = 0.499 * (i % 3 - 1), y = 0.499 * (i / 3 - 1);
    const Vec3 size = footprint.size(), centre = footprint.centre();
    float distance = 0;
    const RayJob job{{{centre.x + x * size.x, centre.y + y * size.y, from_m}, {}},
                     down,
                     0,
                     2 * from_m,
                     no_body,
                     std::span(&distance, 1),
                     {}};
    simulation.rays().cast(std::span(&job, 1));
    if (!(distance < 2 * from_m)) continue;
    hit = true;
    highest = std::max(highest, from_m - static_cast<double>(distance));
  }
  if (!hit) return 0;
  // Distances are floats, good to a hundredth of a millimetre here.
  return std::round(highest * 1e4) / 1e4 + 0.0;
}

std::string fresh_name(const Simulation& simulation, const std::string& wanted) {
  if (!simulation.find_entity(wanted)) return wanted;
  for (int i = 2;; ++i)
    if (std::string name = wanted + std::to_string(i); !simulation.find_entity(name)) return name;
}

/// What follows a MODEL as key=value.
struct Looks {
  std::optional<std::vector<double>> size_m;
  std::optional<Color> color;
  std::optional<double> mass_kg;
  bool is_static = false;
  bool any() const { return size_m || color || mass_kg || is_static; }
};

Result<Looks> take_looks(std::vector<std::string>& words) {
  Looks looks;
  std::vector<std::string> left;
  for (const std::string& word : words) {
    const std::size_t equals = word.find('=');
    if (equals == std::string::npos) {
      left.push_back(word);
      continue;
    }
    const std::string key = word.substr(0, equals), value = word.substr(equals + 1);
    if (key == "size") {
      looks.size_m.emplace();
      for (const std::string_view part : split(value, ',')) {
        auto length = parse_quantity(part, "m");
        if (!length) return Error{"size: " + length.error().what, length.error().fix};
        if (!(*length >= 1e-3 && *length <= 1000))
          return Error{"size: must be in [0.001, 1000] m, is " + number_text(*length)};
        looks.size_m->push_back(*length);
      }
    } else if (key == "color" || key == "colour") {
      SL_ASSIGN(looks.color, read_color(value));
    } else if (key == "mass") {
      auto mass = parse_quantity(value, "kg");
      if (!mass) return Error{"mass: " + mass.error().what, mass.error().fix};
      if (!(*mass >= 1e-6 && *mass <= 1e6))
        return Error{"mass: must be in [1e-6, 1e6] kg, is " + number_text(*mass)};
      looks.mass_kg = *mass;
    } else if (key == "static") {
      if (value != "yes" && value != "no")
        return Error{"static: '" + value.substr(0, 40) + "' is neither yes nor no"};
      looks.is_static = value == "yes";
    } else {
      const std::vector<std::string> known{"size", "color", "mass", "static"};
      return Error{"there is no '" + key.substr(0, 40) + "=' here", suggestion(key, known)};
    }
  }
  words = std::move(left);
  return looks;
}

/// box: size=X,Y,Z; sphere: size=DIAMETER; cylinder: size=DIAMETER,HEIGHT. One number goes for all.
Result<Shape> primitive(const std::string& name, const Looks& looks) {
  std::vector<double> size = looks.size_m.value_or(std::vector<double>{0.3});
  const std::size_t needed = name == "box" ? 3 : name == "cylinder" ? 2 : 1;
  if (size.size() == 1) size.resize(needed, size.front());
  if (size.size() != needed)
    return Error{"size: " + std::to_string(size.size()) + " numbers are wrong for a " + name,
                 name == "box"        ? "size=X,Y,Z"
                 : name == "cylinder" ? "size=DIAMETER,HEIGHT"
                                      : "size=DIAMETER"};
  if (name == "box") return Shape(Box{{size[0], size[1], size[2]}});
  if (name == "cylinder") return Shape(Cylinder{size[0] / 2, size[1]});
  return Shape(Sphere{size[0] / 2});
}

model::Instance made_of(const std::string& name, const Shape& shape, const Looks& looks) {
  // As dense as wood unless a mass is given: such things can be pushed and float in no way.
  constexpr double wood_kg_m3 = 500;
  auto made = std::make_shared<model::Model>();
  made->name = name;
  made->is_static = looks.is_static;
  model::Link link;
  link.name = "link";
  link.inertial.mass_kg = looks.mass_kg.value_or(std::max(1e-3, wood_kg_m3 * volume_m3(shape)));
  link.inertial.moments = inertia_kg_m2(shape, link.inertial.mass_kg);
  link.collisions.push_back({"collision", {}, shape, {}, {}});
  model::Visual visual{"visual", {}, shape, {}, true, {}};
  visual.material.diffuse = looks.color.value_or(Color{0.75f, 0.55f, 0.3f, 1});
  visual.material.from_mesh = false;
  link.visuals.push_back(std::move(visual));
  made->links.push_back(std::move(link));
  model::Instance instance;
  instance.model = std::move(made);
  return instance;
}

bool is_primitive(std::string_view name) { return name == "box" || name == "sphere" || name == "cylinder"; }

/// The instance that MODEL stands for, without name and pose.
Result<model::Instance> pattern_of(CommandCall& call, const std::string& model, const Looks& looks) {
  if (is_primitive(model)) {
    SL_ASSIGN(const Shape shape, primitive(model, looks));
    return made_of(model, shape, looks);
  }
  if (looks.any()) return Error{"size, color, mass and static are for box, sphere and cylinder"};
  const Simulation& simulation = call.simulation();
  const Simulation::Entity* like = simulation.find_entity(model);
  for (const auto& entity : simulation.entities())
    if (!like && entity->instance.model->name == model) like = entity.get();
  if (like) {
    model::Instance copy = like->declared();
    copy.motion.reset();
    return copy;
  }
  std::vector<std::string> known{"box", "sphere", "cylinder"};
  for (const ModelFile& file : model_files(call.options)) {
    // models/rover/model.sdf, rover/model.sdf, models/rover, rover
    const std::string folder = file.name.substr(0, file.name.rfind('/'));
    const std::string bare = file.name.substr(file.name.find('/') + 1);
    const std::string only = folder.substr(folder.find('/') + 1);
    known.push_back(only);
    if (model != file.name && model != folder && model != bare && model != only) continue;
    Diagnostics ignored;
    return load_instance(file.file, only, {}, ignored, call.options.paths, true);
  }
  for (const auto& entity : simulation.entities()) known.push_back(entity->instance.name);
  call.unknown_thing = true;
  return Error{"there is no model '" + model.substr(0, 60) + "'", suggestion(model, known)};
}

}  // namespace

CommandResult cmd_pose(CommandCall& call) {
  SL_ASSIGN(const Simulation::Entity* const thing, find_thing(call, call.words.front()));
  const std::string& name = thing->instance.name;
  Pose X_WM = call.simulation().engine().pose(thing->id);
  SL_ASSIGN(const std::vector<double> numbers, pose_numbers(call.words.subspan(1)));
  if (numbers.empty()) return std::optional(name + " is at " + pose_text(X_WM));
  X_WM.p = {numbers[0], numbers[1], numbers.size() > 2 ? numbers[2] : X_WM.p.z};
  if (numbers.size() == 4) X_WM.q = quat_from_rpy(0, 0, numbers[3]);
  if (numbers.size() == 6) X_WM.q = quat_from_rpy(numbers[3], numbers[4], numbers[5]);
  return submit(call, {{PoseRequest{name, X_WM}, name + " at " + pose_text(X_WM)}});
}

CommandResult cmd_drag(CommandCall& call) {
  SL_ASSIGN(const Simulation::Entity* const thing, find_thing(call, call.words.front()));
  const std::string& name = thing->instance.name;
  Pose X_WM = call.simulation().engine().pose(thing->id);
  SL_ASSIGN(const std::vector<double> numbers, pose_numbers(call.words.subspan(1)));
  if (numbers.size() > 3) return Error{"dragging turns nothing", "drag NAME X Y [Z], or pose"};
  if (numbers.empty()) return Error{"X is missing", "drag NAME X Y [Z]"};
  X_WM.p = {numbers[0], numbers[1], numbers.size() > 2 ? numbers[2] : X_WM.p.z};
  return submit(call, {{PoseRequest{name, X_WM}, name + " at " + pose_text(X_WM)}});
}

CommandResult cmd_pull(CommandCall& call) {
  SL_ASSIGN(const Simulation::Entity* const thing, find_thing(call, call.words.front()));
  const std::string& name = thing->instance.name;
  std::span<const std::string> words = call.words.subspan(1);
  if (words.size() == 1 && words.front() == "off")
    return submit(call, {{PullRequest{name, "", {}, {}, Time{}}, name + " is let go"}});
  const model::Model& model = *thing->instance.model;
  PullRequest pull{name, words.front(), {}, {}};
  if (!model.find_link(pull.link)) {
    std::vector<std::string> known;
    for (const model::Link& link : model.links) known.push_back(link.name);
    return Error{"'" + name + "' has no link '" + pull.link.substr(0, 60) + "'",
                 suggestion(pull.link, known)};
  }
  words = words.subspan(1);
  static constexpr const char* names[] = {"PX", "PY", "PZ", "TX", "TY", "TZ"};
  for (std::size_t i = 0; i < 6; ++i) {
    SL_ASSIGN(const double number, take_quantity(words, names[i], "m"));
    (i < 3 ? pull.point_L : pull.target_W)[i % 3] = number;
  }
  if (!words.empty())
    return Error{"'" + words.front().substr(0, 40) + "' is too much", "pull NAME LINK PX PY PZ TX TY TZ"};
  const Vec3 t = pull.target_W;
  return submit(call, {{std::move(pull), name + " pulled to " + readable(t.x) + " " + readable(t.y) + " " +
                                             readable(t.z) + " m"}});
}

CommandResult cmd_add(CommandCall& call) {
  std::vector<std::string> words(call.words.begin(), call.words.end());
  SL_ASSIGN(const Looks looks, take_looks(words));
  // "copy of NAME as NEW X Y" is "NAME NEW X Y".
  if (words.size() > 3 && words[0] == "copy" && words[1] == "of") {
    words.erase(words.begin(), words.begin() + 2);
    if (words.size() > 1 && words[1] == "as") words.erase(words.begin() + 1);
  }
  if (words.size() < 3) return Error{"'add' needs more words", "add MODEL [NAME] X Y [Z] [YAW]"};
  const std::string model = words[0];
  SL_ASSIGN(model::Instance instance, pattern_of(call, model, looks));
  const Simulation& simulation = call.simulation();
  std::span<const std::string> rest = std::span<const std::string>(words).subspan(1);
  std::string wanted;
  if (parse_quantity(rest.front(), "m")) {
    // No name given: "box", "box2" ...
    wanted = fresh_name(simulation, sanitised(instance.model->name));
    instance.original_name = wanted;
  } else {
    wanted = sanitised(rest.front());
    instance.original_name = rest.front();
    if (wanted.size() > 100) return Error{"a name has 100 letters at most"};
    if (simulation.find_entity(wanted))
      return Error{"there is a '" + wanted + "' already", "'" + fresh_name(simulation, wanted) + "' is free"};
    rest = rest.subspan(1);
  }
  instance.name = wanted;
  SL_ASSIGN(const std::vector<double> numbers, pose_numbers(rest));
  if (numbers.empty()) return Error{"X and Y are missing", "add MODEL [NAME] X Y [Z] [YAW]"};
  Pose X_WM{{numbers[0], numbers[1], 0}, {}};
  if (numbers.size() == 4) X_WM.q = quat_from_rpy(0, 0, numbers[3]);
  if (numbers.size() == 6) X_WM.q = quat_from_rpy(numbers[3], numbers[4], numbers[5]);
  if (numbers.size() > 2) {
    X_WM.p.z = numbers[2];
  } else if (const Bounds bounds = bounds_at(*instance.model, X_WM); !bounds.empty()) {
    X_WM.p.z = support_m(simulation, bounds) - bounds.low.z;
  }
  instance.X_WM = X_WM;
  std::string text = wanted + " (" + model + ") at " + pose_text(X_WM);
  return submit(call, {{SpawnRequest{std::move(instance)}, std::move(text)}});
}

CommandResult cmd_remove(CommandCall& call) {
  SL_ASSIGN(const std::vector<const Simulation::Entity*> things, match_things(call, call.words.front()));
  std::vector<PendingRequest> requests;
  for (const Simulation::Entity* thing : things)
    requests.push_back({DeleteRequest{thing->instance.name}, thing->instance.name + " removed"});
  return submit(call, std::move(requests));
}

}  // namespace sandlot::console
