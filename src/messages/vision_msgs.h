#pragma once
/// vision_msgs (Humble, 4.0): detections in images.
#include <cstdint>
#include <string>
#include <vector>

#include "messages/geometry_msgs.h"

namespace sandlot::msg::vision {

/// A place in an image.
struct Point2D {
  static constexpr const char* ros_type = "vision_msgs/msg/Point2D";
  double x = 0;
  double y = 0;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"x", "1", "Pixels to the right."}, s.x);
    visit(Field{"y", "1", "Pixels downwards."}, s.y);
  }
};

/// A place and an orientation in an image.
struct Pose2D {
  static constexpr const char* ros_type = "vision_msgs/msg/Pose2D";
  Point2D position;
  double theta = 0;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"position", "", "The place."}, s.position);
    visit(Field{"theta", "rad", "Counter-clockwise."}, s.theta);
  }
};

/// A rectangle in an image.
struct BoundingBox2D {
  static constexpr const char* ros_type = "vision_msgs/msg/BoundingBox2D";
  Pose2D center;
  double size_x = 0;
  double size_y = 0;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"center", "", "Its middle."}, s.center);
    visit(Field{"size_x", "1", "Pixels, in the box's own frame."}, s.size_x);
    visit(Field{"size_y", "1", "Pixels."}, s.size_y);
  }
};

/// What something may be.
struct ObjectHypothesis {
  static constexpr const char* ros_type = "vision_msgs/msg/ObjectHypothesis";
  std::string class_id;
  double score = 0;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"class_id", "", "Its class."}, s.class_id);
    visit(Field{"score", "1", "How sure that is, from 0 to 1."}, s.score);
  }
};

/// What something may be, and where it is then.
struct ObjectHypothesisWithPose {
  static constexpr const char* ros_type = "vision_msgs/msg/ObjectHypothesisWithPose";
  ObjectHypothesis hypothesis;
  PoseWithCovariance pose;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"hypothesis", "", "The class."}, s.hypothesis);
    visit(Field{"pose", "", "In the frame of the detection."}, s.pose);
  }
};

/// Something found in an image.
struct Detection2D {
  static constexpr const char* ros_type = "vision_msgs/msg/Detection2D";
  Header header;
  std::vector<ObjectHypothesisWithPose> results;
  BoundingBox2D bbox;
  std::string id;
  static void fields(auto& s, auto&& visit) {
    visit(header_field, s.header);
    visit(Field{"results", "", "What it may be."}, s.results);
    visit(Field{"bbox", "", "Where it is in the image."}, s.bbox);
    visit(Field{"id", "", "The same in all images."}, s.id);
  }
};

/// All that was found in an image.
struct Detection2DArray {
  static constexpr const char* ros_type = "vision_msgs/msg/Detection2DArray";
  Header header;
  std::vector<Detection2D> detections;
  static void fields(auto& s, auto&& visit) {
    visit(header_field, s.header);
    visit(Field{"detections", "", "One for each thing."}, s.detections);
  }
};

}  // namespace sandlot::msg::vision
