#pragma once
/// Predator: hunts the nearest prey, by one of three strategies.
///
/// Reads    an ObjectPoseArray in the frame of the world, in which the robot finds itself by its name, prey and other predators by
///          their labels (overhead_camera).
/// Orders   a Twist for a drive that can turn on the spot.
/// Method   pursuit    drives at the prey.
///          lead       drives at the point where it meets the prey if the prey keeps its velocity, which is estimated from the
///                     camera's pictures: |p + v t - own| = speed t, t at most `horizon`.
///          encircle   the predators share the directions around the prey evenly, in the order in which they stand around it,
///                     each comes from its own, and the circle narrows once all are on it.
/// Team     there are no messages: with encircle each predator computes the places of all from the same picture.
/// Limits   no walls and no obstacles; predators do not avoid each other.
/// Cost     the number of predators squared, no allocation once its list has grown.
/// Errors   no camera or drive of these names.
/// Source   lead: the intercept triangle, as in R. Isaacs, Differential Games (1965), section 1.5.
#include "control/controller.h"
#include "control/steering.h"

namespace sandlot::controllers::predator {

enum class Strategy : std::uint8_t { pursuit, lead, encircle };

inline std::span<const EnumName<Strategy>> enum_names(Strategy) {
  static constexpr EnumName<Strategy> names[] = {
      {"pursuit", Strategy::pursuit}, {"lead", Strategy::lead}, {"encircle", Strategy::encircle}};
  return names;
}

struct Spec {
  Strategy strategy = Strategy::pursuit;
  std::string camera, drive;
  std::string prey = "prey";
  double speed_mps = 0.4;
  double turn_speed_radps = 4;
  double horizon_s = 4;
  double circle_m = 1;

  static void fields(auto& s, auto&& visit) {
    constexpr unsigned tunable = Field::tunable;
    visit(Field{"strategy", "",
                "Way of hunting. pursuit: at the prey; lead: at where it will be; encircle: from all sides.",
                0, 0, tunable},
          s.strategy);
    visit(Field{"camera", "", "Camera above the field to use; empty: the only one.", 0, 0, Field::none, 1000},
          s.camera);
    visit(Field{"drive", "", "Drive to use; empty: the only one.", 0, 0, Field::none, 1000}, s.drive);
    visit(Field{"prey", "", "Label of the prey.", 0, 0, Field::none, 100}, s.prey);
    visit(Field{"speed", "m/s", "Driving speed.", 0, 100, tunable}, s.speed_mps);
    visit(Field{"turn_speed", "rad/s", "Largest turning rate.", 0.01, 100, tunable}, s.turn_speed_radps);
    visit(Field{"horizon", "s", "Longest time ahead for which the prey is expected to keep its velocity.", 0,
                1000, tunable},
          s.horizon_s);
    visit(Field{"circle", "m", "Radius of the circle about the prey, from which encircle closes in.", 0.01,
                1000, tunable},
          s.circle_m);
  }
};

struct State {
  std::string prey;  ///< whose velocity it is
  Vec3 seen;
  Time seen_at;
  Vec3 velocity;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"prey", "", "Name of the prey that is hunted."}, s.prey);
    visit(Field{"seen", "m", "Position of the prey in the latest picture."}, s.seen);
    visit(Field{"seen_at", "s", "Time of the latest picture."}, s.seen_at);
    visit(Field{"velocity", "m/s", "Estimated velocity of the prey."}, s.velocity);
  }
};

struct Predator {
  using Spec = predator::Spec;
  using State = predator::State;
  Spec spec;
  State state;

  std::string name;
  Reading<msg::ObjectPoseArray> camera;
  Actuator<msg::Twist> drive;
  struct Hunter {
    double angle_rad = 0;  ///< direction from the prey
    double distance_m = 0;
    bool self = false;
  };
  std::vector<Hunter> hunters;  ///< scratch

  Status init(const Description& robot);
  void step(const Observation& obs, Command& cmd);

  /// Where a target at `at` with this velocity is met from `from`; after the horizon if it cannot be caught.
  Vec3 meeting_point(Vec3 from, Vec3 at, Vec3 velocity) const;
  /// The own place around the prey.
  Vec3 place_around(const msg::ObjectPoseArray& world, const msg::ObjectPose& self, Vec3 prey);

 private:
  void follow(const msg::ObjectPose& prey, Time stamp);
};

extern const ControllerKind kind;

}  // namespace sandlot::controllers::predator
