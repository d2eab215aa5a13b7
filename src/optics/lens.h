#pragma once
/// Lenses: which ray belongs to which place of an image, in closed form and in double precision.
///
/// Frame    sensor frame S: x forward (the optical axis of pinhole and fisheye), y left, z up, as SDF's
///          cameras have it. Catadioptric: z is the axis of the mirror, up, and x what lies upwards in the
///          image; S's origin is the mirror's focus (of a spherical mirror, which has none, the centre of the
///          sphere). The camera below looks up, so the left of the robot is on the right of the image, as in
///          every raw picture of such a camera.
/// Pixels   (u, v) = (column, row), u right, v down. The centre of the upper left pixel is (0, 0), as OpenCV
///          counts, so the image reaches from -0.5 to width - 0.5 and its middle is ((width - 1) / 2, (height
///          - 1) / 2).
/// Errors   check(): sizes that would not fit memory, fields of view no lens of the kind has, mirrors that
///          miss.
/// Limits   no chromatic aberration, no vignetting; the lens below a mirror is a pinhole (parabolic:
///          orthographic) without distortion and does not see itself in the mirror.
/// Source   OpenCV's camera models (calib3d, fisheye); S. Baker, S. K. Nayar, A theory of single-viewpoint
///          catadioptric image formation (1999); C. Geyer, K. Daniilidis, A unifying theory for central
///          panoramic systems (2000).
#include <array>
#include <memory>
#include <optional>
#include <variant>
#include <vector>

#include "base/result.h"
#include "geometry/vec3.h"

namespace sandlot::optics {

/// Straight lines stay straight, but for OpenCV's `plumb_bob` distortion. All 0: none.
struct Pinhole {
  double fx = 0, fy = 0, cx = 0, cy = 0;  ///< [px]
  double k1 = 0, k2 = 0, p1 = 0, p2 = 0, k3 = 0;
};

/// r = distance in the image from (cx, cy), in focal lengths; theta = angle from the optical axis.
struct Fisheye {
  enum class Mapping : std::uint8_t {
    equidistant,    ///< r = theta
    equisolid,      ///< r = 2 sin(theta / 2)
    stereographic,  ///< r = 2 tan(theta / 2)
    orthographic,   ///< r = sin(theta), up to 90 degrees
    kannala_brandt  ///< r = theta + k1 theta^3 + k2 theta^5 + k3 theta^7 + k4 theta^9, OpenCV's `fisheye`
  } mapping = Mapping::equidistant;
  double fx = 0, fy = 0, cx = 0, cy = 0;  ///< [px]
  double k1 = 0, k2 = 0, k3 = 0, k4 = 0;  ///< kannala_brandt only
  double max_theta_rad = 3.14159;         ///< nothing is seen beyond: half the field of view
};

/// A camera that looks up into a convex mirror of revolution. Up to `rim_m` from its axis the mirror is
/// there.
struct Catadioptric {
  enum class Mirror : std::uint8_t {
    hyperbolic,  ///< r^2/a^2 - Z^2/b^2 = -1 about the middle between mirror's focus and camera: sqrt(a^2 + b^2) from each
    parabolic,  ///< Z = (r^2 - a^2) / (2 a) about the focus, seen by an orthographic lens: a = radius of the horizon
    spherical  ///< radius a; the camera b below its centre. Not one viewpoint: rays have origins of their own
  } mirror = Mirror::hyperbolic;
  double a_m = 0, b_m = 0;
  double rim_m = 0;                       ///< radius of the mirror's edge
  double fx = 0, fy = 0, cx = 0, cy = 0;  ///< [px]; parabolic: pixels per metre
};

struct Lens {
  int width = 0, height = 0;  ///< [px], at most 8192 each and 16.8 million pixels together
  std::variant<Pinhole, Fisheye, Catadioptric> model;
};

/// Ray of a place of the image, in S. `direction` is a unit vector; `origin` is zero but for mirrors,
/// where it is the point of the mirror (so that the mirror's own body is never in the way).
struct LensRay {
  Vec3 origin, direction;
};

/// The first thing wrong with a lens; the lens functions below want one without.
Status check(const Lens& lens);

/// None where the lens shows nothing: beyond the fisheye's circle or the mirror's rim, or where a distortion
/// folds over. Places outside the image are answered, too.
std::optional<LensRay> ray_through(const Lens& lens, double u, double v);

/// Image place of a point, inside the image or not; none for what the lens cannot see (behind a pinhole ...).
std::optional<std::array<double, 2>> project(const Lens& lens, Vec3 point_S);

/// ROS CameraInfo's K, row by row.
std::array<double, 9> intrinsics(const Lens& lens);

/// Focal length for a horizontal field of view, the optical axis in the middle of the image, square pixels.
/// Pinholes: 0 < hfov < pi. The result has been checked.
Result<Lens> pinhole_of_fov(int width, int height, double hfov_rad);
/// The image's width spans hfov. Orthographic: at most pi; others up to 2 pi (stereographic: less).
Result<Lens> fisheye_of_fov(int width, int height, double hfov_rad, Fisheye::Mapping mapping);
/// The mirror's rim touches the nearer edges of the image. `lens.model` has mirror, a, b and rim; fx fy cx cy
/// are found.
Result<Lens> omni_that_fills(int width, int height, Catadioptric mirror);

/// A lens as the renderer wants it: its rays, computed once. One table serves all cameras with the same lens.
///
/// Cost     pinholes without distortion: nothing. Others: about 0.2 us per pixel once, and 12 bytes per pixel
///          (24 with a mirror).
class LensTable {
 public:
  /// @pre check(lens)
  static std::shared_ptr<const LensTable> make(const Lens& lens);

  const Lens& lens() const { return lens_; }
  bool is_plain_pinhole() const { return directions_.empty(); }
  bool has_origins() const { return !origins_.empty(); }
  /// Unit vectors in S, row by row; NaN where the lens shows nothing.
  const std::vector<std::array<float, 3>>& directions() const { return directions_; }
  const std::vector<std::array<float, 3>>& origins() const { return origins_; }

 private:
  explicit LensTable(const Lens& lens);
  Lens lens_;
  std::vector<std::array<float, 3>> directions_, origins_;
};

}  // namespace sandlot::optics
