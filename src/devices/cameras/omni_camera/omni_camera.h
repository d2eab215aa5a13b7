#pragma once
/// Camera that looks up into a convex mirror and sees all around.
///
/// Frame    sensor frame S: the mirror's focus (of a sphere: its centre), z up along its axis, x what lies
///          upwards in the image. It is seen mirrored: left of the robot is right in the image.
///          `<device>_optical` (/tf_static): x right and y down in the image, z up as S's. Image and
///          CameraInfo are stamped with it; D holds a, b and rim.
/// Levels   devices/cameras/camera_core.h: `image` | `objects` | `world`.
/// Mirror   hyperbolic and parabolic ones have a single viewpoint, spherical ones do not: optics/lens.h.
///          Without `focal_length` the rim fills the height of the image. The default is a VStone's curve,
///          five times as large: horizon at 34 mm of radius, 18 degrees above it at 50 mm.
/// Picture, Cost, Limits   as of camera; the mirror's own shape is not seen.
/// Errors   mirrors that miss the image, that the camera is inside of, without a size: place and path of the
///          key.
/// Source   S. Baker, S. K. Nayar (1999); C. Geyer, K. Daniilidis (2000); VStone's a^2 = 233.3, b^2 = 1135.7
///          mm^2 (literature).
#include "devices/cameras/camera_core.h"

namespace sandlot::omni_camera {

using Mirror = optics::Catadioptric::Mirror;

/// Names for a mirror that optics does not give.
enum class Shape : std::uint8_t { hyperbolic, parabolic, spherical };
inline std::span<const EnumName<Shape>> enum_names(Shape) {
  static constexpr EnumName<Shape> names[] = {
      {"hyperbolic", Shape::hyperbolic}, {"parabolic", Shape::parabolic}, {"spherical", Shape::spherical}};
  return names;
}

struct MirrorKeys {
  Shape mirror = Shape::hyperbolic;
  int width = 480, height = 480;
  std::optional<double> a_m, b_m;
  double rim_m = 0.05;
  std::optional<double> focal_length;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"mirror", "", "Shape of the mirror."}, s.mirror);
    visit(Field{"width", "1", "Number of pixels per row.", 1, cameras::max_side_px}, s.width);
    visit(Field{"height", "1", "Number of rows.", 1, cameras::max_side_px}, s.height);
    visit(Field{"a", "m",
                "Shape parameter of the mirror. Hyperbolic: r^2/a^2 - z^2/b^2 = -1; parabolic: radius of the "
                "horizon; spherical: radius.",
                0, 1e3},
          s.a_m);
    visit(Field{"b", "m",
                "Second shape parameter of the mirror. Hyperbolic: see a; spherical: distance from the "
                "centre down to the camera.",
                0, 1e3},
          s.b_m);
    visit(Field{"rim", "m", "Radius of the mirror's edge.", 0, 1e3}, s.rim_m);
    visit(Field{"focal_length", "1",
                "Focal length of the camera below, in pixels (parabolic: pixels per metre); none: the rim "
                "fills the image.",
                0, 1e9},
          s.focal_length);
  }
};

struct Spec : MirrorKeys, cameras::CameraKeys {
  static void fields(auto& s, auto&& visit) {
    MirrorKeys::fields(s, visit);
    cameras::CameraKeys::fields(s, visit);
  }
};

Result<optics::Lens> lens_of(const Spec& spec, const DeviceBuild& build);

extern const Kind kind;

}  // namespace sandlot::omni_camera
