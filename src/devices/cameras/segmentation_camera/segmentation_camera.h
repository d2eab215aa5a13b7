#pragma once
/// Camera that knows what it sees: for every pixel the class and the instance.
///
/// Frame, lens   as camera.
/// Output   <device>/labels: mono8, the place of the thing's label in `labels` counted from 1 (without them
///          the number that the label is, as in Gazebo's worlds), or 0 for everything else.
///          <device>/instances: 32SC1, a number per thing that is never given twice in a run, or 0.
///          <device>/colored: rgb8, a colour per label (`color_by: instance`: per instance), black for 0.
///          <device>/camera_info.
/// Noise    none: this is truth, for training and comparing.
/// Limits   things without bounds, such as a ground plane, are 0. Instances are those of the model: a robot
///          is one.
/// Cost     one ray per pixel.
/// Source   Gazebo's segmentation camera (semantic and panoptic).
#include "devices/cameras/camera_picture.h"

namespace sandlot::segmentation_camera {

enum class ColorBy : std::uint8_t { label, instance };
inline std::span<const EnumName<ColorBy>> enum_names(ColorBy) {
  static constexpr EnumName<ColorBy> names[] = {{"label", ColorBy::label}, {"instance", ColorBy::instance}};
  return names;
}

struct Spec : cameras::LensKeys {
  double rate_hz = 30, near_m = 0.01, far_m = 1000;
  std::vector<std::string> labels;
  ColorBy color_by = ColorBy::label;

  static void fields(auto& s, auto&& visit) {
    cameras::LensKeys::fields(s, visit);
    visit(Field{"rate", "Hz", "Pictures per second; 0: one in every tick.", 0, 1e5}, s.rate_hz);
    visit(Field{"near", "m", "Nearest visible distance.", 0, 1e4}, s.near_m);
    visit(Field{"far", "m", "Farthest visible distance.", 1e-3, 1e6}, s.far_m);
    visit(Field{"labels", "",
                "Labels of the classes, in the order of their numbers from 1 on; none: labels that are whole "
                "numbers up to 255 stand for themselves.",
                0, 0, Field::none, 255},
          s.labels);
    visit(Field{"color_by", "", "Meaning of the coloured picture's colours."}, s.color_by);
  }
};

struct Camera {
  using Spec = segmentation_camera::Spec;
  using State = NoFields;
  Spec spec;
  State state;
  cameras::CameraMount mount;
  Topic<msg::Image>*labels, *instances, *colored;
  Topic<msg::CameraInfo>* info;
  std::vector<std::uint32_t> seen = {};  ///< instance per pixel

  static Result<Camera> create(const DeviceBuild& build, Spec spec);
  static void sense(PoolView<Camera> pool, const Context& context);
};

extern const Kind kind;

}  // namespace sandlot::segmentation_camera
