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
    visit(Field{"x", "1", "Position in pixels to the right."}, s.x);
    visit(Field{"y", "1", "Position in pixels downwards."}, s.y);
  }
};

/// A place and an orientation in an image.
struct Pose2D {
  static constexpr const char* ros_type = "vision_msgs/msg/Pose2D";
  Point2D position;
  double theta = 0;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"position", "", "Position in the image."}, s.position);
    visit(Field{"theta", "rad", "Counter-clockwise turn."}, s.theta);
  }
};

/// A rectangle in an image.
struct BoundingBox2D {
  static constexpr const char* ros_type = "vision_msgs/msg/BoundingBox2D";
  Pose2D center;
  double size_x = 0;
  double size_y = 0;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"center", "", "Centre of the box."}, s.center);
    visit(Field{"size_x", "1", "Width in pixels, in the box's own frame."}, s.size_x);
    visit(Field{"size_y", "1", "Height in pixels, in the box's own frame."}, s.size_y);
  }
};

/// What something may be.
struct ObjectHypothesis {
  static constexpr const char* ros_type = "vision_msgs/msg/ObjectHypothesis";
  std::string class_id;
  double score = 0;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"class_id", "", "Name of the class."}, s.class_id);
    visit(Field{"score", "1", "Confidence of the hypothesis, from 0 to 1."}, s.score);
  }
};

/// What something may be, and where it is then.
struct ObjectHypothesisWithPose {
  static constexpr const char* ros_type = "vision_msgs/msg/ObjectHypothesisWithPose";
  ObjectHypothesis hypothesis;
  PoseWithCovariance pose;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"hypothesis", "", "Class and confidence."}, s.hypothesis);
    visit(Field{"pose", "", "Pose in the frame of the detection."}, s.pose);
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
    visit(Field{"results", "", "Hypotheses of the detection."}, s.results);
    visit(Field{"bbox", "", "Bounding box in the image."}, s.bbox);
    visit(Field{"id", "", "Identifier, the same in all images."}, s.id);
  }
};

/// All that was found in an image.
struct Detection2DArray {
  static constexpr const char* ros_type = "vision_msgs/msg/Detection2DArray";
  Header header;
  std::vector<Detection2D> detections;
  static void fields(auto& s, auto&& visit) {
    visit(header_field, s.header);
    visit(Field{"detections", "", "Detections, one per object."}, s.detections);
  }
};

}  // namespace sandlot::msg::vision
