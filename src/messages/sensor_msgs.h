#pragma once
/// sensor_msgs (Humble); distances are in sensor_ranges.h, images and joysticks in sensor_images.h.
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "messages/geometry_msgs.h"
#include "messages/sensor_ranges.h"

namespace sandlot::msg {

/// Orientation, rate of turn, specific force. Covariances are row-major 3x3; -1 in [0]: not measured.
struct Imu {
  static constexpr const char* ros_type = "sensor_msgs/msg/Imu";
  Header header;
  Quat orientation;
  std::array<double, 9> orientation_covariance{};
  Vec3 angular_velocity;
  std::array<double, 9> angular_velocity_covariance{};
  Vec3 linear_acceleration;
  std::array<double, 9> linear_acceleration_covariance{};
  static void fields(auto& s, auto&& visit) {
    visit(header_field, s.header);
    visit(Field{"orientation", "1", "Orientation of the sensor in its reference frame."}, s.orientation);
    visit(Field{"orientation_covariance", "", "Covariance of the orientation, row-major 3x3."},
          s.orientation_covariance);
    visit(Field{"angular_velocity", "rad/s", "Rate of turn in header.frame_id."}, s.angular_velocity);
    visit(Field{"angular_velocity_covariance", "", "Covariance of the angular velocity, row-major 3x3."},
          s.angular_velocity_covariance);
    visit(Field{"linear_acceleration", "m/s^2", "Specific force in header.frame_id: (0, 0, 9.81) at rest."},
          s.linear_acceleration);
    visit(Field{"linear_acceleration_covariance", "", "Covariance of the specific force, row-major 3x3."},
          s.linear_acceleration_covariance);
  }
};

/// State of joints; lists that are not empty have the length of `name`.
struct JointState {
  static constexpr const char* ros_type = "sensor_msgs/msg/JointState";
  Header header;
  std::vector<std::string> name;
  std::vector<double> position;
  std::vector<double> velocity;
  std::vector<double> effort;
  static void fields(auto& s, auto&& visit) {
    visit(header_field, s.header);
    visit(Field{"name", "", "Names of the joints."}, s.name);
    visit(Field{"position", "rad", "Positions; m where the joint slides."}, s.position);
    visit(Field{"velocity", "rad/s", "Velocities; m/s where the joint slides."}, s.velocity);
    visit(Field{"effort", "Nm", "Torques; N where the joint slides."}, s.effort);
  }
};

/// State of joints with several degrees of freedom.
struct MultiDOFJointState {
  static constexpr const char* ros_type = "sensor_msgs/msg/MultiDOFJointState";
  Header header;
  std::vector<std::string> joint_names;
  std::vector<Transform> transforms;
  std::vector<Twist> twist;
  std::vector<Wrench> wrench;
  static void fields(auto& s, auto&& visit) {
    visit(header_field, s.header);
    visit(Field{"joint_names", "", "Names of the joints."}, s.joint_names);
    visit(Field{"transforms", "", "Poses of the joints."}, s.transforms);
    visit(Field{"twist", "", "Velocities of the joints."}, s.twist);
    visit(Field{"wrench", "", "Forces and torques of the joints."}, s.wrench);
  }
};

/// What kind of fix a satellite receiver has.
struct NavSatStatus {
  static constexpr const char* ros_type = "sensor_msgs/msg/NavSatStatus";
  static constexpr std::int8_t no_fix = -1;
  static constexpr std::int8_t fix = 0;
  static constexpr std::int8_t sbas_fix = 1;
  static constexpr std::int8_t gbas_fix = 2;
  static constexpr std::uint16_t gps = 1;
  std::int8_t status = 0;
  std::uint16_t service = 0;
  static void constants(auto&& visit) {
    visit("STATUS_NO_FIX", no_fix);
    visit("STATUS_FIX", fix);
    visit("STATUS_SBAS_FIX", sbas_fix);
    visit("STATUS_GBAS_FIX", gbas_fix);
    visit("SERVICE_GPS", gps);
    visit("SERVICE_GLONASS", std::uint16_t{2});
    visit("SERVICE_COMPASS", std::uint16_t{4});
    visit("SERVICE_GALILEO", std::uint16_t{8});
  }
  static void fields(auto& s, auto&& visit) {
    visit(Field{"status", "1",
                "Type of the fix. -1: no fix, 0: fix, 1: with satellite based, 2: with ground based "
                "augmentation."},
          s.status);
    visit(Field{"service", "1", "Satellites used, a sum of bits."}, s.service);
  }
};

/// Position in WGS 84.
struct NavSatFix {
  static constexpr const char* ros_type = "sensor_msgs/msg/NavSatFix";
  static constexpr std::uint8_t covariance_unknown = 0;
  static constexpr std::uint8_t covariance_approximated = 1;
  static constexpr std::uint8_t covariance_diagonal_known = 2;
  static constexpr std::uint8_t covariance_known = 3;
  Header header;
  NavSatStatus status;
  double latitude = 0;
  double longitude = 0;
  double altitude = 0;
  std::array<double, 9> position_covariance{};
  std::uint8_t position_covariance_type = 0;
  static void constants(auto&& visit) {
    visit("COVARIANCE_TYPE_UNKNOWN", covariance_unknown);
    visit("COVARIANCE_TYPE_APPROXIMATED", covariance_approximated);
    visit("COVARIANCE_TYPE_DIAGONAL_KNOWN", covariance_diagonal_known);
    visit("COVARIANCE_TYPE_KNOWN", covariance_known);
  }
  static void fields(auto& s, auto&& visit) {
    visit(header_field, s.header);
    visit(Field{"status", "", "Status of the fix."}, s.status);
    visit(Field{"latitude", "deg", "Latitude, north positive."}, s.latitude);
    visit(Field{"longitude", "deg", "Longitude, east positive."}, s.longitude);
    visit(Field{"altitude", "m", "Altitude above the ellipsoid; NaN: not known."}, s.altitude);
    visit(Field{"position_covariance", "m^2", "Covariance of the position, row-major 3x3: east, north, up."},
          s.position_covariance);
    visit(Field{"position_covariance_type", "1",
                "Type of the covariance. 0: unknown, 1: approximated, 2: diagonal known, 3: known."},
          s.position_covariance_type);
  }
};

/// Magnetic flux density.
struct MagneticField {
  static constexpr const char* ros_type = "sensor_msgs/msg/MagneticField";
  Header header;
  Vec3 magnetic_field;
  std::array<double, 9> magnetic_field_covariance{};
  static void fields(auto& s, auto&& visit) {
    visit(header_field, s.header);
    visit(Field{"magnetic_field", "T", "Magnetic field in header.frame_id."}, s.magnetic_field);
    visit(Field{"magnetic_field_covariance", "", "Covariance of the magnetic field, row-major 3x3."},
          s.magnetic_field_covariance);
  }
};

/// Pressure of air or water.
struct FluidPressure {
  static constexpr const char* ros_type = "sensor_msgs/msg/FluidPressure";
  Header header;
  double fluid_pressure = 0;
  double variance = 0;
  static void fields(auto& s, auto&& visit) {
    visit(header_field, s.header);
    visit(Field{"fluid_pressure", "Pa", "Absolute pressure of the fluid."}, s.fluid_pressure);
    visit(Field{"variance", "Pa^2", "Variance of the value; 0: not known."}, s.variance);
  }
};

/// Temperature.
struct Temperature {
  static constexpr const char* ros_type = "sensor_msgs/msg/Temperature";
  Header header;
  double temperature = 0;
  double variance = 0;
  static void fields(auto& s, auto&& visit) {
    visit(header_field, s.header);
    visit(Field{"temperature", "degC", "Measured temperature."}, s.temperature);
    visit(Field{"variance", "", "Variance of the value; 0: not known."}, s.variance);
  }
};

/// Light on a photo cell.
struct Illuminance {
  static constexpr const char* ros_type = "sensor_msgs/msg/Illuminance";
  Header header;
  double illuminance = 0;
  double variance = 0;
  static void fields(auto& s, auto&& visit) {
    visit(header_field, s.header);
    visit(Field{"illuminance", "lx", "Measured illuminance."}, s.illuminance);
    visit(Field{"variance", "", "Variance of the value; 0: not known."}, s.variance);
  }
};

/// Humidity of the air.
struct RelativeHumidity {
  static constexpr const char* ros_type = "sensor_msgs/msg/RelativeHumidity";
  Header header;
  double relative_humidity = 0;
  double variance = 0;
  static void fields(auto& s, auto&& visit) {
    visit(header_field, s.header);
    visit(Field{"relative_humidity", "1", "Relative humidity, from 0 to 1."}, s.relative_humidity);
    visit(Field{"variance", "", "Variance of the value; 0: not known."}, s.variance);
  }
};

/// What another clock shows.
struct TimeReference {
  static constexpr const char* ros_type = "sensor_msgs/msg/TimeReference";
  Header header;
  Time time_ref;
  std::string source;
  static void fields(auto& s, auto&& visit) {
    visit(header_field, s.header);
    visit(Field{"time_ref", "s", "The other clock's time."}, s.time_ref);
    visit(Field{"source", "", "Name of the other clock."}, s.source);
  }
};

/// State of a battery; NaN: not measured.
struct BatteryState {
  static constexpr const char* ros_type = "sensor_msgs/msg/BatteryState";
  Header header;
  float voltage = 0;
  float temperature = 0;
  float current = 0;
  float charge = 0;
  float capacity = 0;
  float design_capacity = 0;
  float percentage = 0;
  std::uint8_t power_supply_status = 0;
  std::uint8_t power_supply_health = 0;
  std::uint8_t power_supply_technology = 0;
  bool present = false;
  std::vector<float> cell_voltage;
  std::vector<float> cell_temperature;
  std::string location;
  std::string serial_number;
  static void constants(auto&& visit) {
    visit("POWER_SUPPLY_STATUS_UNKNOWN", std::uint8_t{0});
    visit("POWER_SUPPLY_STATUS_CHARGING", std::uint8_t{1});
    visit("POWER_SUPPLY_STATUS_DISCHARGING", std::uint8_t{2});
    visit("POWER_SUPPLY_STATUS_NOT_CHARGING", std::uint8_t{3});
    visit("POWER_SUPPLY_STATUS_FULL", std::uint8_t{4});
    visit("POWER_SUPPLY_HEALTH_UNKNOWN", std::uint8_t{0});
    visit("POWER_SUPPLY_HEALTH_GOOD", std::uint8_t{1});
    visit("POWER_SUPPLY_HEALTH_OVERHEAT", std::uint8_t{2});
    visit("POWER_SUPPLY_HEALTH_DEAD", std::uint8_t{3});
    visit("POWER_SUPPLY_HEALTH_OVERVOLTAGE", std::uint8_t{4});
    visit("POWER_SUPPLY_HEALTH_UNSPEC_FAILURE", std::uint8_t{5});
    visit("POWER_SUPPLY_HEALTH_COLD", std::uint8_t{6});
    visit("POWER_SUPPLY_HEALTH_WATCHDOG_TIMER_EXPIRE", std::uint8_t{7});
    visit("POWER_SUPPLY_HEALTH_SAFETY_TIMER_EXPIRE", std::uint8_t{8});
    visit("POWER_SUPPLY_TECHNOLOGY_UNKNOWN", std::uint8_t{0});
    visit("POWER_SUPPLY_TECHNOLOGY_NIMH", std::uint8_t{1});
    visit("POWER_SUPPLY_TECHNOLOGY_LION", std::uint8_t{2});
    visit("POWER_SUPPLY_TECHNOLOGY_LIPO", std::uint8_t{3});
    visit("POWER_SUPPLY_TECHNOLOGY_LIFE", std::uint8_t{4});
    visit("POWER_SUPPLY_TECHNOLOGY_NICD", std::uint8_t{5});
    visit("POWER_SUPPLY_TECHNOLOGY_LIMN", std::uint8_t{6});
  }
  static void fields(auto& s, auto&& visit) {
    visit(header_field, s.header);
    visit(Field{"voltage", "V", "Voltage of the battery."}, s.voltage);
    visit(Field{"temperature", "degC", "Temperature of the battery."}, s.temperature);
    visit(Field{"current", "A", "Current of the battery, negative when discharging."}, s.current);
    visit(Field{"charge", "Ah", "Charge that is left."}, s.charge);
    visit(Field{"capacity", "Ah", "Charge of the full battery."}, s.capacity);
    visit(Field{"design_capacity", "Ah", "Charge when new and full."}, s.design_capacity);
    visit(Field{"percentage", "1", "Charge as a share of the capacity, from 0 to 1."}, s.percentage);
    visit(Field{"power_supply_status", "1", "Status, one of POWER_SUPPLY_STATUS_..."}, s.power_supply_status);
    visit(Field{"power_supply_health", "1", "Health, one of POWER_SUPPLY_HEALTH_..."}, s.power_supply_health);
    visit(Field{"power_supply_technology", "1", "Technology, one of POWER_SUPPLY_TECHNOLOGY_..."},
          s.power_supply_technology);
    visit(Field{"present", "", "Whether a battery is present."}, s.present);
    visit(Field{"cell_voltage", "V", "Voltage of each cell; empty: not known."}, s.cell_voltage);
    visit(Field{"cell_temperature", "degC", "Temperature of each cell; empty: not known."},
          s.cell_temperature);
    visit(Field{"location", "", "Place where the battery is mounted."}, s.location);
    visit(Field{"serial_number", "", "Serial number of the battery."}, s.serial_number);
  }
};

}  // namespace sandlot::msg
