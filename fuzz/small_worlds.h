#pragma once
/// Small worlds for the fuzzers of State: few bodies, few rays, pictures of a dozen pixels, one thread. Together they hold
/// every kind of device, medium, rule and marker, on both engines, and what a run keeps in addition: events, failures,
/// pulls, manual overrides, commands and messages on their way.
#include <cstddef>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "base/check.h"
#include "files/resources.h"
#include "geometry/height_grid.h"
#include "geometry/mesh.h"
#include "markers/marker.h"
#include "media/medium.h"
#include "rules/rule.h"
#include "sim/load/load.h"
#include "sim/world/simulation.h"

namespace sandlot::fuzz {

struct SmallWorld {
  const char* name;
  const char* engine;
  const char* scenario;  ///< without version, name, physics and time
};

inline constexpr SmallWorld small_worlds[] = {
    {"motors", "rigid", R"(
values:
  turn: abs(cart/joints.position[0])
events: [{name: turned, when: turn > 0.1, for: 0.1 s}]
robots:
  - name: cart
    model: cart
    devices:
      joints: {kind: joint_state, noise: {position: [{quantise: {step: 0.01}}, {walk: {density: 0.1}}]}}
      left_motor: {delay: 25 ms, max_rate: 50, command_errors: {velocity: [{lag: {time_constant: 50 ms}}, {gaussian: {std: 0.05}}]}}
      ticks: {kind: wheel_encoder, joint: left_wheel_joint, ticks_per_turn: 100, levels: [ticks, joint], delay: 70 ms}
      odometry: {kind: wheel_odometry, left_joint: left_wheel_joint, right_joint: right_wheel_joint, wheel_radius: 0.05,
                 wheel_separation: 0.24, alpha_1: 0.01, levels: [odometry, pose], pose_error: {distance_walk: 0.02}}
    controller: {kind: sequence, steps: [{at: 0.1 s, orders: {left_motor: 20, right_motor: 10}}]}
)"},
    {"inertial", "rigid", R"(
vars:
  noise: [{gaussian: {std: 0.01}}, {drift: {std: 0.02, correlation: 1 s}}, {latency: {delay: 30 ms, jitter: 10 ms}},
          {dropouts: {rate: 0.1, burst: 3, shows: hold}}]
robots:
  - name: cart
    model: cart
    devices:
      imu: {kind: imu, levels: [imu, pose], pose_error: {velocity_walk: 0.01}}
      gps: {kind: gps, levels: [fix, velocity, pose], vertical: "${noise}", pose_error: {position_std: 1, lost_rate: 1}}
      compass: {kind: magnetometer, levels: [field, heading]}
      height: {kind: altimeter, position: "${noise}"}
      air: {kind: barometer, noise: "${noise}"}
      heat: {kind: thermometer, response: 1, failures: [{from: 0.1 s, until: 1 s, kind: stuck}], clock: {jitter: 1 ms}}
      truth: {kind: ground_truth}
)"},
    {"touch", "rigid", R"(
things: [{name: ball, model: msl_ball, pose: [0.24, 0, 0.11]}]
robots:
  - name: cart
    model: cart
    devices:
      touch: {kind: contact, link: base_link, collision: body, levels: [contacts, bumper]}
      wheel: {kind: force_torque, joint: left_wheel_joint, force: {x: [{gaussian: {std: 0.1}}]}}
      hand: {kind: gripper, link: base_link, pose: [0.14, 0, 0.1, 0, 0, 0], reach: 10 cm, closed: true}
)"},
    {"ranges", "rigid", R"(
things: [{name: ball, model: msl_ball, pose: [0.6, 0, 0.11]}]
robots:
  - name: cart
    model: cart
    devices:
      scan: {kind: laser_scanner, beams: 4, levels: [ranges, segments, pose], noise: [{drift: {std: 0.1, correlation: 1 s}}],
             pose_error: {position_std: 0.05, lost_rate: 1}}
      points: {kind: laser_scanner_3d, columns: 4, planes: 2}
      ring: {kind: proximity, sensors: 4, radius: 0.2, range: 0.5}
      sonar: {kind: range_finder, rings: 1, noise: {white: 0.01}}
)"},
    {"pictures", "rigid", R"(
vars: {at: [0.14, 0, 0.1, 0, 0, 0]}
things: [{name: ball, model: msl_ball, label: ball, pose: [0.5, 0, 0.11]}]
robots:
  - name: cart
    model: cart
    devices:
      eye: {kind: camera, width: 4, height: 3, levels: [image, objects, world], pose: "${at}"}
      depth: {kind: depth_camera, width: 4, height: 3, pose: "${at}"}
      rgbd: {kind: rgbd_camera, width: 4, height: 3, pose: "${at}"}
      labels: {kind: segmentation_camera, width: 4, height: 3, pose: "${at}"}
      boxes: {kind: boundingbox_camera, width: 4, height: 3, pose: "${at}"}
)"},
    {"surfaces", "planar", R"(
things: [{name: ball, model: msl_ball, label: ball, pose: [0.5, 0, 0.11]}]
robots:
  - name: cart
    model: cart
    devices:
      eyes: {kind: stereo_camera, width: 4, height: 3, pose: [0.14, 0, 0.1, 0, 0, 0]}
      omni: {kind: omni_camera, width: 6, height: 6, levels: [image, objects], pose: [0, 0, 0.3, 0, 0, 0]}
      sun: {kind: light_sensor}
      paint: {kind: color_sensor, range: 5}
      floor: {kind: ground_sensor, range: 5, spots: [{y: 0.01}]}
      row: {kind: line_camera, pixels: 4}
      above: {kind: overhead_camera, position_std: 0.01, miss: 0.1}
)"},
    {"head", "planar", R"(
things: [{name: ball, model: msl_ball, label: ball, pose: [1, 0.3, 0.11]}]
robots:
  - name: guard
    model: rcbot
    modules: [{id: head, model: ptz_camera, pose: [0.1, 0, 0.325, 0, 0, 0]}]
    devices:
      head_eye: {width: 4, height: 3, levels: [image, objects]}
      head_unit: {level: view, zoom_per_m: 1}
)"},
    {"swarm", "planar", R"(
things: [{name: ball, model: msl_ball, pose: [0.2, 0, 0.11]}]
robots: [{name: scout, model: scout, controller: {kind: diffusion}}]
)"},
    {"programs", "planar", R"(
teams: [{name: red, controller: {name: coach, kind: formation, rate: 25, odometry: truth}}]
robots:
  - name: one
    model: scout
    team: red
    devices: {truth: {kind: ground_truth}}
    controllers:
      - {name: estimator, kind: odometry_estimator, odometry: drive, rate: 50}
      - {name: brain, kind: pipe, command: [cat]}
  - {name: two, model: scout, team: red, pose: [0.5, 0, 0], devices: {truth: {kind: ground_truth}}}
)"},
    {"rollers", "rigid", R"(
robots:
  - name: robot
    model: {builder: omni_robot, rollers: 4}
    controller: {kind: sequence, steps: [{at: 0.1 s, orders: {drive: [0.3, 0, 0.5]}}]}
    devices: {drive: {level: rollers}}
)"},
    {"mecanum", "planar", R"(
robots:
  - name: robot
    model: {builder: mecanum_robot, rollers: 6}
    controller: {kind: sequence, steps: [{at: 0.1 s, orders: {drive: [0.3, 0, 0.5]}}]}
    devices: {drive: {level: contact}}
)"},
    {"car", "planar", R"(
robots:
  - name: robot
    model: {builder: ackermann_robot}
    controller: {kind: sequence, steps: [{at: 0.1 s, orders: {drive: [0.3, 0, 0.5]}}]}
    devices: {drive: {level: contact}}
)"},
    {"skid", "rigid", R"(
robots:
  - name: robot
    model: {builder: skid_robot}
    controller: {kind: sequence, steps: [{at: 0.1 s, orders: {drive: [0.3, 0, 0.5]}}]}
    devices: {drive: {level: contact}}
)"},
    {"swerve", "planar", R"(
robots:
  - name: robot
    model: {builder: swerve_robot}
    controller: {kind: sequence, steps: [{at: 0.1 s, orders: {drive: [0.3, 0, 0.5]}}]}
    devices: {drive: {level: ideal}}
)"},
    {"tracks", "planar", R"(
robots:
  - name: robot
    model: {builder: tracked_robot, wheels: 2}
    controller: {kind: sequence, steps: [{at: 0.1 s, orders: {drive: [0.3, 0, 0.5]}}]}
    devices: {drive: {level: ideal}}
)"},
    {"round", "rigid", R"(
robots:
  - name: robot
    model: {builder: diff_robot}
    controller: {kind: sequence, steps: [{at: 0.1 s, orders: {drive: [0.3, 0, 0.5]}}]}
    devices: {drive: {level: ideal}}
)"},
    {"snake", "rigid", R"(
robots: [{name: snake, model: {builder: snake, segments: 3}, controller: sine}]
)"},
    {"grip", "planar", R"(
things: [{name: ball, model: msl_ball, pose: [0.24, 0, 0.11]}]
robots:
  - name: cart
    model: cart
    devices:
      path: {kind: joint_trajectory}
      hand: {kind: gripper, link: base_link, pose: [0.14, 0, 0.1, 0, 0, 0], reach: 10 cm, closed: true}
)"},
    {"mover", "rigid", R"(
robots:
  - name: cart
    model: cart
    devices:
      mover: {kind: body_velocity, initial_linear: [0.2, 0, 0], drain_per_use: 1 J, efficiency: 0.5}
      battery: {kind: battery, capacity: 2 J, resistance: 0.1, drain: 3 W}
      charger: {kind: charger, power: 5 W}
      screen: {kind: text_display, rows: 2, columns: 5, mass: 100 g}
    properties: {fuel: {value: 5, unit: kg, min: 0, max: 10}}
)"},
    {"elements", "rigid", R"(
media: [{kind: wind, velocity: [-6, 1, 0]}, {kind: shout}]
markers:
  - {kind: polygon, name: goal, corners: [[-2, -2], [0.2, -2], [0.2, 2], [-2, 2]]}
  - {kind: disc, name: spot, centre: [2, 0], radius: 0.3}
rules:
  - {kind: goals, object: ball, goals: [{marker: goal, team: wind}], place: [0.5, 0, 0.11]}
  - {kind: impact, threshold: 0.01, property: health}
  - {kind: energy, restart: 0.2}
  - {kind: place, object: ball, when: ball.pose.y > 1, place: [0.5, 0, 0.11]}
  - {kind: set, when: ball.pose.y > 1, set: [{parameter: rules/impact.threshold, value: 0.02 Ns}]}
  - {kind: statistics, value: ball.pose.x, bins: 3, quantiles: [0.5]}
  - {kind: coverage, values: [ball.pose.x, cart.pose.y], ranges: [[-1, 1]], bins: 3}
  - {kind: path, values: [ball.pose.x, ball.pose.y], interval: 50 ms}
  - {kind: episodes, when: ball.pose.x > 0.1, at_least: 0.1 s}
things: [{name: ball, model: msl_ball, pose: [0.25, 0, 0.11]}]
robots:
  - name: cart
    model: cart
    devices: {voice: {kind: voice}, ear: {kind: ear}, battery: {kind: battery, capacity: 1 J, drain: 2 W}}
    properties: {health: 3}
    controller: {kind: sequence, steps: [{at: 0.1 s, orders: {voice: hello}}, {at: 0.29 s, orders: {voice: again}}]}
)"},
    {"radios", "planar", R"(
media:
  - {kind: radio, model: log_distance, access: csma, bandwidth: 5 kbit/s, fading: 2, modulation: fsk, drop: 0.1, delay: 5 ms}
  - {kind: infrared}
robots:
  - name: one
    model: scout
    devices:
      radio: {kind: radio, levels: [packets, bits]}
      light: {kind: infrared}
      buoy: {kind: range_bearing, beacon_rate: 20, range_noise: {std: 0.1}}
    controller: {kind: sequence, steps: [{at: 0.1 s, orders: {radio: hello}}, {at: 0.29 s, orders: {radio: again, light: on}}]}
  - {name: two, model: scout, pose: [0.5, 0, 0], devices: {radio: {kind: radio}, buoy: {kind: range_bearing}}}
)"},
    {"acting", "planar", R"(
markers:
  - {kind: line, name: track, points: [[-1, 0], [1, 0]], width: 0.2, visible: true}
  - {kind: grid, name: tiles, size: [1, 1], spacing: 0.5, width: 0.05}
rules: [{kind: zone, marker: track, overlaps: true}]
things: [{name: ball, model: msl_ball, pose: [0.4, 0, 0.11], properties: {pressure: 0.8}}]
robots:
  - name: cart
    model: cart
    devices:
      go: {kind: heading_drive}
      foot: {kind: kicker, pose: [0.14, 0, 0.1, 0, 0, 0], reach: 1, opening: 60 deg}
      dribbler: {kind: ball_handler, reach: 1, opening: 90 deg, strength: 1}
      lamp: {kind: lamp, levels: [brightness, color]}
      eyes: {kind: agent_eyes}
      health: {kind: property_sensor, property: health}
      lcd: {kind: screen, width: 16, height: 16}
      keys: {kind: keys}
      speaker: {kind: speaker}
    properties: {health: {value: 100, min: 0, max: 100}, age: 3}
    controller: {kind: sequence, steps: [{at: 0.1 s, orders: {foot: 0.1, go: [0.3, 1]}}, {at: 0.29 s, orders: {foot: 0.05}}]}
)"},
    {"soccer", "planar", R"(
rules: [{kind: referee, stop_time: 20 ms, prepare_min: 20 ms, prepare_max: 50 ms, take_time: 0.1 s}]
things: [{name: ball, model: msl_ball, pose: [0, 0, 0.11]}]
robots:
  - {name: cyan1, team: cyan, model: scout, pose: [-3, 0, 0], devices: {referee: {kind: referee_link}}}
  - {name: magenta2, team: magenta, model: scout, pose: [2, 0, 0], devices: {referee: {kind: referee_link}}}
)"},
    {"shapes", "rigid", R"(
things: [{name: ball, model: msl_ball, pose: [0, 0, 0.5]}]
)"},
};

/// A tetrahedron that a path guides, and terrain.
inline void add_shapes(model::Setup& setup) {
  const auto add = [&](const char* name, Shape shape, bool is_static) {
    auto made = std::make_shared<model::Model>();
    made->name = name;
    made->is_static = is_static;
    made->links.emplace_back().name = "link";
    made->links.front().collisions.push_back({"collision", {}, std::move(shape), {}, {}});
    model::Instance& instance = setup.instances.emplace_back();
    instance.name = instance.original_name = name;
    instance.model = std::move(made);
    return &instance;
  };
  auto mesh = std::make_shared<TriangleMesh>();
  mesh->vertices = {{0, 0, 0}, {0.2, 0, 0}, {0, 0.2, 0}, {0, 0, 0.2}};
  mesh->triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  model::Motion motion;
  motion.keys = {{0, {{0, 1, 1}, {}}}, {1, {{1, 0, 1}, {}}}};
  add("tetrahedron", Mesh{mesh}, false)->motion = motion;
  auto grid = std::make_shared<HeightGrid>();
  grid->columns = grid->rows = 3;
  grid->size_x_m = grid->size_y_m = 4;
  grid->height_m = {0, 0, 0, 0, 0.2f, 0, 0, 0.1f, 0};
  add("terrain", Heightfield{grid}, true);
}

inline model::Setup small_setup(const SmallWorld& world, std::string_view step = "10 ms") {
  const std::string text = std::string("version: 1\nname: ") + world.name + "\nphysics: " + world.engine +
                           "\ntime: {step: " + std::string(step) + "}\n" + world.scenario;
  Diagnostics diagnostics;
  auto setup = load(own_folder("scenarios") + "/" + world.name + ".yaml", {.text = text}, diagnostics);
  SL_CHECK_MSG(setup, setup ? "" : setup.error().text().c_str());
  setup->geography.emplace();
  if (std::string_view(world.name) == "shapes") add_shapes(*setup);
  return std::move(*setup);
}

/// Kinds of devices, media, rules and markers that no small world has: a new kind needs a place in one.
inline std::vector<std::string> missing_kinds() {
  std::set<std::string> there;
  for (const SmallWorld& world : small_worlds) {
    const model::Setup setup = small_setup(world);
    for (const model::Instance& instance : setup.instances)
      for (const model::DeviceDecl& device : instance.devices) there.insert(device.kind);
    for (const auto* const list : {&setup.media, &setup.rules, &setup.markers})
      for (const model::ElementDecl& element : *list) there.insert(element.kind);
  }
  std::vector<std::string> missing;
  const auto look = [&](const auto& known) {
    for (const auto* const kind : known)
      if (!there.contains(kind->name)) missing.emplace_back(kind->name);
  };
  look(device_kinds());
  look(medium_kinds());
  look(rule_kinds());
  look(marker_kinds());
  return missing;
}

/// Its snapshot after a few ticks, with a pull, a command from outside, a failure and a factor on errors.
inline std::vector<std::byte> small_snapshot(const SmallWorld& world) {
  Diagnostics diagnostics;
  auto made = Simulation::create(small_setup(world), {}, diagnostics);
  SL_CHECK_MSG(made, made ? "" : made.error().text().c_str());
  Simulation& simulation = **made;
  for (int i = 0; i < 30; ++i) SL_CHECK(simulation.tick());
  // What does not fit a world is refused.
  simulation.submit(PullRequest{"ball", "", {}, {0, 0, 1}, Time::from_s(5)});
  simulation.submit(ParameterRequest{"cart", "errors", Node::scalar("2")});
  simulation.submit(ParameterRequest{"cart/touch", "failure", Node::scalar("dead")});
  for (const auto& entity : simulation.entities())
    for (const auto& device : entity->devices)
      for (const Simulation::Slot& slot : device->commands) {
        ByteWriter w;
        slot.topic->save_message(w);
        simulation.submit(CommandRequest{device->path, slot.topic->type(), w.buffer()});
      }
  SL_CHECK(simulation.tick());
  return simulation.snapshot();
}

}  // namespace sandlot::fuzz
