/// A8: what a team game costs at each level of its sensors: twelve robots on a field of 22 x 14 m, each with
/// a laser scanner of 541 beams, an inertial unit, a satellite receiver and, as far as there are such kinds,
/// a camera and an omni-camera.
///
/// The scenario of a match (scenarios/msl_field.yaml) takes the place of this field where it is installed.
/// The reference is the same world with every sensor at its lowest level; a speed-up is 1 / ratio.
#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "base/check.h"
#include "base/math.h"
#include "bench/bench.h"
#include "files/resources.h"
#include "sim/load/load.h"
#include "sim/world/simulation.h"

namespace sandlot::bench {
namespace {

constexpr int robots = 12, ticks = 20;

model::Instance thing(const std::string& name, const Shape& shape, double mass_kg, Pose X_WM, Color color) {
  auto made = std::make_shared<model::Model>();
  made->name = name;
  made->is_static = mass_kg == 0;
  model::Link link;
  link.name = "link";
  link.inertial.mass_kg = mass_kg > 0 ? mass_kg : 1;
  link.inertial.moments = mass_kg > 0 ? inertia_kg_m2(shape, mass_kg) : Vec3{1, 1, 1};
  link.collisions.push_back({"collision", {}, shape, {}, {}});
  model::Visual visual;
  visual.shape = shape;
  visual.material.diffuse = color;
  link.visuals.push_back(visual);
  made->links.push_back(std::move(link));
  model::Instance instance;
  instance.name = instance.original_name = name;
  instance.model = std::move(made);
  instance.X_WM = X_WM;
  return instance;
}

Node map(std::initializer_list<std::pair<const char*, const char*>> entries) {
  Node node = Node::map();
  for (const auto& [key, text] : entries) node.set(key, Node::scalar(text));
  return node;
}

model::Setup own_field() {
  model::Setup setup;
  setup.name = "levels";
  setup.step = Time::from_s(0.01);
  setup.geography = model::Geography{};
  setup.instances.push_back(thing("ground", Plane{{0, 0, 1}}, 0, {}, {0.1f, 0.5f, 0.1f, 1}));
  for (const double side : {-1.0, 1.0}) {
    const std::string name = side < 0 ? "left" : "right";
    setup.instances.push_back(
        thing(name + "_goal", Box{{0.2, 2, 1}}, 0, {{11 * side, 0, 0.5}, {}}, {0.9f, 0.9f, 0.2f, 1}));
    setup.instances.push_back(
        thing(name + "_board", Box{{24, 0.1, 1}}, 0, {{0, 8 * side, 0.5}, {}}, {0.8f, 0.8f, 0.8f, 1}));
  }
  setup.instances.push_back(thing("ball", Sphere{0.11}, 0.45, {{0, 0, 0.11}, {}}, {1, 0.5f, 0, 1}));
  for (int i = 0; i < robots; ++i) {
    const auto [s, c] = math::sincos(math::tau * i / robots);
    model::Instance robot = thing(
        "robot" + std::to_string(i + 1), Cylinder{0.25, 0.6}, 25,
        {{8 * c, 5 * s, 0.3}, quat_from_rpy(0, 0, math::pi + math::tau * i / robots)},
        i % 2 ? Color{0, 0.8f, 0.8f, 1} : Color{0.8f, 0, 0.8f, 1});
    robot.is_robot = true;
    const auto add = [&](const char* name, Node config, Pose X_LS) {
      if (!find_device_kind(name)) return;
      model::DeviceDecl decl;
      decl.name = decl.kind = name;
      decl.X_LS = X_LS;
      decl.config = std::move(config);
      robot.devices.push_back(std::move(decl));
    };
    add("laser_scanner",
        map({{"beams", "541"},
             {"min_angle", "-135 deg"},
             {"max_angle", "135 deg"},
             {"rate", "25"},
             {"max_range", "20"}}),
        {});
    add("imu", map({{"rate", "100"}}), {});
    add("gps", map({{"rate", "10"}}), {});
    add("camera", map({{"rate", "25"}}), {{0.2, 0, 0.2}, {}});
    add("omni_camera", map({{"rate", "25"}}), {{0, 0, 0.5}, {}});
    setup.instances.push_back(std::move(robot));
  }
  return setup;
}

model::Setup field() {
  const std::string match = own_folder("scenarios") + "/msl_field.yaml";
  if (!std::filesystem::exists(match)) return own_field();
  Diagnostics diagnostics;
  auto setup = load(match, {}, diagnostics);
  SL_CHECK_MSG(setup, setup ? "" : setup.error().text().c_str());
  return std::move(*setup);
}

/// Levels from the lowest to the highest; the first and the last that a kind has are its low and its high
/// one.
constexpr const char* ladder[] = {"image", "ranges", "imu", "fix", "odometry", "segments", "objects", "pose"};

/// @param high  whether robot i (counted from 0) tells at its high levels
std::unique_ptr<Simulation> match(bool (*high)(int robot)) {
  Diagnostics diagnostics;
  model::Setup setup = field();
  int robot = 0;
  for (model::Instance& instance : setup.instances) {
    if (!instance.is_robot) continue;
    const bool at_top = high(robot++);
    for (model::DeviceDecl& device : instance.devices) {
      const auto kind = find_device_kind(device.kind);
      if (!kind) continue;
      const char* chosen = nullptr;
      for (const char* const name : ladder)
        for (const LevelInfo& level : (*kind)->levels)
          if (std::string_view(level.name) == name && (at_top || !chosen)) chosen = level.name;
      // A kind without a step of the ladder stays as it is.
      if (!chosen) continue;
      device.config.erase("levels");
      device.config.set("level", Node::scalar(chosen));
    }
  }
  auto made = Simulation::create(std::move(setup), {.threads = 1}, diagnostics);
  SL_CHECK_MSG(made, made ? "" : made.error().text().c_str());
  return std::move(*made);
}

void run(Simulation& simulation) {
  for (int i = 0; i < ticks; ++i) SL_CHECK(simulation.tick());
}

}  // namespace

std::vector<Row> levels() {
  const auto low = match([](int) { return false; });
  std::vector<Row> rows;
  const auto against_low = [&](const char* name, bool (*high)(int), double budget) {
    const auto other = match(high);
    const Timing t = compare(
        5, [&] { run(*other); }, [&] { run(*low); });
    Row made = row("", "ms/tick", 1e3 * t.ours_s / ticks, 1e3 * t.reference_s / ticks, budget);
    made.name = fmt::format("A8 {} (speed-up {:.1f})", name, 1 / made.ratio);
    rows.push_back(std::move(made));
  };
  against_low(
      "all low again", [](int) { return false; }, 1.2);
  against_low(
      "every other robot high", [](int robot) { return robot % 2 == 0; }, 0.8);
  against_low(
      "all high", [](int) { return true; }, 0.5);
  return rows;
}

}  // namespace sandlot::bench
