#pragma once
/// Visual odometry: the motion of a robot from the pictures of its stereo camera, or of one camera above flat ground, by the navigation
/// library.
///
/// Reads      with `eyes: stereo` <camera>/left/image, right/image and both camera_infos (a stereo_camera); with `eyes: mono` the Image
///            and the CameraInfo of <camera>. Focal lengths, centre and baseline are those of CameraInfo; pictures are rgb8, bgr8 or mono8.
/// Publishes  `odometry`, nav_msgs/Odometry of the base link, once for each picture that has a pose: in <robot>/<frame>, which is the base
///            link at the first picture. Pose covariance grows with keyframes and by `growth`; the twist is the motion since the last
///            picture with a pose. After a gap (navigation/visual_odometry/track.h) positions, and the first twist, have the variance 9999.
/// Method, limits   navigation/visual_odometry/stereo_odometry.h, mono_odometry.h. What became of the pictures stands in the state:
///            `track.counts`.
/// State      holds the keyframe's pictures: 0.6 MB for two of 640 x 480.
/// Cost       20 ms for two pictures of 640 x 480, 10 ms for one.
#include "base/math.h"
#include "control/controller.h"
#include "navigation/visual_odometry/mono_odometry.h"
#include "navigation/visual_odometry/stereo_odometry.h"

namespace sandlot::controllers::visual_odometry {

enum class Eyes : std::uint8_t { stereo, mono };
inline std::span<const EnumName<Eyes>> enum_names(Eyes) {
  static constexpr EnumName<Eyes> names[] = {{"stereo", Eyes::stereo}, {"mono", Eyes::mono}};
  return names;
}

struct Spec {
  std::string camera, frame = "visual_odom", child = "base_link";
  Eyes eyes = Eyes::stereo;
  navigation::vo::StereoSpec stereo;
  navigation::vo::MonoSpec mono;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"camera", "", "Camera to use; empty: the only one.", 0, 0, Field::none, 1000}, s.camera);
    visit(Field{"eyes", "", "Whether it has two eyes, or one above flat ground."}, s.eyes);
    visit(Field{"frame", "", "Frame of the poses, after the robot's name.", 0, 0, Field::none, 100, 1},
          s.frame);
    visit(Field{"child", "", "Link whose motion is published, the robot's first one.", 0, 0, Field::none, 100,
                1},
          s.child);
    visit(Field{"stereo", "",
                "Odometry of two eyes. Its camera's numbers are replaced by those of CameraInfo."},
          s.stereo);
    visit(Field{"mono", "",
                "Odometry of one eye. Its camera's numbers, but for height and pitch, are replaced by those "
                "of CameraInfo."},
          s.mono);
  }
};

struct State {
  navigation::vo::StereoView pair;  ///< keyframe
  navigation::vo::View single;      ///< keyframe of one eye
  navigation::vo::Track track;
  Time posed_at;     ///< of the last picture with a pose
  bool gap = false;  ///< there has been a gap since

  static void fields(auto& s, auto&& visit) {
    visit(Field{"pair", "", "Keyframe of two eyes."}, s.pair);
    visit(Field{"single", "", "Keyframe of one eye."}, s.single);
    visit(Field{"track", "", "Pose of the camera since the first picture."}, s.track);
    visit(Field{"posed_at", "s", "Time of the latest picture with a pose."}, s.posed_at);
    visit(Field{"gap", "", "Whether there has been a gap since."}, s.gap);
  }
};

struct VisualOdometry {
  using Spec = visual_odometry::Spec;
  using State = visual_odometry::State;
  Spec spec;
  State state;

  Status init(const Description& robot, Outputs& out);
  void step(const Observation& obs, Command& cmd);
  bool fits() const;

 private:
  struct Eye {
    Reading<msg::Image> image;
    Reading<msg::CameraInfo> info;
    std::vector<std::uint8_t> grey;  ///< of a picture with colours
  };
  navigation::vo::Step advance_pair(const Observation& obs);
  navigation::vo::Step advance_single(const Observation& obs);
  static navigation::vo::GreyImage grey(const msg::Image& image, std::vector<std::uint8_t>& converted);
  void tell(const navigation::vo::Step& step, Time now);

  std::vector<Eye> eyes_;
  Pose X_BS_;
  Publication<msg::Odometry> odometry_;
  msg::Odometry out_;
};

}  // namespace sandlot::controllers::visual_odometry
