#pragma once
/// Two cameras side by side whose pictures are rectified: a point is seen in the same row of both.
///
/// Frame    S: the left eye's; x forward, y left, z up. The right eye stands at y = -baseline. All messages
///          are stamped with `<device>_optical`, the left eye's optical frame, as ROS' image_geometry wants
///          it.
/// Output   <device>/left/image, <device>/left/camera_info, the same of right. P of the right one holds -fx *
///          baseline. A point at depth z has the disparity u_left - u_right = fx * baseline / z. Disparities
///          are not computed.
/// Errors of pixels   each eye has its own.
/// Lens     pinhole without distortion.
/// Cost     two pictures.
/// Source   sensor_msgs/CameraInfo.
#include "devices/cameras/camera_picture.h"

namespace sandlot::stereo_camera {

struct Spec : cameras::LensKeys, cameras::ExposureKeys {
  double rate_hz = 30, baseline_m = 0.12;
  cameras::Format format = cameras::Format::rgb8;
  ImageNoiseSpec noise;
  double errors = 1;

  static void fields(auto& s, auto&& visit) {
    cameras::LensKeys::fields(s, visit);
    visit(Field{"baseline", "m", "Distance from the left eye to the right one.", 1e-4, 100}, s.baseline_m);
    visit(Field{"rate", "Hz", "Pictures per second; 0: one in every tick.", 0, 1e5}, s.rate_hz);
    visit(Field{"format", "", "Format of the pixels."}, s.format);
    cameras::ExposureKeys::fields(s, visit);
    visit(Field{"noise", "1", "Errors of the pictures."}, s.noise);
    visit(errors_field, s.errors);
  }
};

struct Camera {
  using Spec = stereo_camera::Spec;
  using State = NoFields;
  Spec spec;
  State state;
  struct Side {
    cameras::CameraMount mount;
    cameras::ColorImage picture;
    Topic<msg::CameraInfo>* info = nullptr;
  };
  std::array<Side, 2> sides;  ///< left, right

  static Result<Camera> create(const DeviceBuild& build, Spec spec);
  static void sense(PoolView<Camera> pool, const Context& context);
};

extern const Kind kind;

}  // namespace sandlot::stereo_camera
