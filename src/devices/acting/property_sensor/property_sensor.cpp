#include "devices/acting/property_sensor/property_sensor.h"

#include "base/text.h"
#include "devices/acting/property_message.h"

namespace sandlot::property_sensor {

Result<PropertySensor> PropertySensor::create(const DeviceBuild& build, Spec spec) {
  PropertySensor sensor{std::move(spec)};
  const std::string& name = sensor.spec.property;
  sensor.property = build.instance.find_property(name);
  if (!sensor.property) {
    std::vector<std::string> names;
    for (const model::PropertyDecl& each : build.instance.properties) names.push_back(each.name);
    return build.error(
        "property", "'" + build.instance.name + "' has no property '" + name + "'",
        names.empty() ? "declare it: properties: {" + name + ": 100}" : suggestion(name, names));
  }
  sensor.topic = build.publish<msg::PropertyStamped>(0, "property");
  sensor.topic->message.header.frame_id = build.frame_id();
  return sensor;
}

void PropertySensor::sense(PoolView<PropertySensor> pool, const Context& context) {
  for (const std::uint32_t index : pool.due) {
    PropertySensor& sensor = pool.all[index];
    acting::fill(sensor.topic->message.property, *sensor.property);
    sensor.topic->publish(context.now);
  }
}

namespace {
constexpr LevelInfo levels[] = {
    {"property", msg::PropertyStamped::ros_type, "", "The property with its present value and its limits."},
};
}  // namespace

constinit const Kind kind = make_kind<PropertySensor>({
    .name = "property_sensor",
    .help = "A property of the robot that the user gives it, such as health, for its programs.",
    .levels = levels,
});

}  // namespace sandlot::property_sensor
