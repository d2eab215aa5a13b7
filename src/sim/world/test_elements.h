#pragma once
/// Worlds with media, rules and markers for tests.
#include <gtest/gtest.h>

#include <cmath>
#include <initializer_list>
#include <string>

#include "sim/test_world.h"
#include "sim/watch/values.h"
#include "sim/world/simulation.h"
#include "sim/world/test_movers.h"

namespace sandlot::test {

inline Node list(std::initializer_list<Node> items) {
  Node out = Node::sequence();
  for (const Node& item : items) out.push(item);
  return out;
}
inline Node numbers(std::initializer_list<double> values) {
  Node out = Node::sequence();
  for (const double value : values) out.push(Node::scalar(std::to_string(value)));
  return out;
}
inline Node texts(std::initializer_list<const char*> values) {
  Node node = Node::sequence();
  for (const char* each : values) node.push(Node::scalar(each));
  return node;
}
inline Node with(Node node, const char* key, const Node& value) {
  node.set(key, value);
  return node;
}

inline model::ElementDecl element(const char* kind, Node config, const char* name = nullptr) {
  return {name ? name : kind, kind, std::move(config), {}};
}

inline std::string refused(model::Setup setup) {
  Diagnostics diagnostics;
  const auto made = Simulation::create(std::move(setup), {}, diagnostics);
  return made ? "" : made.error().text();
}

inline model::Setup weightless(double step_s = 0.01) {
  model::Setup setup;
  setup.step = Time::from_s(step_s);
  setup.gravity = {};
  return setup;
}

/// A speaker at the origin that looks along y and listeners on the x axis.
inline model::Setup talkers(std::initializer_list<double> listeners_m) {
  model::Setup setup = weightless();
  const auto ball = one_shape("ball", Sphere{0.1}, 1);
  model::Instance speaker = placed("speaker", ball, {});
  speaker.is_robot = true;
  speaker.devices.push_back(device("voice", "voice"));
  setup.instances.push_back(speaker);
  int number = 0;
  for (const double x_m : listeners_m) {
    model::Instance listener = placed("listener" + std::to_string(++number), ball,
                                      {{x_m, 0, 0}, quat_from_rpy(0, 0, math::pi / 2)});
    listener.is_robot = true;
    listener.devices.push_back(device("ear", "ear"));
    setup.instances.push_back(listener);
  }
  setup.media.push_back(
      element("shout", map({{"speed", "340"}, {"threshold", "40"}, {"wall_loss", "15"}}), "air"));
  return setup;
}

inline void say(Simulation& simulation, const std::string& word, const char* who = "speaker") {
  ByteWriter w;
  write(w, msg::String{word});
  simulation.submit(CommandRequest{
      std::string(who) + "/voice", msg::String::ros_type, {w.bytes().begin(), w.bytes().end()}});
}

}  // namespace sandlot::test
