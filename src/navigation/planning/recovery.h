#pragma once
/// Recovery: what a robot does that gets no further.
///
///   watching -> clear -> wait -> back up -> turn -> watching      (a round; `rounds` of them, then given up)
///
/// A round begins when the robot's planner or follower reports a failure, or when it has not come `progress_m`
/// further for `stuck_time_s` though it has a goal. Every stage ends early when what it waits for is over: motions
/// end where the footprint would touch something, and are left out by those that can't make them. Rounds are
/// counted from the last progress. No motion leads to where the robot does not know that it is free.
///
/// Frame    pose in the map's frame, commands in the robot's.
/// Errors   none: a pose that is not finite stops the robot, and time goes on.
/// Limits   looks at the map only, one motion ahead; moving obstacles must be in it.
/// Cost     a few footprint checks.
/// Source   the order of Nav2's default behaviour tree (clear, spin, wait, back up), with the cheap ones first.
#include <cstdint>
#include <functional>
#include <span>

#include "navigation/maps/footprint.h"
#include "navigation/planning/motion.h"

namespace sandlot::navigation {

enum class RecoveryStage : std::uint8_t { watching, clearing, waiting, backing, turning, given_up };
std::span<const EnumName<RecoveryStage>> enum_names(RecoveryStage);

struct RecoverySpec {
  double stuck_time_s = 6, progress_m = 0.2, progress_rad = 0.6;
  double wait_s = 2;
  double back_up_m = 0.3, back_up_mps = 0.1;
  double turn_rad = 1.6, turn_radps = 0.5;
  int rounds = 3;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"stuck_time", "s", "Time without progress after which the robot counts as stuck.", 0.1, 3600},
          s.stuck_time_s);
    visit(Field{"progress", "m", "Distance that counts as progress.", 0.001, 100}, s.progress_m);
    visit(Field{"progress_angle", "rad", "Turn that counts as progress.", 0.01, math::pi}, s.progress_rad);
    visit(Field{"wait", "s", "Time to wait for somebody to leave.", 0, 3600}, s.wait_s);
    visit(Field{"back_up", "m", "Distance to back up. 0: never.", 0, 100}, s.back_up_m);
    visit(Field{"back_up_speed", "m/s", "Speed of backing up.", 0.001, 10}, s.back_up_mps);
    visit(Field{"turn", "rad", "Angle to turn on the spot. 0: never.", 0, math::tau}, s.turn_rad);
    visit(Field{"turn_rate", "rad/s", "Rate of the turn.", 0.01, 10}, s.turn_radps);
    visit(Field{"rounds", "1", "Number of rounds before the robot gives up.", 1, 1000}, s.rounds);
  }
};

struct RecoveryState {
  RecoveryStage stage = RecoveryStage::watching;
  double stage_s = 0;  ///< in this stage
  double idle_s = 0;   ///< since the last progress
  double done = 0;     ///< of the motion of this stage: [m] or [rad]
  std::int32_t round = 0;
  bool seen = false;                       ///< whether there is a last progress
  double x_m = 0, y_m = 0, theta_rad = 0;  ///< pose of the last progress
  static void fields(auto& s, auto&& visit) {
    visit(Field{"stage", "", "Stage of the recovery."}, s.stage);
    visit(Field{"stage_time", "s", "Time in the stage."}, s.stage_s);
    visit(Field{"idle_time", "s", "Time since the last progress."}, s.idle_s);
    visit(Field{"done", "", "Part of the stage's motion that is done, in metres or radians."}, s.done);
    visit(Field{"round", "1", "Number of rounds since the last progress."}, s.round);
    visit(Field{"seen", "", "Whether there is a last progress."}, s.seen);
    visit(Field{"x", "m", "Place of the last progress, x."}, s.x_m);
    visit(Field{"y", "m", "Place of the last progress, y."}, s.y_m);
    visit(Field{"theta", "rad", "Heading at the last progress."}, s.theta_rad);
  }
};

struct RecoveryStep {
  RecoveryStage stage =
      RecoveryStage::watching;  ///< watching: drive on; given_up: report it to whoever set the goal
  bool clear_map = false;       ///< once a round: forget what sensors marked near the robot
  bool plan_again = false;      ///< once a round, at its end
  PlanarTwist command;          ///< while backing and turning; else stand still, unless watching
};

/// @param failed     the planner found no way, or the follower is blocked, lost or has missed the goal
/// @param map        to look ahead in
/// @param state      begins anew ({}) with each goal
/// @param known      whether all that the robot covers at a pose is known to be free; none: the map knows all
/// @pre   the spec's numbers lie in their ranges (check_ranges), dt_s > 0
RecoveryStep recover(const RecoverySpec& spec, RecoveryState& state, const CostMap& map,
                     const Footprint& footprint, const Pose2& X_MB, bool failed, double dt_s,
                     const std::function<bool(const Pose2&)>& known = {});

}  // namespace sandlot::navigation
