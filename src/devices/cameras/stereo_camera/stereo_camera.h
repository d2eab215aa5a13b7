#pragma once
/// Two cameras side by side whose pictures are rectified: a point is seen in the same row of both.
///
/// Frame    S: the left eye's; x forward, y left, z up. The right eye stands at y = -baseline. All messages
///          are stamped with `<device>_optical`, the left eye's optical frame, as ROS' image_geometry wants
///          it.
/// Levels   `image` (the default): <device>/left/image, <device>/left/camera_info, the same of right. P of the right one holds -fx *
///          baseline. A point at depth z has the disparity d = u_left - u_right = fx * baseline / z.
///          `disparity`: stereo_msgs/DisparityImage on <device>/disparity, matched in both pictures (devices/cameras/disparity.h):
///          its errors come from matching, from the errors of the pixels and from what the scene looks like.
///          `closed_form`: the same on <device>/closed_form without pictures, from true depths: d + match_std n with n ~ Normal(0, 1)
///          for each pixel, so that depths have the deviation z^2 match_std / (fx baseline). None where the right eye does not see
///          the point, where d would not be looked for, or where there is no surface.
///          With `points: true` PointCloud2 on <device>/disparity/points and <device>/closed_form/points, organised, NaN where there
///          is no disparity. Any of the levels together; without `image` pictures are drawn for matching alone and not published.
/// Errors of pixels   each eye has its own.
/// Calibration   with errors (`calibration`), drawn once when the camera is made, times `errors` as it then is. What is published (CameraInfo;
///          f, T and points of disparities) has a focal length, centre and baseline that are not the true ones, the same for both eyes;
///          and the right eye looks a little elsewhere than pictures that were rectified well would. Typical of a calibration with a
///          board are 0.1 % of the focal length, 0.5 pixels, 0.3 % of the baseline and 0.02 degrees.
/// Lens     pinhole without distortion.
/// Cost     two pictures; matching as told in disparity.h; `closed_form` one ray per pixel.
/// Source   sensor_msgs/CameraInfo, stereo_msgs/DisparityImage.
#include "devices/cameras/camera_picture.h"
#include "devices/cameras/disparity.h"
#include "messages/stereo_msgs.h"

namespace sandlot::stereo_camera {

/// Standard deviations of a calibration.
struct CalibrationKeys {
  double focal = 0, centre_px = 0, baseline = 0, rotation_rad = 0;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"focal", "1", "Deviation of the published focal length, by the true one.", 0, 0.2}, s.focal);
    visit(
        Field{"centre", "px", "Deviation of the published optical centre, along rows and columns.", 0, 1000},
        s.centre_px);
    visit(Field{"baseline", "1", "Deviation of the published baseline, by the true one.", 0, 0.2},
          s.baseline);
    visit(Field{"rotation", "rad", "Deviation of the right eye's turn about each axis.", 0, 0.2},
          s.rotation_rad);
  }
};

/// Errors of one camera's calibration.
struct Calibration {
  double focal = 0, baseline = 0;  ///< published by true, less 1
  double column_px = 0, row_px = 0;
  Quat q_right;
  /// Into a message that is true.
  void apply(msg::CameraInfo& info) const;
};
/// @param scale  times all deviations
Calibration calibrated(const CalibrationKeys& keys, double scale, Stream random);

struct Spec : cameras::LensKeys, cameras::ExposureKeys {
  double rate_hz = 30, baseline_m = 0.12;
  cameras::Format format = cameras::Format::rgb8;
  ImageNoiseSpec noise;
  CalibrationKeys calibration;
  cameras::MatchKeys matching;
  double match_std = 0.25;
  bool points = false;
  double errors = 1;

  static void fields(auto& s, auto&& visit) {
    cameras::LensKeys::fields(s, visit);
    visit(Field{"baseline", "m", "Distance from the left eye to the right one.", 1e-4, 100}, s.baseline_m);
    visit(Field{"rate", "Hz", "Pictures per second; 0: one in every tick.", 0, 1e5}, s.rate_hz);
    visit(Field{"format", "", "Format of the pixels."}, s.format);
    cameras::ExposureKeys::fields(s, visit);
    visit(Field{"noise", "1", "Errors of the pictures."}, s.noise);
    visit(Field{"calibration", "1", "Errors of what is published about the camera; 0: it is true."},
          s.calibration);
    visit(Field{"matching", "",
                "Search for disparities at level disparity; count and min also bound those of closed_form."},
          s.matching);
    visit(Field{"match_std", "1", "Deviation of the disparities of level closed_form [pixels].", 0, 100,
                Field::tunable},
          s.match_std);
    visit(Field{"points", "", "Whether the points of the disparities are published, too."}, s.points);
    visit(errors_field, s.errors);
  }
};

enum Level : std::uint32_t { image, disparity, closed_form };

/// A disparity image and its points on their topics.
class Disparities {
 public:
  Disparities() = default;
  /// @param points  null: none are made
  Disparities(Topic<msg::DisparityImage>* topic, Topic<msg::PointCloud2>* points, const optics::Lens& lens,
              const Spec& spec, const Calibration& errors, const std::string& frame_id);
  /// Room for the next disparities, one per pixel; cameras::no_disparity where there is none.
  std::span<float> values() { return values_; }
  double focal_baseline_m() const { return true_fb_m_; }
  void publish(Time now);

 private:
  void fill_points();

  Topic<msg::DisparityImage>* topic_ = nullptr;
  Topic<msg::PointCloud2>* points_ = nullptr;
  int width_ = 0, height_ = 0;
  double fx_ = 1, fy_ = 1, cx_ = 0, cy_ = 0, baseline_m_ = 0;  ///< as published
  double true_fb_m_ = 0;
  std::vector<float> values_;
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
    std::vector<std::uint8_t> grey;  ///< of the latest picture, for matching
  };
  std::array<Side, 2> sides;  ///< left, right
  Disparities matched, computed;
  std::vector<float> depth_m;  ///< of the left eye, for level closed_form

  static Result<Camera> create(const DeviceBuild& build, Spec spec);
  static void sense(PoolView<Camera> pool, const Context& context);

 private:
  void match();
  void compute(std::uint64_t sample, const Context& context);
};

extern const Kind kind;

}  // namespace sandlot::stereo_camera
