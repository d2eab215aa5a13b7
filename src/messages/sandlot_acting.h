#pragma once
/// sandlot_msgs of devices that act on others, and of high-level agents.
#include <cstdint>
#include <string>
#include <vector>

#include "messages/geometry_msgs.h"
#include "messages/std_msgs.h"

namespace sandlot::msg {

/// What a kicker is doing.
struct KickerState {
  static constexpr const char* ros_type = "sandlot_msgs/msg/KickerState";
  Header header;
  double charge = 0;
  bool ready = false;
  std::uint64_t kicks = 0;
  std::uint64_t hits = 0;
  double impulse = 0;
  std::string object;
  static void fields(auto& s, auto&& visit) {
    visit(header_field, s.header);
    visit(Field{"charge", "1", "Energy stored for the next kick, from 0 to 1."}, s.charge);
    visit(Field{"ready", "", "Whether the store is full."}, s.ready);
    visit(Field{"kicks", "1", "Number of kicks so far."}, s.kicks);
    visit(Field{"hits", "1", "Number of kicks that met something."}, s.hits);
    visit(Field{"impulse", "Ns", "Impulse of the latest kick; 0 where it met nothing."}, s.impulse);
    visit(Field{"object", "", "Robot or object that the latest kick met; empty: nothing."}, s.object);
  }
};

/// Speed of a robot and the direction in which it shall go.
struct SpeedHeading {
  static constexpr const char* ros_type = "sandlot_msgs/msg/SpeedHeading";
  double speed = 0;
  double heading = 0;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"speed", "m/s", "Speed forward."}, s.speed);
    visit(Field{"heading", "rad", "Heading in the world, counter-clockwise from its x axis."}, s.heading);
  }
};

/// A property that the user gives a robot or object, such as health.
struct Property {
  static constexpr const char* ros_type = "sandlot_msgs/msg/Property";
  std::string name;
  double value = 0;
  std::string unit;
  double min = 0;
  double max = 0;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"name", "", "Name of the property, such as health."}, s.name);
    visit(Field{"value", "", "Present value, in the property's unit."}, s.value);
    visit(Field{"unit", "", "Unit of the value and its limits; empty: none was given."}, s.unit);
    visit(Field{"min", "", "Least value, in the property's unit."}, s.min);
    visit(Field{"max", "", "Greatest value, in the property's unit."}, s.max);
  }
};

/// A property of a robot at a time.
struct PropertyStamped {
  static constexpr const char* ros_type = "sandlot_msgs/msg/PropertyStamped";
  Header header;
  Property property;
  static void fields(auto& s, auto&& visit) {
    visit(header_field, s.header);
    visit(Field{"property", "", "The property."}, s.property);
  }
};

/// A robot or object with all that is known of it.
struct VisibleObject {
  static constexpr const char* ros_type = "sandlot_msgs/msg/VisibleObject";
  std::string name;
  std::string label;
  std::string team;
  bool robot = false;
  ColorRGBA color;
  Pose pose;
  Twist velocity;
  double range = 0;
  double bearing = 0;
  Vec3 size;
  double mass = 0;
  std::vector<Property> properties;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"name", "", "Name of the robot or object."}, s.name);
    visit(Field{"label", "", "Label of the object, such as ball."}, s.label);
    visit(Field{"team", "", "Team of the robot; empty: none."}, s.team);
    visit(Field{"robot", "", "Whether it is a robot."}, s.robot);
    visit(Field{"color", "", "Colour of the object's largest part."}, s.color);
    visit(Field{"pose", "", "Pose of the object's body in header.frame_id."}, s.pose);
    visit(Field{"velocity", "",
                "Velocity of the object's body in the world, along the axes of header.frame_id."},
          s.velocity);
    visit(Field{"range", "m", "Distance to the object's middle."}, s.range);
    visit(Field{"bearing", "rad", "Angle to the object's middle: from x to y of the frame."}, s.bearing);
    visit(Field{"size", "m", "Size of the object along the axes of its body."}, s.size);
    visit(Field{"mass", "kg", "Mass of the whole object; 0: it does not move."}, s.mass);
    visit(Field{"properties", "", "Properties that the user gave it, in the order of the scenario."},
          s.properties);
  }
};

/// All robots and objects in sight.
struct VisibleObjectArray {
  static constexpr const char* ros_type = "sandlot_msgs/msg/VisibleObjectArray";
  Header header;
  std::vector<VisibleObject> objects;
  static void fields(auto& s, auto&& visit) {
    visit(header_field, s.header);
    visit(Field{"objects", "", "Objects in sight, in the order in which they came into the world."},
          s.objects);
  }
};

}  // namespace sandlot::msg
