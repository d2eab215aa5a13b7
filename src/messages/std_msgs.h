#pragma once
/// std_msgs and builtin_interfaces (Humble), and what the other packages are made of: Time and Vec3, Quat and Pose of
/// geometry/ serve as builtin_interfaces/Time, geometry_msgs/Vector3, Quaternion and Pose (messages/info.h).
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "base/time.h"
#include "geometry/pose.h"

namespace sandlot::msg {

/// builtin_interfaces/Duration: a Time that counts from no particular beginning.
struct Duration : Time {
  constexpr Duration() = default;
  constexpr Duration(Time time) : Time(time) {}  // NOLINT(google-explicit-constructor)
};

/// geometry_msgs/Point: a Vec3 that is a place. The wire does not tell them apart, schemas do.
struct Point : Vec3 {
  constexpr Point() = default;
  constexpr Point(Vec3 v) : Vec3(v) {}  // NOLINT(google-explicit-constructor)
  constexpr Point(double x_m, double y_m, double z_m) : Vec3{x_m, y_m, z_m} {}
};

/// A bool that can stand in a list: std::vector<bool> has no elements to point at.
struct Boolean {
  bool value = false;
  static void fields(auto& s, auto&& visit) { visit(Field{"value", "", "Value of the message."}, s.value); }
};

/// std_msgs/Header. The frame's name is fixed when the device is built.
struct Header {
  static constexpr const char* ros_type = "std_msgs/msg/Header";
  Time stamp;
  std::string frame_id;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"stamp", "ns", "Simulated time of the measurement."}, s.stamp);
    visit(Field{"frame_id", "", "Frame the data is expressed in."}, s.frame_id);
  }
};
inline constexpr Field header_field{"header", "", "Stamp and frame."};

/// std_msgs/ColorRGBA.
struct ColorRGBA {
  static constexpr const char* ros_type = "std_msgs/msg/ColorRGBA";
  float r = 0, g = 0, b = 0, a = 0;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"r", "1", "Red, from 0 to 1."}, s.r);
    visit(Field{"g", "1", "Green, from 0 to 1."}, s.g);
    visit(Field{"b", "1", "Blue, from 0 to 1."}, s.b);
    visit(Field{"a", "1", "Opacity, from 0 to 1."}, s.a);
  }
};

/// std_msgs/Empty.
struct Empty {
  static constexpr const char* ros_type = "std_msgs/msg/Empty";
  static void fields(auto&, auto&&) {}
};

/// The name of a type as a template argument.
template <std::size_t N>
struct TypeName {
  char text[N];
  constexpr TypeName(const char (&name)[N]) {
    std::copy_n(name, N, text);
  }  // NOLINT(google-explicit-constructor)
};

/// The messages of std_msgs that are one value.
template <class T, TypeName name>
struct Value {
  static constexpr const char* ros_type = name.text;
  T data{};
  static void fields(auto& s, auto&& visit) { visit(Field{"data", "1", "Data of the message."}, s.data); }
};
using Bool = Value<bool, "std_msgs/msg/Bool">;
using Byte = Value<std::byte, "std_msgs/msg/Byte">;
using Char = Value<char, "std_msgs/msg/Char">;
using Int8 = Value<std::int8_t, "std_msgs/msg/Int8">;
using UInt8 = Value<std::uint8_t, "std_msgs/msg/UInt8">;
using Int16 = Value<std::int16_t, "std_msgs/msg/Int16">;
using UInt16 = Value<std::uint16_t, "std_msgs/msg/UInt16">;
using Int32 = Value<std::int32_t, "std_msgs/msg/Int32">;
using UInt32 = Value<std::uint32_t, "std_msgs/msg/UInt32">;
using Int64 = Value<std::int64_t, "std_msgs/msg/Int64">;
using UInt64 = Value<std::uint64_t, "std_msgs/msg/UInt64">;
using Float32 = Value<float, "std_msgs/msg/Float32">;
using Float64 = Value<double, "std_msgs/msg/Float64">;
using String = Value<std::string, "std_msgs/msg/String">;

/// std_msgs/MultiArrayDimension.
struct MultiArrayDimension {
  static constexpr const char* ros_type = "std_msgs/msg/MultiArrayDimension";
  std::string label;
  std::uint32_t size = 0, stride = 0;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"label", "", "Name of the dimension."}, s.label);
    visit(Field{"size", "1", "Length of the dimension."}, s.size);
    visit(Field{"stride", "1", "Number of elements in this and all following dimensions."}, s.stride);
  }
};

/// std_msgs/MultiArrayLayout.
struct MultiArrayLayout {
  static constexpr const char* ros_type = "std_msgs/msg/MultiArrayLayout";
  std::vector<MultiArrayDimension> dim;
  std::uint32_t data_offset = 0;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"dim", "", "Dimensions, outermost first."}, s.dim);
    visit(Field{"data_offset", "1", "Number of elements before the first one."}, s.data_offset);
  }
};

/// The messages of std_msgs that are an array with any number of dimensions.
template <class T, TypeName name>
struct MultiArray {
  static constexpr const char* ros_type = name.text;
  MultiArrayLayout layout;
  std::vector<T> data;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"layout", "", "Layout of the elements."}, s.layout);
    visit(Field{"data", "1", "Data of the message."}, s.data);
  }
};
using ByteMultiArray = MultiArray<std::byte, "std_msgs/msg/ByteMultiArray">;
using Int8MultiArray = MultiArray<std::int8_t, "std_msgs/msg/Int8MultiArray">;
using UInt8MultiArray = MultiArray<std::uint8_t, "std_msgs/msg/UInt8MultiArray">;
using Int16MultiArray = MultiArray<std::int16_t, "std_msgs/msg/Int16MultiArray">;
using UInt16MultiArray = MultiArray<std::uint16_t, "std_msgs/msg/UInt16MultiArray">;
using Int32MultiArray = MultiArray<std::int32_t, "std_msgs/msg/Int32MultiArray">;
using UInt32MultiArray = MultiArray<std::uint32_t, "std_msgs/msg/UInt32MultiArray">;
using Int64MultiArray = MultiArray<std::int64_t, "std_msgs/msg/Int64MultiArray">;
using UInt64MultiArray = MultiArray<std::uint64_t, "std_msgs/msg/UInt64MultiArray">;
using Float32MultiArray = MultiArray<float, "std_msgs/msg/Float32MultiArray">;
using Float64MultiArray = MultiArray<double, "std_msgs/msg/Float64MultiArray">;

}  // namespace sandlot::msg
