#pragma once
/// Carrier: pushes a long load with team-mates; each decides for itself, by what all send each other.
///
/// Reads    an ObjectPoseArray in the frame of the world, in which the robot finds itself and the load by their names
///          (overhead_camera); a RadioReceptionArray; with `battery`, a BatteryState; with `health`, a PropertyStamped, of which the
///          place between its limits counts.
/// Orders   a Twist for a drive that can turn on the spot, and a RadioPacket.
/// Method   controllers/carrying.h. Each sends charge, health, load, its post, whether it stands there, and a bid for each post:
///          "87 100 12 0 1 1250 2480" [%, %, %, post, 0 or 1, mm ...]. Each settles all roles by the same rule from what it has
///          received; who has sent nothing for a second takes no part.
/// Limits   for a moment two may think that they have one post, until their messages have arrived.
/// Cost     robots times posts squared, no allocation once its lists have grown.
/// Errors   no camera, drive, radio, battery or property sensor of these names.
/// Source   the negotiation of team-mates about their resources: Simulator for cooperation and competition of mobile robots,
///          section 1; the bids are ours.
#include "controllers/carrying.h"

namespace sandlot::controllers::carrier {

struct Spec {
  carrying::Keys keys;
  std::string radio;

  static void fields(auto& s, auto&& visit) {
    carrying::Keys::fields(s.keys, visit);
    visit(Field{"radio", "", "Radio to use; empty: the only one.", 0, 0, Field::none, 1000}, s.radio);
  }
};

struct State {
  carrying::Member own;
  carrying::Effort effort;
  Time resend;
  bool pushing = false;
  std::uint32_t settled = 0;
  std::vector<carrying::Member> others;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"own", "", "Own values, as they are sent."}, s.own);
    visit(Field{"effort", "", "Motion of the robot compared to what was ordered."}, s.effort);
    visit(Field{"resend", "s", "Time of the next message."}, s.resend);
    visit(Field{"pushing", "", "Whether it pushes."}, s.pushing);
    visit(Field{"settled", "1", "Times that its post has changed."}, s.settled);
    visit(Field{"others", "", "Values received from the others."}, s.others);
  }
};

struct Carrier {
  using Spec = carrier::Spec;
  using State = carrier::State;
  Spec spec;
  State state;

  std::string name;
  Reading<msg::ObjectPoseArray> camera;
  Reading<msg::RadioReceptionArray> receiver;
  Reading<msg::BatteryState> battery;
  Reading<msg::PropertyStamped> health;
  Actuator<msg::RadioPacket> sender;
  Actuator<msg::Twist> drive;
  std::vector<steering::Disc> discs;             ///< scratch
  std::vector<const carrying::Member*> members;  ///< scratch
  std::vector<std::int32_t> posts;               ///< scratch

  Status init(const Description& robot);
  void step(const Observation& obs, Command& cmd);
  bool fits() const;

 private:
  void receive(const Observation& obs);
  void send(const Observation& obs, Command& cmd);
};

extern const ControllerKind kind;

}  // namespace sandlot::controllers::carrier
