#pragma once
/// Depth images and point clouds, shared by the cameras that measure distances.
///
/// Depth    of pinholes along the optical axis, of others the distance. 32FC1: metres, +inf beyond `far`,
///          -inf nearer than `near`, NaN where errors took it away (REP 118). 16UC1: millimetres, 0 for all
///          of those and beyond 65.5 m.
/// Points   in `<device>_optical`, one per pixel in rows (NaN where there is no depth): x y z, with a colour
///          image also rgb.
#include "devices/cameras/camera_picture.h"
#include "noise/depth_noise.h"

namespace sandlot::cameras {

enum class DepthEncoding : std::uint8_t { metres, millimetres };
inline std::span<const EnumName<DepthEncoding>> enum_names(DepthEncoding) {
  static constexpr EnumName<DepthEncoding> names[] = {{"32FC1", DepthEncoding::metres},
                                                      {"16UC1", DepthEncoding::millimetres}};
  return names;
}

class DepthImage {
 public:
  DepthImage() = default;
  /// @param points  null: none are made. @param colored  points have a colour
  DepthImage(Topic<msg::Image>* topic, Topic<msg::PointCloud2>* points, const optics::Lens& lens,
             DepthEncoding encoding, const std::string& frame_id, bool colored);
  std::span<float> depth_m() { return depth_m_; }
  /// @param rgb  of the same pixels, or empty
  void finish(double near_m, const DepthNoiseSpec& noise, double errors, const Stream& random,
              std::span<const std::uint8_t> rgb, Time now);

 private:
  void fill_points(std::span<const std::uint8_t> rgb);

  Topic<msg::Image>* topic_ = nullptr;
  Topic<msg::PointCloud2>* points_ = nullptr;
  DepthEncoding encoding_ = DepthEncoding::metres;
  int width_ = 0, height_ = 0;
  bool colored_ = false;
  std::vector<float> depth_m_;
  std::vector<std::array<float, 3>> at_one_m_;  ///< per pixel: the point of depth 1 m; only with points
};

}  // namespace sandlot::cameras
