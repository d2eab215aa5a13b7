#pragma once
/// Maneuvers of drives: a piece of way that a drive covers by itself, as RoBIOS' v-omega layer does.
///
/// Frame    D, the drive's own frame; poses are those of its odometry, with its errors. Turns count: a TURN by 4 pi is two turns.
/// Command  <device>/maneuver/command, at every level: sandlot_msgs/DriveManeuver. The latest of this and the drive's other
///          commands is in force; of those of one tick this one. `command_timeout` does not end it.
///          STRAIGHT   `distance` along the present heading, which the drive keeps.
///          TURN       by `angle` on the spot.
///          CURVE      an arc of length `distance` on which the heading changes by `angle`; without a distance a TURN.
///          TO_POINT   (x, y) from here. x > |y|: the arc that begins along the present heading, as RoBIOS' VWDrive. Else a
///                     turn towards the point, then straight. A car takes an arc always, backward to points behind it.
///          STOP       slows down as fast as its accelerations allow.
/// Output   <device>/maneuver: sandlot_msgs/DriveProgress, after the first maneuver alone.
/// Profile  trapezoid of the speed along the way: s / v + v / a seconds for s >= v^2 / a, and a few ticks more at the end. On a
///          curve of curvature k speed and acceleration are those at which turning rate and angular acceleration keep their
///          limits, too. A speed limit above 100 m/s or rad/s is none: 0.5 m/s and 1 rad/s are taken where the message gives
///          no speed. Likewise an acceleration above 100: 1 m/s^2 and 2 rad/s^2.
/// Loop     once per tick, on the odometry. The speed v for what is left, s, solves v t + v^2 / (2 a) = s with t = two ticks +
///          response time of the speed loops, so that it ends there. The heading follows the way covered. Within half of the
///          tolerance and slow enough to stop there it is done; the odometry then is within 1 mm and 1 mrad of the goal, or
///          within one edge of the encoders where that is more, with PI loops on v and w (`control:`) 5 mm and 10 mrad. What
///          is across the way is not corrected.
///          A drive that stays behind while it speeds up brakes earlier, by the acceleration that it attains.
/// Stall    a motor whose wheel is driven at 1 mm/s or more and turns at less than a tenth of that and less than 10 mm/s, for
///          0.25 s.
/// Errors   of a command: an unknown kind, a way beyond 1e6 m or rad; of a car, what needs a tighter turn than its tightest,
///          such as a TURN. They are refused where the command comes in, with the reason.
/// State    none until the first maneuver (devices/kind.h, late).
/// Cost     one arc tangent and a few square roots per tick while a maneuver is in force.
/// Source   T. Braunl, Embedded Robotics, 3rd ed. (2008), sec. 4.4 (v-omega interface); facts of RoBIOS-7's VWStraight, VWTurn,
///          VWCurve, VWDrive.
#include <cstdint>
#include <optional>
#include <vector>

#include "base/boxed.h"
#include "devices/kind.h"
#include "kinematics/wheels.h"
#include "messages/messages.h"

namespace sandlot::maneuver {

using kinematics::PlanarMotion;
using kinematics::PlanarPose;

/// What a drive can do.
struct Limits {
  double speed_mps = 1, turning_rate_radps = 3;
  double acceleration_mps2 = 2, angular_acceleration_radps2 = 10;
  std::optional<double> max_curvature_pm;  ///< of a car; none: it turns on the spot
  double edge_m = 0, edge_rad = 0;         ///< resolution of the odometry
  double response_s = 0;                   ///< of its speed loops
};

/// Acceleration that a drive attains: weak motors and heavy robots stay behind what is requested.
struct Ramp {
  double time_s = 0, from = 0;  ///< since, and the rate at, its beginning
  double share = 1;             ///< of the acceleration requested

  static void fields(auto& s, auto&& visit) {
    visit(Field{"time", "s", "Time since the beginning."}, s.time_s);
    visit(Field{"from", "", "Rate at the beginning."}, s.from);
    visit(Field{"share", "1", "Share of the acceleration that the drive attains."}, s.share);
  }
};

struct State {
  std::uint64_t taken = 0;    ///< commands seen
  std::uint64_t begun = 0;    ///< maneuvers
  std::uint8_t in_force = 0;  ///< 0: another command came later
  std::uint8_t kind = msg::DriveManeuver::stop;
  std::uint8_t done = 1;
  std::uint8_t turning = 0;                      ///< 1: it turns on the spot now
  double distance_m = 0, angle_rad = 0;          ///< of the way from `heading` on
  double x_m = 0, y_m = 0;                       ///< goal of TO_POINT, in the odometry
  double speed_mps = 0, turning_rate_radps = 0;  ///< largest of this maneuver
  double heading_rad = 0;                        ///< at which the way begins
  double way_m = 0;                              ///< covered
  PlanarPose pose;                               ///< odometry of the latest tick
  PlanarMotion setpoint;
  Ramp ramp;
  double remaining_m = 0, remaining_rad = 0;
  std::vector<double> standing_s;  ///< per motor: how long it has been driven without turning

  static void fields(auto& s, auto&& visit) {
    visit(Field{"taken", "1", "Number of maneuver commands seen."}, s.taken);
    visit(Field{"begun", "1", "Number of maneuvers begun."}, s.begun);
    visit(Field{"in_force", "1", "Whether the latest command was a maneuver (1)."}, s.in_force);
    visit(Field{"kind", "1", "Kind of the latest maneuver, a constant of DriveManeuver."}, s.kind);
    visit(Field{"done", "1", "Whether the maneuver is covered or was ended (1)."}, s.done);
    visit(Field{"turning", "1", "Whether the drive turns on the spot now (1)."}, s.turning);
    visit(Field{"distance", "m", "Length of the way."}, s.distance_m);
    visit(Field{"angle", "rad", "Change of heading on the way."}, s.angle_rad);
    visit(Field{"x", "m", "Goal along x, in the odometry."}, s.x_m);
    visit(Field{"y", "m", "Goal along y, in the odometry."}, s.y_m);
    visit(Field{"speed", "m/s", "Largest speed of the maneuver."}, s.speed_mps);
    visit(Field{"turning_rate", "rad/s", "Largest turning rate of the maneuver."}, s.turning_rate_radps);
    visit(Field{"heading", "rad", "Heading at the beginning of the way."}, s.heading_rad);
    visit(Field{"way", "m", "Way covered."}, s.way_m);
    visit(Field{"pose", "m", "Odometry of the latest tick."}, s.pose);
    visit(Field{"setpoint", "", "Velocity requested now."}, s.setpoint);
    visit(Field{"ramp", "", "Acceleration attained on this way or turn."}, s.ramp);
    visit(Field{"remaining_distance", "m", "Way left."}, s.remaining_m);
    visit(Field{"remaining_angle", "rad", "Change of heading left."}, s.remaining_rad);
    visit(Field{"standing", "s", "Time for which each motor has been driven without turning."}, s.standing_s);
  }
};

/// State of a drive that it has from its first maneuver on.
struct Late {
  State maneuver;
  static void fields(auto& s, auto&& visit) { visit(Field{"maneuver", "", "Latest maneuver."}, s.maneuver); }
};

/// Why a drive does not take a command; ok: it does.
Status check(const msg::DriveManeuver& command, std::optional<double> max_curvature_pm);

/// Command slot of maneuvers.
class Slot final : public Topic<msg::DriveManeuver> {
 public:
  Slot(std::string name, std::optional<double> max_curvature_pm)
      : Topic(std::move(name)), max_curvature_pm_(max_curvature_pm) {}
  Status assign(std::span<const std::byte> bytes) override;
  Status check(std::span<const std::byte> bytes) const override;
  std::unique_ptr<TopicBase> clone() const override { return std::make_unique<Slot>(*this); }

 private:
  std::optional<double> max_curvature_pm_;
};

struct Topics {
  Slot* command = nullptr;
  Topic<msg::DriveProgress>* progress = nullptr;
};
/// Comes last: the first topics and commands of a device are those that it is named for.
Topics make_topics(const DeviceBuild& build, std::optional<double> max_curvature_pm = std::nullopt);

/// A command that the drive has not seen yet.
inline bool is_new(const Boxed<Late>& late, const Slot& slot) {
  return slot.count != (late ? late->maneuver.taken : 0);
}
inline bool in_force(const Boxed<Late>& late) { return late && late->maneuver.in_force; }

/// Begins the slot's maneuver. @param moving  velocity of D now  @param motors  number of the drive's motors
void begin(Boxed<Late>& late, const Slot& slot, const Limits& limits, const PlanarPose& now,
           const PlanarMotion& moving, std::size_t motors);
void begin(State& state, const msg::DriveManeuver& command, const Limits& limits, const PlanarPose& now,
           const PlanarMotion& moving);
/// Another command came.
void end(Boxed<Late>& late);
/// Takes the odometry of this tick; `setpoint` is the velocity for the tick that begins. @pre it is in force
void step(State& state, const Limits& limits, const PlanarPose& now, double tick_s);
/// Speeds of the rim of a motor's wheel, once per tick. @param motor  from 0
void watch_motor(State& state, std::size_t motor, double wanted_mps, double turning_mps, double tick_s);
/// All of it in a tick of a drive without wheels: it counts its true motion.
/// @return whether a maneuver is in force
bool ride(Boxed<Late>& late, const Topics& topics, const Limits& limits, const BodyState& base,
          const Context& context);
void publish(Topic<msg::DriveProgress>& topic, const State& state, Time now);
/// Whether a snapshot's State fits a drive with so many motors.
bool fits(const Boxed<Late>& late, std::size_t motors);

}  // namespace sandlot::maneuver
