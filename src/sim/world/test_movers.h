#pragma once
/// For the tests of device keys: pucks that move as commanded.
#include <stdexcept>
#include <string>

#include "messages/command.h"
#include "messages/messages.h"
#include "sim/test_values.h"
#include "sim/test_world.h"

namespace sandlot::test {

inline Node list_of(std::initializer_list<std::pair<const char*, Node>> stages) {
  Node out = Node::sequence();
  for (const auto& [name, keys] : stages) {
    Node stage = Node::map();
    stage.set(name, keys);
    out.push(std::move(stage));
  }
  return out;
}

/// Pucks on a plane that move as commanded, without delay of their own; robot1, robot2 ...
inline model::Setup movers(const Node& keys, int robots = 1, const char* engine = "planar") {
  model::Setup setup;
  setup.engine = engine;
  setup.step = Time::from_s(0.01);
  setup.gravity = {0, 0, engine == std::string("planar") ? -9.81 : 0.0};
  setup.seed = 3;
  setup.instances.push_back(placed("ground", one_shape("ground", Plane{{0, 0, 1}}, 0), {}));
  const auto puck = one_shape("puck", Cylinder{0.2, 0.4}, 2);
  for (int i = 0; i < robots; ++i) {
    model::Instance robot = placed("robot" + std::to_string(i + 1), puck, {{0, 5.0 * i, 0.2}, {}});
    robot.is_robot = true;
    Node config = map({{"max_acceleration", "1e9"}, {"max_angular_acceleration", "1e9"}});
    if (keys.is_map())
      for (const Node::Entry& each : keys.entries()) config.set(each.key, each.value);
    robot.devices.push_back(device("mover", "body_velocity", std::move(config)));
    setup.instances.push_back(std::move(robot));
  }
  return setup;
}

inline Node errors_of(const char* quantity, Node stages) {
  Node errors = Node::map();
  errors.set(quantity, std::move(stages));
  Node keys = Node::map();
  keys.set("command_errors", std::move(errors));
  return keys;
}

inline std::string error_of(model::Setup setup) {
  Diagnostics diagnostics;
  const auto made = Simulation::create(std::move(setup), {}, diagnostics);
  return made ? "" : made.error().text();
}

inline void drive(Simulation& simulation, double x, double turn = 0, const char* robot = "robot1") {
  msg::Twist twist;
  twist.linear.x = x;
  twist.angular.z = turn;
  simulation.submit(
      CommandRequest{std::string(robot) + "/mover", msg::Twist::ros_type, command_bytes(twist)});
}

/// What the device was given to follow in the latest tick.
inline const Topic<msg::Twist>& followed(const Simulation& simulation, const char* robot = "robot1") {
  for (const auto& each : simulation.find_entity(robot)->devices)
    if (each->decl.name == "mover") return *topic_cast<msg::Twist>(each->commands.front().topic.get());
  throw std::out_of_range(robot);
}

inline double speed_of(const Simulation& simulation) { return value(simulation, "robot1.twist.linear.x"); }

}  // namespace sandlot::test
