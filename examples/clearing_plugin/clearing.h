#pragma once
/// Clearing: pushes scattered objects into an area, one after the other, alone or in agreement with team-mates.
///
/// Reads    an ObjectPoseArray in the frame of the world, in which the robot finds itself by its name, objects by their label
///          and others by what is left (overhead_camera); with `radio`, a RadioReceptionArray.
/// Orders   a Twist for a drive that can turn on the spot; with `radio`, a RadioPacket.
/// Method   the five steps of the paper:
///            1 choose    the closest object outside the destination;
///            2 approach  a place behind it, as seen from the destination, around objects and robots;
///            3 push      it towards the destination; the heading follows the direction from the robot to the destination and
///                        the side to which the object slides;
///            4           when it leaves the steering zone, back off and go to 2;
///            5           when it is inside, back off and go to 1.
///          An object that has not come nearer for `patience`, a quarter more or less by chance, is left to itself for as long again. Without anything to do the
///          robot keeps away from others.
/// Team     each robot sends the object that it has chosen with a bid, its distance (0 once it pushes): "box3 1250" [mm]. Of two
///          bids for one object the smaller wins, of equal ones the robot whose name precedes; the other chooses again. A claim
///          that has not been repeated for two seconds is forgotten. Without radio each chooses alone.
/// Numbers  by exact.h alone, so that a client in another language repeats them.
/// Limits   no walls: a place behind an object that lies at one is never reached. Objects no wider than the blade.
/// Cost     the number of objects squared at most, no allocation once its lists have grown.
/// Errors   no camera, drive or radio of these names.
/// Source   Simulator for cooperation and competition of mobile robots, section 4; the steering is ours.
#include <array>
#include <string>
#include <vector>

#include <sandlot/control.h>
#include "exact.h"

namespace my_clearing {

using namespace sandlot;

struct Spec {
  std::string camera, drive, radio;
  std::string objects = "box";
  std::array<double, 2> destination_m{};
  double radius_m = 0.6;
  double margin_m = 0.1;
  double speed_mps = 0.4;
  double push_speed_mps = 0.25;
  double turn_speed_radps = 2.5;
  double standoff_m = 0.34;
  double reach_m = 0.48;
  double zone_m = 0.09;
  double zone_angle_rad = 0.7;
  double object_clearance_m = 0.26;
  double robot_clearance_m = 0.36;
  double patience_s = 20;

  static void fields(auto& s, auto&& visit) {
    constexpr unsigned tunable = Field::tunable;
    visit(Field{"camera", "", "Camera above the field to use; empty: the only one.", 0, 0, Field::none, 1000},
          s.camera);
    visit(Field{"drive", "", "Drive to use; empty: the only one.", 0, 0, Field::none, 1000}, s.drive);
    visit(Field{"radio", "", "Radio that sends the chosen object to team-mates; empty: none.", 0, 0,
                Field::none, 1000},
          s.radio);
    visit(Field{"objects", "", "Label of the objects to move.", 0, 0, Field::none, 100}, s.objects);
    visit(Field{"destination", "m", "Middle of the destination: x y.", -1e6, 1e6, tunable}, s.destination_m);
    visit(Field{"radius", "m", "Radius of the destination.", 0.01, 1e4, tunable}, s.radius_m);
    visit(
        Field{"margin", "m", "Distance from the edge of the destination at which an object counts as inside.",
              0, 100, tunable},
        s.margin_m);
    visit(Field{"speed", "m/s", "Speed on the way to an object.", 0, 100, tunable}, s.speed_mps);
    visit(Field{"push_speed", "m/s", "Speed of pushing.", 0, 100, tunable}, s.push_speed_mps);
    visit(Field{"turn_speed", "rad/s", "Largest turning rate.", 0.01, 100, tunable}, s.turn_speed_radps);
    visit(
        Field{"standoff", "m", "Distance of the place behind an object from the object.", 0.01, 100, tunable},
        s.standoff_m);
    visit(Field{"reach", "m", "Steering zone: largest distance of the object ahead.", 0.01, 100, tunable},
          s.reach_m);
    visit(Field{"zone", "m", "Steering zone: largest distance of the object to either side.", 0.001, 100,
                tunable},
          s.zone_m);
    visit(Field{"zone_angle", "rad",
                "Steering zone: largest angle between the heading and the direction to the destination.",
                0.01, 3.2, tunable},
          s.zone_angle_rad);
    visit(Field{"object_clearance", "m", "Distance kept from objects on the way.", 0, 100, tunable},
          s.object_clearance_m);
    visit(Field{"robot_clearance", "m", "Distance kept from robots on the way.", 0, 100, tunable},
          s.robot_clearance_m);
    visit(
        Field{"patience", "s",
              "Time without progress after which another object is chosen; a quarter more or less by chance.",
              0.1, 1e6, tunable},
        s.patience_s);
  }
};

enum class Phase : std::uint8_t { choose, approach, push, back_off };

inline std::span<const EnumName<Phase>> enum_names(Phase) {
  static constexpr EnumName<Phase> names[] = {{"choose", Phase::choose},
                                              {"approach", Phase::approach},
                                              {"push", Phase::push},
                                              {"back_off", Phase::back_off}};
  return names;
}

/// What a team-mate has sent last.
struct Claim {
  std::string robot, object;
  std::uint32_t bid_mm = 0;
  Time received;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"robot", "", "Name of the team-mate."}, s.robot);
    visit(Field{"object", "", "Object that it has chosen; empty: none."}, s.object);
    visit(Field{"bid", "mm", "Distance of the team-mate from the object; 0: it pushes it."}, s.bid_mm);
    visit(Field{"received", "s", "Time of the message."}, s.received);
  }
};

struct State {
  Phase phase = Phase::choose;
  std::string object;
  double nearest_m = 0;  ///< of the object to the destination
  Time progress;         ///< when it last came nearer
  double patience_s = 0;
  Time backing_until;
  Vec3 stood;  ///< x, y [m] and heading [rad] since when it has hardly moved
  Time stood_since;
  std::string left_alone;
  Time left_alone_until;
  std::string sent_object;
  Time resend;
  std::uint32_t delivered = 0, slid = 0, yielded = 0, jammed = 0;
  std::vector<Claim> claims;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"phase", "", "Step of the law: choose, approach, push or back_off."}, s.phase);
    visit(Field{"object", "", "Chosen object; empty: none."}, s.object);
    visit(Field{"nearest", "m", "Smallest distance of the object from the destination."}, s.nearest_m);
    visit(Field{"progress", "s", "Time at which the object last came nearer."}, s.progress);
    visit(Field{"patience_now", "s", "Patience with this object."}, s.patience_s);
    visit(Field{"backing_until", "s", "Time at which backing off ends."}, s.backing_until);
    visit(Field{"stood", "m", "Place and heading, as z, that it has hardly left since."}, s.stood);
    visit(Field{"stood_since", "s", "Time at which it came to that place."}, s.stood_since);
    visit(Field{"left_alone", "", "Object that did not come nearer."}, s.left_alone);
    visit(Field{"left_alone_until", "s", "Time until which it is left to itself."}, s.left_alone_until);
    visit(Field{"sent_object", "", "Object in the message sent last."}, s.sent_object);
    visit(Field{"resend", "s", "Time at which the choice is sent again."}, s.resend);
    visit(Field{"delivered", "1", "Objects that it has pushed into the destination."}, s.delivered);
    visit(Field{"slid", "1", "Times that an object left the steering zone."}, s.slid);
    visit(Field{"yielded", "1", "Times that it left an object to a team-mate."}, s.yielded);
    visit(Field{"jammed", "1", "Times that it did not get away from where it was."}, s.jammed);
    visit(Field{"claims", "", "Objects that team-mates have chosen."}, s.claims);
  }
};

struct Clearing {
  using Spec = my_clearing::Spec;
  using State = my_clearing::State;
  static constexpr std::size_t most_claims = 64;
  Spec spec;
  State state;

  std::string name;
  Reading<msg::ObjectPoseArray> camera;
  Reading<msg::RadioReceptionArray> receiver;
  Actuator<msg::RadioPacket> sender;
  Actuator<msg::Twist> drive;
  std::vector<exact::Disc> discs;  ///< scratch

  Status init(const Description& robot);
  void step(const Observation& obs, Command& cmd);
  bool fits() const { return state.claims.size() <= most_claims; }

 private:
  struct View {
    Time now;
    const msg::ObjectPoseArray& world;
    exact::Place here;
    std::uint64_t random;  ///< of this step
  };
  void receive(const Observation& obs, const msg::ObjectPoseArray& world);
  void send(const View& view, Command& cmd);
  exact::Vec destination() const { return {spec.destination_m[0], spec.destination_m[1]}; }
  double outside_m(const msg::ObjectPose& object) const;
  std::uint32_t bid_mm(const msg::ObjectPose& object, const View& view) const;
  bool taken(const std::string& object, std::uint32_t bid_mm, Time now) const;
  bool in_zone(const msg::ObjectPose& object, const View& view) const;
  const msg::ObjectPose* choose(const View& view);
  void back_off(Time now);
  bool jammed(const View& view);
  exact::Vec way(const View& view, exact::Vec to);
  msg::Twist approach(const msg::ObjectPose& object, const View& view);
  msg::Twist push(const msg::ObjectPose& object, const View& view) const;
  msg::Twist wait(const View& view) const;
  msg::Twist decide(const View& view);
};

}  // namespace my_clearing
