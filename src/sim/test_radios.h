#pragma once
/// Worlds of radios that float without weight, for tests, validation and measurements: one medium, one radio per robot.
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/check.h"
#include "messages/messages.h"
#include "sim/watch/values.h"
#include "sim/world/simulation.h"

namespace sandlot::test {

using Keys = std::initializer_list<std::pair<const char*, std::string>>;

inline Node keys_of(Keys entries) {
  Node node = Node::map();
  for (const auto& [key, text] : entries) node.set(key, Node::scalar(text));
  return node;
}

class Radios {
 public:
  model::Setup setup;
  std::unique_ptr<Simulation> simulation;

  explicit Radios(Node medium, double step_s = 0.01, const char* kind = "radio") : device_(kind) {
    setup.step = Time::from_s(step_s);
    setup.gravity = {};
    setup.media.push_back({"air", kind, std::move(medium), {}});
    auto ball = std::make_shared<model::Model>();
    ball->name = "ball";
    model::Link link;
    link.name = "link";
    link.inertial.moments = {0.01, 0.01, 0.01};
    link.collisions.push_back({"collision", {}, Sphere{0.01}, {}, {}});
    ball->links.push_back(std::move(link));
    ball_ = std::move(ball);
  }

  /// A robot with one device, "radio".
  model::Instance& add(const std::string& name, Vec3 at, Node config = Node::map(), double yaw_rad = 0) {
    model::Instance robot;
    robot.name = robot.original_name = name;
    robot.model = ball_;
    robot.X_WM = {at, quat_from_rpy(0, 0, yaw_rad)};
    robot.is_robot = true;
    model::DeviceDecl device;
    device.name = "radio";
    device.kind = device_;
    device.config = std::move(config);
    robot.devices.push_back(std::move(device));
    setup.instances.push_back(std::move(robot));
    return setup.instances.back();
  }
  /// The next radios are devices of this kind.
  void next_are(const char* kind) { device_ = kind; }
  /// A thing that stands still.
  model::Instance& add_thing(const std::string& name, const Shape& shape, Vec3 at,
                             std::optional<model::Substance> substance = {}) {
    auto model = std::make_shared<model::Model>();
    model->name = name;
    model->is_static = true;
    model::Link link;
    link.name = "link";
    link.collisions.push_back({"collision", {}, shape, {}, {}});
    link.collisions.back().surface.substance = substance;
    model->links.push_back(std::move(link));
    model::Instance thing;
    thing.name = thing.original_name = name;
    thing.model = std::move(model);
    thing.X_WM = {at, {}};
    setup.instances.push_back(std::move(thing));
    return setup.instances.back();
  }

  void start(const SimulationOptions& options = {}) {
    Diagnostics diagnostics;
    auto made = Simulation::create(setup, options, diagnostics);
    SL_CHECK_MSG(made, made ? "" : made.error().text().c_str());
    simulation = std::move(*made);
  }
  void send(const std::string& from, std::vector<std::uint8_t> data, const std::string& to = "") {
    ByteWriter w;
    write(w, msg::RadioPacket{to, std::move(data)});
    simulation->submit(
        CommandRequest{from + "/radio", msg::RadioPacket::ros_type, {w.bytes().begin(), w.bytes().end()}});
  }
  void tick(int count = 1) {
    for (int i = 0; i < count; ++i) SL_CHECK(simulation->tick());
  }
  double value(const std::string& address) const {
    auto found = NamedValue::find(*simulation, address);
    SL_CHECK_MSG(found, found ? "" : found.error().text().c_str());
    return found->read().value_or(-1);
  }
  /// What arrived in the latest tick; nothing if that was earlier.
  std::vector<msg::RadioReception> received(const std::string& robot, const char* level = "packets") const {
    const auto* const topic = topic_cast<msg::RadioReceptionArray>(
        simulation->find_topic("/" + robot + "/radio/" + level));
    SL_CHECK(topic != nullptr);
    return topic->count > 0 && topic->stamp == simulation->now() ? topic->message.packets
                                                                 : std::vector<msg::RadioReception>{};
  }

 private:
  const char* device_;
  std::shared_ptr<const model::Model> ball_;
};

}  // namespace sandlot::test
