#pragma once
/// Carriers: pushes a long load with the robots of a team; one program decides for all.
///
/// Reads      of the first robot an ObjectPoseArray in the frame of the world, in which it finds the robots and the load by their
///            names (overhead_camera); of each, with `battery`, a BatteryState, and with `health`, a PropertyStamped.
/// Orders     a Twist for a drive that can turn on the spot, each robot of the team.
/// Publishes  `pushing`, std_msgs/UInt32: how many robots push.
/// Method     controllers/carrying.h, as carrier, with all that is known at once and without messages.
/// Limits     those of controllers/carrying.h.
/// Cost       robots times posts squared, no allocation once its lists have grown.
/// Errors     not a team's controller; no camera, drive, battery or property sensor of these
///            names.
#include "controllers/carrying.h"

namespace sandlot::controllers::carriers {

struct State {
  std::vector<carrying::Member> members;
  std::vector<carrying::Effort> efforts;
  bool pushing = false;
  std::uint32_t settled = 0;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"members", "", "What is known of the robots."}, s.members);
    visit(Field{"efforts", "", "Their motion, compared to what was ordered."}, s.efforts);
    visit(Field{"pushing", "", "Whether they push."}, s.pushing);
    visit(Field{"settled", "1", "Times that a post has changed hands."}, s.settled);
  }
};

struct Carriers {
  using Spec = carrying::Keys;
  using State = carriers::State;
  Spec spec;
  State state;

  struct Robot {
    std::string name;
    Reading<msg::BatteryState> battery;
    Reading<msg::PropertyStamped> health;
    Actuator<msg::Twist> drive;
  };
  Reading<msg::ObjectPoseArray> camera;
  std::vector<Robot> robots;
  Publication<msg::UInt32> pushing;
  std::vector<steering::Disc> discs;             ///< scratch
  std::vector<const carrying::Member*> members;  ///< scratch
  std::vector<std::int32_t> posts;               ///< scratch

  Status init(const Description& team, Outputs& out);
  void step(const Observation& obs, Command& cmd);
  bool fits() const;

 private:
  void match();
};

extern const ControllerKind kind;

}  // namespace sandlot::controllers::carriers
