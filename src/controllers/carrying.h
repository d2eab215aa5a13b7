#pragma once
/// Carrying: what robots that push a long load together have in common, whether each decides for itself (carrier) or one program
/// for all (carriers): their keys, the settling of roles by bids, and the law by which one drives in its role.
///
/// Roles    post k is a place behind the load, `posts[k]` to the left of its middle; a robot without a post stands by.
/// Bids     for a post: the way to it [m] / (charge health) * (1 + load). The smallest bid of all wins its post, then the smallest of
///          those that are left. A bid for the post that a robot has counts `kept` of it, so that roles do not flutter. Below
///          `least_charge` or `least_health` a robot bids for nothing.
/// Pushing  begins when all posts are manned. The robot at post k drives with speed (1 - turn_gain e posts[k] / widest post), where e
///          is the angle from the load's axis to the destination: the load turns towards it.
/// Limits   the load is a straight beam across its way, seen from above; nothing else is in the way.
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "control/controller.h"
#include "control/steering.h"

namespace sandlot::controllers::carrying {

inline constexpr std::size_t most_posts = 16, most_robots = 64;

struct Keys {
  std::string camera, drive, battery, health;
  std::string load = "beam";
  std::array<double, 2> destination_m{};
  double tolerance_m = 0.15;
  std::vector<double> posts_m{0.5, -0.5};
  double standoff_m = 0.25;
  double speed_mps = 0.3;
  double push_speed_mps = 0.15;
  double turn_speed_radps = 2;
  double turn_gain = 2;
  double least_charge = 0.15, least_health = 0.15;

  static void fields(auto& s, auto&& visit) {
    constexpr unsigned tunable = Field::tunable;
    visit(Field{"camera", "", "Camera above the field to use; empty: the only one.", 0, 0, Field::none, 1000},
          s.camera);
    visit(Field{"drive", "", "Drive to use; empty: the only one.", 0, 0, Field::none, 1000}, s.drive);
    visit(Field{"battery", "", "Battery to use; empty: none, the robot counts as fully charged.", 0, 0,
                Field::none, 1000},
          s.battery);
    visit(Field{"health", "",
                "Property sensor of the robot's health to use; empty: none, the robot counts as sound.", 0, 0,
                Field::none, 1000},
          s.health);
    visit(Field{"load", "", "Name of the load.", 0, 0, Field::none, 100}, s.load);
    visit(Field{"destination", "m", "Destination of the load's middle: x y.", -1e6, 1e6, tunable},
          s.destination_m);
    visit(Field{"tolerance", "m", "Distance at which the destination counts as reached.", 1e-3, 100, tunable},
          s.tolerance_m);
    visit(Field{"posts", "m", "Places at which it is pushed, to the left of its middle.", -1e3, 1e3,
                Field::none, most_posts, 1},
          s.posts_m);
    visit(Field{"standoff", "m", "Distance of a post from the load's axis.", 0.01, 100, tunable},
          s.standoff_m);
    visit(Field{"speed", "m/s", "Speed on the way to a post.", 0, 100, tunable}, s.speed_mps);
    visit(Field{"push_speed", "m/s", "Speed of pushing.", 0, 100, tunable}, s.push_speed_mps);
    visit(Field{"turn_speed", "rad/s", "Largest turning rate.", 0.01, 100, tunable}, s.turn_speed_radps);
    visit(Field{"turn_gain", "1/rad", "Difference of speed per angle that the load has to turn.", 0, 100,
                tunable},
          s.turn_gain);
    visit(Field{"least_charge", "1", "Charge below which a robot takes no role.", 0, 1, tunable},
          s.least_charge);
    visit(Field{"least_health", "1", "Health below which a robot takes no role.", 0, 1, tunable},
          s.least_health);
  }
};

inline constexpr std::int32_t no_post = -1;
/// Costs of a post that a robot does not bid for.
inline constexpr double no_bid = 1e9;

/// What is known of one robot.
struct Member {
  std::string robot;
  double charge = 1, health = 1, load = 0;
  std::int32_t post = no_post;
  bool ready = false;
  std::vector<double> bids;  ///< per post
  Time received;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"robot", "", "Name of the robot."}, s.robot);
    visit(Field{"charge", "1", "Charge of its battery."}, s.charge);
    visit(Field{"health", "1", "Health of the robot."}, s.health);
    visit(Field{"load", "1", "Part of its ordered speed that it does not reach."}, s.load);
    visit(Field{"post", "1", "Post that it has taken; -1: none."}, s.post);
    visit(Field{"ready", "", "Whether it stands at its post."}, s.ready);
    visit(Field{"bids", "m", "Bids for the posts."}, s.bids);
    visit(Field{"received", "s", "Time of its message."}, s.received);
  }
};

/// The load as it lies: the axis that points to the destination side, and its left.
struct Load {
  Vec3 middle, ahead, left;
  double error_rad = 0;  ///< from `ahead` to the direction of the destination
  bool arrived = false;
};
Load look_at(const Keys& keys, const Pose& X_WL);

/// Place of a post in the world.
Vec3 place(const Keys& keys, const Load& load, std::size_t post);
/// Charge from 0 to 1 as a battery reports it; `before` where it has reported none.
double charge_of(const View<msg::BatteryState>& battery, double before);
/// Health from 0 to 1: where a property lies between its limits; `before` where none was reported.
double health_of(const View<msg::PropertyStamped>& health, double before);
/// Fills in the bids of a robot at this pose, from what is known of it.
void bid(const Keys& keys, const Load& load, const Pose& X_WB, Member& member);
/// Whether a robot at this pose stands at the post and looks at the load.
bool at_post(const Keys& keys, const Load& load, const Pose& X_WB, std::size_t post);
/// Settles the roles of all members by their bids: who gets which post. Ties go to the name that precedes.
/// @param posts  out: per member its post, or no_post
void settle(std::span<const Member* const> members, std::size_t post_count, std::vector<std::int32_t>& posts);
/// Drives a robot in its role. @param pushing  all posts are manned
msg::Twist drive(const Keys& keys, const Load& load, const msg::ObjectPoseArray& world,
                 const msg::ObjectPose& self, std::int32_t post, bool pushing,
                 std::vector<steering::Disc>& scratch);

/// Follows how much of the ordered speed a robot reaches.
struct Effort {
  Vec3 seen;
  Time seen_at;
  double ordered_mps = 0, load = 0;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"seen", "m", "Own position in the latest picture."}, s.seen);
    visit(Field{"seen_at", "s", "Time of the latest picture."}, s.seen_at);
    visit(Field{"ordered", "m/s", "Ordered speed."}, s.ordered_mps);
    visit(Field{"load", "1", "Part of the ordered speed that it does not reach."}, s.load);
  }
  void follow(Vec3 at, Time stamp);
};

}  // namespace sandlot::controllers::carrying
