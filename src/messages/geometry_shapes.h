#pragma once
/// geometry_msgs (Humble): what bodies are made of.
#include <cstdint>
#include <vector>

#include "messages/std_msgs.h"

namespace sandlot::msg {

/// A point in single precision.
struct Point32 {
  static constexpr const char* ros_type = "geometry_msgs/msg/Point32";
  float x = 0;
  float y = 0;
  float z = 0;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"x", "m", "Coordinate along x."}, s.x);
    visit(Field{"y", "m", "Coordinate along y."}, s.y);
    visit(Field{"z", "m", "Coordinate along z."}, s.z);
  }
};

/// A closed line; the last point is joined to the first.
struct Polygon {
  static constexpr const char* ros_type = "geometry_msgs/msg/Polygon";
  std::vector<Point32> points;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"points", "m", "Corners of the polygon."}, s.points);
  }
};

/// A polygon in a frame.
struct PolygonStamped {
  static constexpr const char* ros_type = "geometry_msgs/msg/PolygonStamped";
  Header header;
  Polygon polygon;
  static void fields(auto& s, auto&& visit) {
    visit(header_field, s.header);
    visit(Field{"polygon", "m", "The polygon in header.frame_id."}, s.polygon);
  }
};

/// Mass, centre of mass and moments of inertia about it.
struct Inertia {
  static constexpr const char* ros_type = "geometry_msgs/msg/Inertia";
  double m = 0;
  Vec3 com;
  double ixx = 0;
  double ixy = 0;
  double ixz = 0;
  double iyy = 0;
  double iyz = 0;
  double izz = 0;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"m", "kg", "Mass of the body."}, s.m);
    visit(Field{"com", "m", "Centre of mass of the body."}, s.com);
    visit(Field{"ixx", "kg m^2", "Moment of inertia about x."}, s.ixx);
    visit(Field{"ixy", "kg m^2", "Product of inertia xy."}, s.ixy);
    visit(Field{"ixz", "kg m^2", "Product of inertia xz."}, s.ixz);
    visit(Field{"iyy", "kg m^2", "Moment of inertia about y."}, s.iyy);
    visit(Field{"iyz", "kg m^2", "Product of inertia yz."}, s.iyz);
    visit(Field{"izz", "kg m^2", "Moment of inertia about z."}, s.izz);
  }
};

/// Inertia in a frame.
struct InertiaStamped {
  static constexpr const char* ros_type = "geometry_msgs/msg/InertiaStamped";
  Header header;
  Inertia inertia;
  static void fields(auto& s, auto&& visit) {
    visit(header_field, s.header);
    visit(Field{"inertia", "", "Inertia in header.frame_id."}, s.inertia);
  }
};

}  // namespace sandlot::msg
