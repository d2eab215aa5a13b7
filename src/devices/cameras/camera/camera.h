#pragma once
/// Camera: pinhole with distortion, wide-angle or fisheye lens; pictures, things seen, or their poses.
///
/// Frame    sensor frame S: x forward (the optical axis), y left, z up. `<device>_optical` (/tf_static): z
///          forward, x right, y down; Image and CameraInfo are stamped with it. Pixel (0, 0) is the centre of
///          the upper left one.
/// Levels   devices/cameras/camera_core.h: `image` | `objects` | `world`.
/// Picture  optics/picture.h draws it from the visuals of the world, with shadows, depth of field, motion
///          blur and rolling shutter where set. Then noise (noise/image_noise.h), gamma, format. The link
///          that carries the camera is its housing and is not seen; its shadow is.
/// Limits   no automatic exposure, white balance, vignetting (a noise stage has it) or lens flares.
/// Cost     about 30 ns per pixel, sample and light; no allocation after the first picture.
/// Errors   lenses that see nothing or too much, too many pixels (8192 a side, 16.8 million): place and path
///          of the key.
/// Source   ROS REP 103, REP 104, sensor_msgs/CameraInfo; OpenCV's camera models.
#include "devices/cameras/camera_core.h"

namespace sandlot::camera {

struct Spec : cameras::LensKeys, cameras::CameraKeys {
  static void fields(auto& s, auto&& visit) {
    cameras::LensKeys::fields(s, visit);
    cameras::CameraKeys::fields(s, visit);
  }
};

extern const Kind kind;

}  // namespace sandlot::camera
