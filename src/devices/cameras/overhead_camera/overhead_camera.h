#pragma once
/// Camera above the field that reports the approximate places of all objects to all robots: the global video
/// camera of robot soccer's small leagues and of the first simulators of swarms.
///
/// Frame    `world`. Its own place does not matter: it sees everything from far above.
/// Output   level `world`: sandlot_msgs/ObjectPoseArray: name, label, colour and pose of every thing that
///          moves, or of every thing with `fixed`; those of the labels in `labels` alone, if there are any.
///          In order of creation.
/// Time     the end of the tick.
/// Noise    x and y: normal, `position_std` each; heading: normal, `yaw_std`; a thing is missed in a sample
///          with the probability `miss`. All times `errors`. Each thing's errors depend on its name, not on
///          what else is there.
/// Limits   nothing is hidden, confused or mistaken; the height, roll and pitch are true. No latency: what a
///          robot does with an old picture is its software's affair.
/// Cost     four normals per thing; nothing is drawn and no ray is cast. It drains no robot's energy.
/// Errors   a bad spec: place and path of the key.
/// Source   the list of sensors (global video camera) in a simulator for cooperation and competition of
///          mobile robots.
#include "devices/kind.h"
#include "messages/messages.h"
#include "noise/chain.h"

namespace sandlot::overhead_camera {

struct Spec {
  double position_std_m = 0, yaw_std_rad = 0, miss = 0;
  std::vector<std::string> labels;
  bool fixed = false, names = true;
  double rate_hz = 25;
  double errors = 1;

  static void fields(auto& s, auto&& visit) {
    constexpr unsigned tunable = Field::tunable;
    visit(Field{"position_std", "m", "Error of x and of y.", 0, 1e4, tunable}, s.position_std_m);
    visit(Field{"yaw_std", "rad", "Error of the heading.", 0, 10, tunable}, s.yaw_std_rad);
    visit(Field{"miss", "1", "Probability that an object is missed.", 0, 1, tunable}, s.miss);
    visit(Field{"labels", "", "Labels of the objects to report; none: all.", 0, 0, Field::none, 1000},
          s.labels);
    visit(Field{"fixed", "", "Whether objects that cannot move are reported, too."}, s.fixed);
    visit(Field{"names", "", "Whether names of objects are reported."}, s.names);
    visit(Field{"rate", "Hz", "Samples per second; 0: one in every tick.", 0, 1e5}, s.rate_hz);
    visit(errors_field, s.errors);
  }
};

struct State {
  static void fields(auto&, auto&&) {}
};

struct OverheadCamera {
  using Spec = overhead_camera::Spec;
  using State = overhead_camera::State;
  Spec spec;
  State state;

  std::uint64_t key = 0;
  Topic<msg::ObjectPoseArray>* world = nullptr;

  static Result<OverheadCamera> create(const DeviceBuild& build, Spec spec);
  static void sense(PoolView<OverheadCamera> pool, const Context& context);
};

extern const Kind kind;

}  // namespace sandlot::overhead_camera
