#pragma once
/// sensor_msgs (Humble): distances and clouds of points.
#include <cstdint>
#include <string>
#include <vector>

#include "messages/geometry_msgs.h"
#include "messages/geometry_shapes.h"

namespace sandlot::msg {

/// Beams in order of angle. REP 117: +inf nothing seen, -inf too near, NaN invalid.
struct LaserScan {
  static constexpr const char* ros_type = "sensor_msgs/msg/LaserScan";
  Header header;
  float angle_min = 0;
  float angle_max = 0;
  float angle_increment = 0;
  float time_increment = 0;
  float scan_time = 0;
  float range_min = 0;
  float range_max = 0;
  std::vector<float> ranges;
  std::vector<float> intensities;
  static void fields(auto& s, auto&& visit) {
    visit(header_field, s.header);
    visit(Field{"angle_min", "rad", "Angle of beam 0."}, s.angle_min);
    visit(Field{"angle_max", "rad", "Angle of the last beam."}, s.angle_max);
    visit(Field{"angle_increment", "rad", "Angle between beams."}, s.angle_increment);
    visit(Field{"time_increment", "s", "Time between beams."}, s.time_increment);
    visit(Field{"scan_time", "s", "Time between scans."}, s.scan_time);
    visit(Field{"range_min", "m", "Shortest distance measured."}, s.range_min);
    visit(Field{"range_max", "m", "Longest distance measured."}, s.range_max);
    visit(Field{"ranges", "m", "Distances of the beams."}, s.ranges);
    visit(Field{"intensities", "1", "Intensities; empty when not modelled."}, s.intensities);
  }
};

/// All echoes of one beam.
struct LaserEcho {
  static constexpr const char* ros_type = "sensor_msgs/msg/LaserEcho";
  std::vector<float> echoes;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"echoes", "m", "Distances or intensities of one beam."}, s.echoes);
  }
};

/// A scan with several echoes per beam.
struct MultiEchoLaserScan {
  static constexpr const char* ros_type = "sensor_msgs/msg/MultiEchoLaserScan";
  Header header;
  float angle_min = 0;
  float angle_max = 0;
  float angle_increment = 0;
  float time_increment = 0;
  float scan_time = 0;
  float range_min = 0;
  float range_max = 0;
  std::vector<LaserEcho> ranges;
  std::vector<LaserEcho> intensities;
  static void fields(auto& s, auto&& visit) {
    visit(header_field, s.header);
    visit(Field{"angle_min", "rad", "Angle of beam 0."}, s.angle_min);
    visit(Field{"angle_max", "rad", "Angle of the last beam."}, s.angle_max);
    visit(Field{"angle_increment", "rad", "Angle between beams."}, s.angle_increment);
    visit(Field{"time_increment", "s", "Time between beams."}, s.time_increment);
    visit(Field{"scan_time", "s", "Time between scans."}, s.scan_time);
    visit(Field{"range_min", "m", "Shortest distance measured."}, s.range_min);
    visit(Field{"range_max", "m", "Longest distance measured."}, s.range_max);
    visit(Field{"ranges", "m", "Distances of the echoes, per beam."}, s.ranges);
    visit(Field{"intensities", "1", "Intensities per beam; empty when not modelled."}, s.intensities);
  }
};

/// One distance in a cone. +inf nothing seen, -inf too near (REP 117).
struct Range {
  static constexpr const char* ros_type = "sensor_msgs/msg/Range";
  static constexpr std::uint8_t ultrasound = 0;
  static constexpr std::uint8_t infrared = 1;
  Header header;
  std::uint8_t radiation_type = 0;
  float field_of_view = 0;
  float min_range = 0;
  float max_range = 0;
  float range = 0;
  static void constants(auto&& visit) {
    visit("ULTRASOUND", ultrasound);
    visit("INFRARED", infrared);
  }
  static void fields(auto& s, auto&& visit) {
    visit(header_field, s.header);
    visit(Field{"radiation_type", "1", "Type of radiation. 0: ultrasound, 1: infra-red."}, s.radiation_type);
    visit(Field{"field_of_view", "rad", "Opening angle of the cone, from edge to edge."}, s.field_of_view);
    visit(Field{"min_range", "m", "Shortest distance measured."}, s.min_range);
    visit(Field{"max_range", "m", "Longest distance measured."}, s.max_range);
    visit(Field{"range", "m", "Measured distance."}, s.range);
  }
};

/// Where a value stands within a point of a PointCloud2.
struct PointField {
  static constexpr const char* ros_type = "sensor_msgs/msg/PointField";
  static constexpr std::uint8_t uint16 = 4;
  static constexpr std::uint8_t float32 = 7;
  std::string name;
  std::uint32_t offset = 0;
  std::uint8_t datatype = float32;
  std::uint32_t count = 1;
  static void constants(auto&& visit) {
    visit("INT8", std::uint8_t{1});
    visit("UINT8", std::uint8_t{2});
    visit("INT16", std::uint8_t{3});
    visit("UINT16", uint16);
    visit("INT32", std::uint8_t{5});
    visit("UINT32", std::uint8_t{6});
    visit("FLOAT32", float32);
    visit("FLOAT64", std::uint8_t{8});
  }
  static void fields(auto& s, auto&& visit) {
    visit(Field{"name", "", "Name of the value."}, s.name);
    visit(Field{"offset", "1", "Number of bytes from the beginning of the point."}, s.offset);
    visit(Field{"datatype", "1", "Type of the value. 4: uint16, 7: float32 ..."}, s.datatype);
    visit(Field{"count", "1", "Number of elements."}, s.count);
  }
};

/// `height` rows of `width` points.
struct PointCloud2 {
  static constexpr const char* ros_type = "sensor_msgs/msg/PointCloud2";
  Header header;
  std::uint32_t height = 0;
  std::uint32_t width = 0;
  std::vector<PointField> point_fields;
  bool is_bigendian = false;
  std::uint32_t point_step = 0;
  std::uint32_t row_step = 0;
  std::vector<std::uint8_t> data;
  bool is_dense = false;
  static void fields(auto& s, auto&& visit) {
    visit(header_field, s.header);
    visit(Field{"height", "1", "Number of rows; 1: the points are in no order."}, s.height);
    visit(Field{"width", "1", "Number of points per row."}, s.width);
    visit(Field{"fields", "", "Values of each point."}, s.point_fields);
    visit(Field{"is_bigendian", "", "Whether the most significant byte comes first."}, s.is_bigendian);
    visit(Field{"point_step", "1", "Number of bytes per point."}, s.point_step);
    visit(Field{"row_step", "1", "Number of bytes per row."}, s.row_step);
    visit(Field{"data", "", "Bytes of the points."}, s.data);
    visit(Field{"is_dense", "", "Whether all points are valid; false: points without a hit are NaN."},
          s.is_dense);
  }
};

/// One value for each point of a PointCloud.
struct ChannelFloat32 {
  static constexpr const char* ros_type = "sensor_msgs/msg/ChannelFloat32";
  std::string name;
  std::vector<float> values;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"name", "", "Name of the value."}, s.name);
    visit(Field{"values", "", "In the order of the points."}, s.values);
  }
};

/// Points in the old form.
struct PointCloud {
  static constexpr const char* ros_type = "sensor_msgs/msg/PointCloud";
  Header header;
  std::vector<Point32> points;
  std::vector<ChannelFloat32> channels;
  static void fields(auto& s, auto&& visit) {
    visit(header_field, s.header);
    visit(Field{"points", "m", "Positions of the points."}, s.points);
    visit(Field{"channels", "", "Additional values of the points."}, s.channels);
  }
};

}  // namespace sandlot::msg
