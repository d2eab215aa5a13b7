#pragma once
/// Seeker: looks for an object, such as the ball, and drives to it.
///
/// Reads    a camera: its objects where it works at that level, else its pictures, in which perception finds the thing by its
///          colour. Nothing else in here knows the difference, and a level switched in the run goes unnoticed.
/// Orders   a Twist for a drive that can turn on the spot.
/// Method   The thing's place is kept in the robot's frame and moved by the orders given since it was seen. The robot turns towards it, drives
///          along the arc that meets it and slows down so as to stop before it. When it has not been seen for a while, the robot turns on the
///          spot, to the side where it was last.
/// Limits   avoids nothing that stands in the way. The camera must sit firmly on the base, above flat ground. Lights that turn orange into
///          yellow need other `targets`.
/// Cost     that of perception/finder.h, once per new picture.
#include "control/controller.h"
#include "perception/finder.h"

namespace sandlot::controllers::seeker {

struct Spec {
  std::string camera, drive, label = "ball";
  double stop_m = 0.45, speed_mps = 0.5, turn_speed_radps = 1.2, deceleration_mps2 = 0.5, patience_s = 1;
  perception::FinderSpec vision;

  static void fields(auto& s, auto&& visit) {
    constexpr unsigned tunable = Field::tunable;
    visit(Field{"camera", "", "Camera to look through; empty: the only one.", 0, 0, Field::none, 1000},
          s.camera);
    visit(Field{"drive", "", "Drive to use; empty: the only one.", 0, 0, Field::none, 1000}, s.drive);
    visit(Field{"label", "", "Label of the object to search for."}, s.label);
    visit(Field{"stop", "m", "Distance from the object's middle at which the robot stops.", 0, 100, tunable},
          s.stop_m);
    visit(Field{"speed", "m/s", "Largest speed.", 0.001, 100, tunable}, s.speed_mps);
    visit(Field{"turn_speed", "rad/s", "Largest turning rate.", 0.01, 100, tunable}, s.turn_speed_radps);
    visit(Field{"deceleration", "m/s^2", "Deceleration before the object.", 0.01, 100, tunable},
          s.deceleration_mps2);
    visit(Field{"patience", "s", "Time without a sight of the object after which the search begins.", 0.01,
                1e3, tunable},
          s.patience_s);
    visit(Field{"vision", "", "Detection of the object in pictures."}, s.vision);
  }
};

struct State {
  double x_m = 0, y_m = 0;            ///< of the thing, in the robot's frame
  double unseen_s = 1e9;              ///< since it was seen
  double side = 1;                    ///< to which it turns: +1 left
  double v_mps = 0, omega_radps = 0;  ///< ordered in the previous step
  std::uint64_t in_objects = 0, in_pictures = 0;
  bool arrived = false;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"x", "m", "Estimated position of the object, forward of the robot."}, s.x_m);
    visit(Field{"y", "m", "Estimated position of the object, to the robot's left."}, s.y_m);
    visit(Field{"unseen", "s", "Time since the object was last seen."}, s.unseen_s);
    visit(Field{"side", "1", "Direction of the search; +1: left."}, s.side);
    visit(Field{"linear", "m/s", "Speed commanded in the previous step."}, s.v_mps);
    visit(Field{"angular", "rad/s", "Turning rate commanded in the previous step."}, s.omega_radps);
    visit(Field{"in_objects", "1", "Number of times the object was reported by a detector."}, s.in_objects);
    visit(Field{"in_pictures", "1", "Number of times the object was found in a picture."}, s.in_pictures);
    visit(Field{"arrived", "", "Whether the robot stands before the object."}, s.arrived);
  }
};

struct Seeker {
  using Spec = seeker::Spec;
  using State = seeker::State;
  Spec spec;
  State state;

  Status init(const Description& robot);
  void step(const Observation& obs, Command& cmd);

 private:
  void see(Vec3 position_B);
  void look(const Observation& obs);
  void look_at_picture(const msg::Image& image, const msg::CameraInfo& info);

  double period_s_ = 0.1;
  std::optional<Reading<msg::ObjectArray>> objects_;
  std::optional<Reading<msg::Image>> image_;
  std::optional<Reading<msg::CameraInfo>> info_;
  Actuator<msg::Twist> drive_;
  Pose X_BS_;
  // Computed from camera_info: not State.
  msg::CameraInfo known_;
  perception::Finder finder_;
  std::vector<perception::Found> found_;
};

}  // namespace sandlot::controllers::seeker
