#pragma once
/// Keys of a lens, shared by the specs of all cameras, and its CameraInfo.
///
/// Frames   S, the sensor's: x forward, y left, z up. `<device>_optical`: z forward, x right, y down, as ROS
///          has images' (REP 103). Pictures and CameraInfo are stamped with the latter, detections with S.
/// Errors   of optics::check(), at the key that is to blame.
#include <memory>
#include <numbers>
#include <optional>

#include "devices/kind.h"
#include "messages/messages.h"
#include "messages/sensor_images.h"
#include "optics/lens.h"

namespace sandlot::cameras {

enum class Projection : std::uint8_t {
  pinhole,
  equidistant,
  equisolid,
  stereographic,
  orthographic,
  kannala_brandt
};
inline std::span<const EnumName<Projection>> enum_names(Projection) {
  static constexpr EnumName<Projection> names[] = {
      {"pinhole", Projection::pinhole},           {"equidistant", Projection::equidistant},
      {"equisolid", Projection::equisolid},       {"stereographic", Projection::stereographic},
      {"orthographic", Projection::orthographic}, {"kannala_brandt", Projection::kannala_brandt}};
  return names;
}

struct Distortion {
  double k1 = 0, k2 = 0, p1 = 0, p2 = 0, k3 = 0, k4 = 0;
  bool none() const { return k1 == 0 && k2 == 0 && p1 == 0 && p2 == 0 && k3 == 0 && k4 == 0; }
  static void fields(auto& s, auto&& visit) {
    visit(Field{"k1", "1", "Radial distortion coefficient of order 2.", -1e3, 1e3}, s.k1);
    visit(Field{"k2", "1", "Radial distortion coefficient of order 4.", -1e3, 1e3}, s.k2);
    visit(Field{"p1", "1", "First tangential distortion coefficient; pinhole only.", -1e3, 1e3}, s.p1);
    visit(Field{"p2", "1", "Second tangential distortion coefficient; pinhole only.", -1e3, 1e3}, s.p2);
    visit(Field{"k3", "1", "Radial distortion coefficient of order 6.", -1e3, 1e3}, s.k3);
    visit(Field{"k4", "1", "Radial distortion coefficient of order 8; kannala_brandt only.", -1e3, 1e3},
          s.k4);
  }
};

constexpr int max_side_px = 8192;

/// Keys of a lens without a mirror. A Spec derives from it.
struct LensKeys {
  Projection lens = Projection::pinhole;
  int width = 320, height = 240;
  double horizontal_fov_rad = std::numbers::pi / 3;
  std::optional<double> fx, fy, cx, cy;
  Distortion distortion;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"lens", "",
                "Projection from angles to image points: pinhole, or a fisheye lens' r = f theta "
                "(equidistant), 2 f sin(theta/2) (equisolid), 2 f tan(theta/2) (stereographic), f sin(theta) "
                "(orthographic), or OpenCV's fisheye (kannala_brandt)."},
          s.lens);
    visit(Field{"width", "1", "Number of pixels per row.", 1, max_side_px}, s.width);
    visit(Field{"height", "1", "Number of rows.", 1, max_side_px}, s.height);
    visit(Field{"horizontal_fov", "rad",
                "Opening angle from the left edge to the right one, without distortion.", 0,
                2 * std::numbers::pi + 1e-6},
          s.horizontal_fov_rad);
    visit(Field{"fx", "1", "Focal length in pixels; takes precedence over horizontal_fov.", 1e-3, 1e9}, s.fx);
    visit(Field{"fy", "1", "Focal length in pixels along columns; none: fx.", 1e-3, 1e9}, s.fy);
    visit(Field{"cx", "1", "Column of the optical axis, counted from 0; none: the middle.", -1e6, 1e6}, s.cx);
    visit(Field{"cy", "1", "Row of the optical axis, counted from 0; none: the middle.", -1e6, 1e6}, s.cy);
    visit(Field{"distortion", "", "Distortion of lenses pinhole (OpenCV's plumb_bob) and kannala_brandt."},
          s.distortion);
  }
};

/// Error of optics::check() at the key to blame.
Error lens_error(const DeviceBuild& build, const char* key, const Error& error);

Result<optics::Lens> lens_of(const LensKeys& keys, const DeviceBuild& build);
/// The table of a lens; devices with the same lens share one. @pre check(lens)
std::shared_ptr<const optics::LensTable> shared_table(const optics::Lens& lens);

/// The optical frame in S.
inline constexpr Pose X_S_optical{{}, {0.5, -0.5, 0.5, -0.5}};
/// For mirrors, whose S has z up, x upwards and y to the right in the image: x right, y down, z up.
inline constexpr Pose X_S_optical_mirror{{}, {0.70710678118654752, 0, 0, 0.70710678118654752}};

/// K, D and P as OpenCV and ROS have them. @param baseline_m  of the right one of a stereo pair, else 0
void fill_info(msg::CameraInfo& info, const optics::Lens& lens, const std::string& frame_id,
               double baseline_m = 0);

}  // namespace sandlot::cameras
