#pragma once
/// Prey: keeps away from predators in a walled yard, by one of three strategies.
///
/// Reads    an ObjectPoseArray in the frame of the world, in which the robot finds itself by its name and predators by their label
///          (overhead_camera).
/// Orders   a Twist for a drive that can turn on the spot.
/// Method   flee     drives straight away from the nearest predator, along the walls where it comes to them.
///          zigzag   the same, turned by `swerve` to one side and the other in turns of `period`.
///          hide     of 24 directions it takes the one with the least danger: the sum, over points along the way of the next
///                   `horizon`, of 1 / distance^2 to each predator and to each wall that is near.
///          While no predator is nearer than `alarm` it stands.
/// Limits   the yard is a rectangle about the origin; with `yard` 0 there are no walls.
/// Cost     hide: 24 directions times 4 points times the predators.
/// Errors   no camera or drive of these names.
#include <array>

#include "control/controller.h"
#include "control/steering.h"

namespace sandlot::controllers::prey {

enum class Strategy : std::uint8_t { flee, zigzag, hide };

inline std::span<const EnumName<Strategy>> enum_names(Strategy) {
  static constexpr EnumName<Strategy> names[] = {
      {"flee", Strategy::flee}, {"zigzag", Strategy::zigzag}, {"hide", Strategy::hide}};
  return names;
}

struct Spec {
  Strategy strategy = Strategy::flee;
  std::string camera, drive;
  std::string predators = "predator";
  std::array<double, 2> yard_m{};
  double speed_mps = 0.5;
  double turn_speed_radps = 4;
  double alarm_m = 2;
  double swerve_rad = 0.8;
  double period_s = 1.5;
  double horizon_s = 2;

  static void fields(auto& s, auto&& visit) {
    constexpr unsigned tunable = Field::tunable;
    visit(
        Field{"strategy", "",
              "Way of escaping. flee: straight away; zigzag: swerving; hide: to where there is least danger.",
              0, 0, tunable},
        s.strategy);
    visit(Field{"camera", "", "Camera above the field to use; empty: the only one.", 0, 0, Field::none, 1000},
          s.camera);
    visit(Field{"drive", "", "Drive to use; empty: the only one.", 0, 0, Field::none, 1000}, s.drive);
    visit(Field{"predators", "", "Label of the predators.", 0, 0, Field::none, 100}, s.predators);
    visit(Field{"yard", "m",
                "Size of the yard about the origin along x and y, between its walls; 0: no walls.", 0, 1e6},
          s.yard_m);
    visit(Field{"speed", "m/s", "Driving speed.", 0, 100, tunable}, s.speed_mps);
    visit(Field{"turn_speed", "rad/s", "Largest turning rate.", 0.01, 100, tunable}, s.turn_speed_radps);
    visit(Field{"alarm", "m", "Distance of a predator within which it moves.", 0, 1e4, tunable}, s.alarm_m);
    visit(Field{"swerve", "rad", "Angle to either side with zigzag.", 0, 1.5, tunable}, s.swerve_rad);
    visit(Field{"period", "s", "Period of zigzag.", 0.01, 1000, tunable}, s.period_s);
    visit(Field{"horizon", "s", "Time ahead that hide looks at.", 0.1, 100, tunable}, s.horizon_s);
  }
};

struct Prey {
  using Spec = prey::Spec;
  using State = NoFields;
  Spec spec;
  State state;

  std::string name;
  Reading<msg::ObjectPoseArray> camera;
  Actuator<msg::Twist> drive;

  Status init(const Description& robot);
  void step(const Observation& obs, Command& cmd);

  /// A heading with what leads into a near wall taken out of it.
  double along_walls(Vec3 at, double heading_rad) const;
  /// Danger of driving along a heading from `at`.
  double danger(const msg::ObjectPoseArray& world, Vec3 at, double heading_rad) const;
};

extern const ControllerKind kind;

}  // namespace sandlot::controllers::prey
