#pragma once
/// Forager: fetches items with a gripper and brings them home, one after the other; goes to a charging station in time.
///
/// Reads    an ObjectPoseArray in the frame of the world, in which the robot finds itself by its name and items by their label
///          (overhead_camera); a GripperState; with `battery`, a BatteryState.
/// Orders   a Twist for a drive that can turn on the spot; a Bool for the gripper.
/// Method   search   drives to the nearest item outside the nest that no other robot is nearer to, and closes the gripper when the
///                   item is in front; after `patience` without a catch it takes another.
///          carry    drives to the nest, opens the gripper inside and backs off.
///          charge   below `low_charge` it lets go of what it holds, drives to the nearest station and stays until `full_charge`.
/// Limits   no walls. Two robots may come to one station; the second waits beside it.
/// Cost     items times robots, no allocation once its list has grown.
/// Errors   no camera, drive, gripper or battery of these names.
#include <array>

#include "control/controller.h"
#include "control/steering.h"

namespace sandlot::controllers::forager {

struct Spec {
  std::string camera, drive, gripper, battery;
  std::string items = "item";
  std::array<double, 2> nest_m{};
  double nest_radius_m = 0.6;
  std::vector<std::array<double, 2>> stations_m;
  double station_radius_m = 0.1;
  double low_charge = 0.3, full_charge = 0.95;
  double speed_mps = 0.4;
  double turn_speed_radps = 2.5;
  double grip_m = 0.2;
  double patience_s = 20;

  static void fields(auto& s, auto&& visit) {
    constexpr unsigned tunable = Field::tunable;
    visit(Field{"camera", "", "Camera above the field to use; empty: the only one.", 0, 0, Field::none, 1000},
          s.camera);
    visit(Field{"drive", "", "Drive to use; empty: the only one.", 0, 0, Field::none, 1000}, s.drive);
    visit(Field{"gripper", "", "Gripper to use; empty: the only one.", 0, 0, Field::none, 1000}, s.gripper);
    visit(Field{"battery", "", "Battery to use; empty: none, the robot never charges.", 0, 0, Field::none,
                1000},
          s.battery);
    visit(Field{"items", "", "Label of the items to fetch.", 0, 0, Field::none, 100}, s.items);
    visit(Field{"nest", "m", "Middle of the nest: x y.", -1e6, 1e6, tunable}, s.nest_m);
    visit(Field{"nest_radius", "m", "Radius of the nest.", 0.01, 1e4, tunable}, s.nest_radius_m);
    visit(Field{"stations", "m", "Places of charging stations [x, y].", -1e6, 1e6, Field::none, 1000},
          s.stations_m);
    visit(
        Field{"station_radius", "m", "Distance from a station at which the robot stops.", 1e-3, 100, tunable},
        s.station_radius_m);
    visit(Field{"low_charge", "1", "Charge below which the robot goes to a station.", 0, 1, tunable},
          s.low_charge);
    visit(Field{"full_charge", "1", "Charge at which it leaves the station.", 0, 1, tunable}, s.full_charge);
    visit(Field{"speed", "m/s", "Driving speed.", 0, 100, tunable}, s.speed_mps);
    visit(Field{"turn_speed", "rad/s", "Largest turning rate.", 0.01, 100, tunable}, s.turn_speed_radps);
    visit(Field{"grip", "m", "Distance of an item ahead at which the gripper closes.", 0.01, 100, tunable},
          s.grip_m);
    visit(
        Field{"patience", "s", "Time without a catch after which another item is chosen.", 0.1, 1e6, tunable},
        s.patience_s);
  }
};

enum class Phase : std::uint8_t { search, carry, back_off, charge };

inline std::span<const EnumName<Phase>> enum_names(Phase) {
  static constexpr EnumName<Phase> names[] = {{"search", Phase::search},
                                              {"carry", Phase::carry},
                                              {"back_off", Phase::back_off},
                                              {"charge", Phase::charge}};
  return names;
}

struct State {
  Phase phase = Phase::search;
  std::string item;
  Time since;  ///< when the item was chosen
  Time backing_until;
  std::string left_alone;
  Time left_alone_until;
  bool closed = false;
  std::uint32_t brought = 0, charged = 0;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"phase", "", "What it does: search, carry, back_off or charge."}, s.phase);
    visit(Field{"item", "", "Item that it goes for or carries; empty: none."}, s.item);
    visit(Field{"since", "s", "Time at which the item was chosen."}, s.since);
    visit(Field{"backing_until", "s", "Time at which backing off ends."}, s.backing_until);
    visit(Field{"left_alone", "", "Item that could not be caught."}, s.left_alone);
    visit(Field{"left_alone_until", "s", "Time until which it is left to itself."}, s.left_alone_until);
    visit(Field{"closed", "", "Whether the gripper was ordered to close."}, s.closed);
    visit(Field{"brought", "1", "Items brought home."}, s.brought);
    visit(Field{"charged", "1", "Visits to stations."}, s.charged);
  }
};

struct Forager {
  using Spec = forager::Spec;
  using State = forager::State;
  Spec spec;
  State state;

  std::string name;
  Reading<msg::ObjectPoseArray> camera;
  Reading<msg::GripperState> held;
  Reading<msg::BatteryState> battery;
  Actuator<msg::Twist> drive;
  Actuator<msg::Bool> gripper;
  std::vector<steering::Disc> discs;  ///< scratch

  Status init(const Description& robot);
  void step(const Observation& obs, Command& cmd);

 private:
  struct View {
    Time now;
    const msg::ObjectPoseArray& world;
    const msg::ObjectPose& self;
    bool holds;
    double charge;
  };
  steering::Limits limits() const { return {spec.speed_mps, spec.turn_speed_radps}; }
  Vec3 nest() const { return {spec.nest_m[0], spec.nest_m[1], 0}; }
  const msg::ObjectPose* choose(const View& view) const;
  Vec3 way(const View& view, Vec3 to, bool around_items);
  msg::Twist search(const View& view);
  msg::Twist carry(const View& view);
  msg::Twist charge(const View& view);
  msg::Twist decide(const View& view);
};

extern const ControllerKind kind;

}  // namespace sandlot::controllers::forager
