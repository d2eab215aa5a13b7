#pragma once
/// Camera model: the ray of a pixel, for cameras described by ROS's CameraInfo and for measured ones.
///
/// Frame    sensor frame S: x forward (the optical axis), y left, z up; below a mirror: z up along its axis,
///          x what is upwards in the image, and left is on the right of the image, as such cameras see it.
/// Pixels   (u, v) = (column, row); (0, 0) is the centre of the upper left one.
/// Known    `plumb_bob` (or no name), `equidistant` (OpenCV's fisheye), `equisolid`, `stereographic`,
///          `orthographic`;
///          `mirror_hyperbolic`, `mirror_parabolic`, `mirror_spherical` with D = a, b, rim of the mirror in
///          metres.
/// Fitted   `fit_polynomial`: no constants of the mirror are needed, only points of the ground whose places
///          in the image are known.
/// Source   OpenCV's camera models; S. Baker, S. K. Nayar (1999) for mirrors; D. Scaramuzza, A. Martinelli,
///          R. Siegwart, A toolbox for easily calibrating omnidirectional cameras (2006) for the polynomial.
#include <array>
#include <optional>
#include <span>
#include <variant>

#include "base/result.h"
#include "geometry/pose.h"
#include "messages/sensor_images.h"

namespace sandlot::perception {

/// In S. The direction is a unit vector; the origin is zero but for spherical mirrors.
struct SightRay {
  Vec3 origin, direction;
};

/// A point of the world as seen from S, and where it is in the image.
struct Sighting {
  double u = 0, v = 0;
  Vec3 point_S;
};

class CameraModel {
 public:
  /// An error names what is wrong with the numbers.
  static Result<CameraModel> of(const msg::CameraInfo& info);
  /// An omnidirectional camera of any lens or mirror of revolution with the axis z and the image's middle
  /// (cx, cy): at the distance r from the middle the ray climbs by (a0 + a1 r + ... + a4 r^4) / r. Least
  /// squares over the sightings, of which at least ten at different r are needed.
  static Result<CameraModel> fit_polynomial(int width, int height, double cx, double cy,
                                            std::span<const Sighting> sightings);

  /// None where nothing is seen: beyond the lens's circle or the mirror's rim.
  std::optional<SightRay> ray(double u, double v) const;
  int width() const { return width_; }
  int height() const { return height_; }
  bool around() const { return kind_ >= Kind::hyperbolic; }  ///< z of S is its axis

 private:
  enum class Kind {
    pinhole,
    equidistant,
    equisolid,
    stereographic,
    orthographic,
    hyperbolic,
    parabolic,
    spherical,
    polynomial
  };
  Kind kind_ = Kind::pinhole;
  int width_ = 0, height_ = 0;
  double fx_ = 1, fy_ = 1, cx_ = 0, cy_ = 0;
  std::array<double, 5> d_{};
  double scale_ = 1;  ///< polynomial: r is in these, so that its powers stay near 1
  double fold_ = 0;   ///< pinhole: where in the image the distortion folds over, in focal lengths
};

}  // namespace sandlot::perception
