#pragma once
/// sensor_msgs (Humble): images and joysticks.
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "messages/std_msgs.h"

namespace sandlot::msg {

/// Rows of pixels from the top.
struct Image {
  static constexpr const char* ros_type = "sensor_msgs/msg/Image";
  Header header;
  std::uint32_t height = 0;
  std::uint32_t width = 0;
  std::string encoding;
  std::uint8_t is_bigendian = 0;
  std::uint32_t step = 0;
  std::vector<std::uint8_t> data;
  static void fields(auto& s, auto&& visit) {
    visit(header_field, s.header);
    visit(Field{"height", "1", "Number of rows."}, s.height);
    visit(Field{"width", "1", "Number of columns."}, s.width);
    visit(Field{"encoding", "", "Encoding of the pixels, such as rgb8, mono8, 32FC1."}, s.encoding);
    visit(Field{"is_bigendian", "1", "Order of bytes within a channel."}, s.is_bigendian);
    visit(Field{"step", "1", "Number of bytes per row."}, s.step);
    visit(Field{"data", "", "Bytes of the pixels."}, s.data);
  }
};

/// An image as a file of its format.
struct CompressedImage {
  static constexpr const char* ros_type = "sensor_msgs/msg/CompressedImage";
  Header header;
  std::string format;
  std::vector<std::uint8_t> data;
  static void fields(auto& s, auto&& visit) {
    visit(header_field, s.header);
    visit(Field{"format", "", "File format, such as jpeg, png."}, s.format);
    visit(Field{"data", "", "Bytes of the file."}, s.data);
  }
};

/// A part of an image; all zero: the whole.
struct RegionOfInterest {
  static constexpr const char* ros_type = "sensor_msgs/msg/RegionOfInterest";
  std::uint32_t x_offset = 0;
  std::uint32_t y_offset = 0;
  std::uint32_t height = 0;
  std::uint32_t width = 0;
  bool do_rectify = false;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"x_offset", "1", "Index of the first column."}, s.x_offset);
    visit(Field{"y_offset", "1", "Index of the first row."}, s.y_offset);
    visit(Field{"height", "1", "Number of rows."}, s.height);
    visit(Field{"width", "1", "Number of columns."}, s.width);
    visit(Field{"do_rectify", "", "Whether the part is of the rectified image."}, s.do_rectify);
  }
};

/// How a camera maps points to pixels.
struct CameraInfo {
  static constexpr const char* ros_type = "sensor_msgs/msg/CameraInfo";
  Header header;
  std::uint32_t height = 0;
  std::uint32_t width = 0;
  std::string distortion_model;
  std::vector<double> d;
  std::array<double, 9> k{};
  std::array<double, 9> r{};
  std::array<double, 12> p{};
  std::uint32_t binning_x = 0;
  std::uint32_t binning_y = 0;
  RegionOfInterest roi;
  static void fields(auto& s, auto&& visit) {
    visit(header_field, s.header);
    visit(Field{"height", "1", "Number of rows."}, s.height);
    visit(Field{"width", "1", "Number of columns."}, s.width);
    visit(Field{"distortion_model", "", "Name of the distortion model, such as plumb_bob."},
          s.distortion_model);
    visit(Field{"d", "", "Parameters of the distortion."}, s.d);
    visit(Field{"k", "", "Intrinsic matrix, row-major 3x3."}, s.k);
    visit(Field{"r", "", "Rectification matrix, row-major 3x3."}, s.r);
    visit(Field{"p", "", "Projection matrix, row-major 3x4."}, s.p);
    visit(Field{"binning_x", "1", "Number of pixels per column; 0 is 1."}, s.binning_x);
    visit(Field{"binning_y", "1", "Number of pixels per row; 0 is 1."}, s.binning_y);
    visit(Field{"roi", "", "Part of the image that is sent."}, s.roi);
  }
};

/// State of a joystick.
struct Joy {
  static constexpr const char* ros_type = "sensor_msgs/msg/Joy";
  Header header;
  std::vector<float> axes;
  std::vector<std::int32_t> buttons;
  static void fields(auto& s, auto&& visit) {
    visit(header_field, s.header);
    visit(Field{"axes", "1", "Positions of the axes, from -1 to 1."}, s.axes);
    visit(Field{"buttons", "1", "States of the buttons; 1: pressed."}, s.buttons);
  }
};

/// What a joystick shall do.
struct JoyFeedback {
  static constexpr const char* ros_type = "sensor_msgs/msg/JoyFeedback";
  std::uint8_t type = 0;
  std::uint8_t id = 0;
  float intensity = 0;
  static void constants(auto&& visit) {
    visit("TYPE_LED", std::uint8_t{0});
    visit("TYPE_RUMBLE", std::uint8_t{1});
    visit("TYPE_BUZZER", std::uint8_t{2});
  }
  static void fields(auto& s, auto&& visit) {
    visit(Field{"type", "1", "Type of the output, TYPE_..."}, s.type);
    visit(Field{"id", "1", "Index of the output among its type."}, s.id);
    visit(Field{"intensity", "1", "Strength of the output, from 0 to 1."}, s.intensity);
  }
};

/// Several orders for a joystick.
struct JoyFeedbackArray {
  static constexpr const char* ros_type = "sensor_msgs/msg/JoyFeedbackArray";
  std::vector<JoyFeedback> array;
  static void fields(auto& s, auto&& visit) { visit(Field{"array", "", "Outputs to set."}, s.array); }
};

}  // namespace sandlot::msg
