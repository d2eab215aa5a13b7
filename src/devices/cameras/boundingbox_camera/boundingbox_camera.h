#pragma once
/// Camera that draws boxes around the things it sees.
///
/// Frame, lens   as camera.
/// Output   <device>/boxes: vision_msgs/Detection2DArray, one detection per thing of which at least
///          min_pixels are seen, in the order of their creation: class_id its label, score 1, id its name,
///          bbox in pixels around the part that is seen (its edges lie on edges of pixels, (0, 0) being the
///          centre of the upper left one). <device>/camera_info.
/// Noise    none: this is truth, for training and comparing.
/// Limits   boxes of what is seen, not of what is hidden; no 3D boxes.
/// Cost     one ray per pixel.
/// Source   vision_msgs 4.0; Gazebo's boundingbox_camera (visible_2d).
#include "devices/cameras/camera_picture.h"
#include "messages/vision_msgs.h"

namespace sandlot::boundingbox_camera {

struct Spec : cameras::LensKeys {
  double rate_hz = 30, near_m = 0.01, far_m = 1000;
  std::vector<std::string> labels;
  int min_pixels = 1;

  static void fields(auto& s, auto&& visit) {
    cameras::LensKeys::fields(s, visit);
    visit(Field{"rate", "Hz", "Pictures per second; 0: one in every tick.", 0, 1e5}, s.rate_hz);
    visit(Field{"near", "m", "Nearest visible distance.", 0, 1e4}, s.near_m);
    visit(Field{"far", "m", "Farthest visible distance.", 1e-3, 1e6}, s.far_m);
    visit(Field{"labels", "", "Labels of the objects that get boxes; none: all objects.", 0, 0, Field::none,
                255},
          s.labels);
    visit(Field{"min_pixels", "1", "Smallest number of visible pixels of an object that gets a box.", 1, 1e8},
          s.min_pixels);
  }
};

struct Camera {
  using Spec = boundingbox_camera::Spec;
  using State = NoFields;
  Spec spec;
  State state;
  cameras::CameraMount mount;
  Topic<msg::vision::Detection2DArray>* boxes;
  Topic<msg::CameraInfo>* info;
  std::string frame_id;
  std::vector<std::uint32_t> seen = {};  ///< instance per pixel
  struct Box {
    int left, top, right, bottom, pixels;
  };
  std::vector<Box> box = {};  ///< per thing

  static Result<Camera> create(const DeviceBuild& build, Spec spec);
  static void sense(PoolView<Camera> pool, const Context& context);
};

extern const Kind kind;

}  // namespace sandlot::boundingbox_camera
