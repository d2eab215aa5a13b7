#pragma once
/// Depth camera: the distance of every pixel, and the points they are.
///
/// Frame, lens   as camera. Depth and points: devices/cameras/depth_image.h; noise: noise/depth_noise.h.
/// Output   <device>/depth: Image; <device>/camera_info; with `points: true` <device>/points: PointCloud2,
///          organised.
/// Limits   no projector: nothing depends on material, light or the second eye of a real one but through the
///          noise.
/// Cost     one ray per pixel. No allocation after the first picture.
/// Source   ROS REP 118.
#include "devices/cameras/depth_image.h"

namespace sandlot::depth_camera {

struct Spec : cameras::LensKeys {
  double rate_hz = 30, near_m = 0.1, far_m = 10;
  cameras::DepthEncoding encoding = cameras::DepthEncoding::metres;
  bool points = false;
  DepthNoiseSpec noise;
  double errors = 1;

  static void fields(auto& s, auto&& visit) {
    cameras::LensKeys::fields(s, visit);
    visit(Field{"rate", "Hz", "Pictures per second; 0: one in every tick.", 0, 1e5}, s.rate_hz);
    visit(Field{"near", "m", "Nearest measured distance; nearer surfaces read -inf.", 0, 1e4}, s.near_m);
    visit(Field{"far", "m", "Farthest measured distance; farther surfaces read +inf.", 1e-3, 1e6}, s.far_m);
    visit(Field{"encoding", "", "Encoding of depths: metres as floats, or millimetres."}, s.encoding);
    visit(Field{"points", "", "Whether the points are published, too."}, s.points);
    visit(Field{"noise", "m", "Errors of the depths."}, s.noise);
    visit(errors_field, s.errors);
  }
};

struct Camera {
  using Spec = depth_camera::Spec;
  using State = NoFields;
  Spec spec;
  State state;
  cameras::CameraMount mount;
  cameras::DepthImage depth;
  Topic<msg::CameraInfo>* info = nullptr;

  static Result<Camera> create(const DeviceBuild& build, Spec spec);
  static void sense(PoolView<Camera> pool, const Context& context);
};

extern const Kind kind;

}  // namespace sandlot::depth_camera
