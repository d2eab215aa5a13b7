#pragma once
/// Property sensor: a property that the user gives the robot, such as health, as a message to its programs.
///
/// Output   level `property`: sandlot_msgs/PropertyStamped: name, present value, unit and limits of the property `property`.
/// Time     in the phase of the sensors: what a rule sets in a tick is published at the end of the next one.
/// Noise    none.
/// Limits   one property per sensor; it reads those of its own robot only. For those of others in sight: agent_eyes.
/// Cost     a few assignments per sample, no allocation.
/// Errors   the robot has no property of that name.
#include "devices/kind.h"
#include "messages/messages.h"

namespace sandlot::property_sensor {

struct Spec {
  std::string property;
  double rate_hz = 10;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"property", "", "Name of the robot's property to publish, such as health.", 0, 0,
                Field::required, 100},
          s.property);
    visit(Field{"rate", "Hz", "Samples per second; 0: one in every tick.", 0, 1e5}, s.rate_hz);
  }
};

struct PropertySensor {
  using Spec = property_sensor::Spec;
  using State = NoFields;
  Spec spec;
  State state;

  const model::PropertyDecl* property = nullptr;  ///< of the robot, which outlives its devices
  Topic<msg::PropertyStamped>* topic = nullptr;

  static Result<PropertySensor> create(const DeviceBuild& build, Spec spec);
  static void sense(PoolView<PropertySensor> pool, const Context& context);
};

extern const Kind kind;

}  // namespace sandlot::property_sensor
