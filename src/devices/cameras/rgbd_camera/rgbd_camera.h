#pragma once
/// Colour and depth of the same pixels, and their points.
///
/// Frame, lens, picture   as camera; depth and points as depth_camera.
/// Output   <device>/image, <device>/depth: Image; <device>/camera_info; with `points: true` <device>/points:
///          PointCloud2 with colours, organised.
/// Limits   both are seen through one lens, at one moment: the registered pictures of a real one.
/// Cost     of camera and depth_camera together.
#include "devices/cameras/depth_image.h"

namespace sandlot::rgbd_camera {

struct Spec : cameras::LensKeys, cameras::ExposureKeys {
  double rate_hz = 30;
  cameras::Format format = cameras::Format::rgb8;
  cameras::DepthEncoding encoding = cameras::DepthEncoding::metres;
  bool points = false;
  ImageNoiseSpec noise;
  DepthNoiseSpec depth_noise;
  double errors = 1;

  static void fields(auto& s, auto&& visit) {
    cameras::LensKeys::fields(s, visit);
    visit(Field{"rate", "Hz", "Pictures per second; 0: one in every tick.", 0, 1e5}, s.rate_hz);
    visit(Field{"format", "", "Format of the colour pixels."}, s.format);
    visit(Field{"encoding", "", "Encoding of depths: metres as floats, or millimetres."}, s.encoding);
    visit(Field{"points", "", "Whether the points are published, too."}, s.points);
    cameras::ExposureKeys::fields(s, visit);
    visit(Field{"noise", "1", "Errors of the colours."}, s.noise);
    visit(Field{"depth_noise", "m", "Errors of the depths."}, s.depth_noise);
    visit(errors_field, s.errors);
  }
};

struct Camera {
  using Spec = rgbd_camera::Spec;
  using State = NoFields;
  Spec spec;
  State state;
  cameras::CameraMount mount;
  cameras::ColorImage color;
  cameras::DepthImage depth;
  Topic<msg::CameraInfo>* info = nullptr;
  std::vector<std::uint8_t> true_rgb = {};  ///< for the points: before noise, gamma and format

  static Result<Camera> create(const DeviceBuild& build, Spec spec);
  static void sense(PoolView<Camera> pool, const Context& context);
};

extern const Kind kind;

}  // namespace sandlot::rgbd_camera
