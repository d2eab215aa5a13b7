#pragma once
/// Governor of a chassis with steered wheels: set points of steering and drive that follow a velocity command within what
/// servos and motors can do.
///
/// Scaling    the command is scaled as a whole until no wheel turns faster than max_wheel_speed: the centre of rotation stays.
///            The motion set for the wheels goes from the present one to the command along a straight line in
///            (v_x, v_y, w), at a pace at which no wheel's velocity changes faster than max_wheel_acceleration and no
///            set point of steering faster than max_steering_rate: all wheels belong to one centre of rotation at every
///            moment, and a start or a stop keeps the centre of the command. The pace never falls below a sixteenth: where
///            the centre passes a wheel, this wheel's set point may lag behind for a few steps.
/// Steering   a wheel at psi that turns forward is the same as one at psi +- pi that turns backward: the one nearer to where
///            the set point is, within the range of steering. The other one must be nearer by `hysteresis`, and a set
///            point at the end of its range stays there while the wanted angle is no farther than that beyond it, so that
///            a command along the end of the range does not make the wheels turn round and round.
/// Transitions  steer before drive. While it drives, the speed of all wheels is scaled by cos(e), with e the largest error
///            of steering, between set points and what is measured. When e exceeds `steer_first`, or a set point would
///            have to jump that far, the motion is braked on its present centre, its set points of steering held, until e is at most half of it
///            and no jump is left; mostly that is a stop. Wheels are steered at rest, all arriving at the same time,
///            and it drives off when e is at most `aligned`. From rest it does so, too.
/// Commands   that move no wheel by `smallest_speed` count as stop: steering stays where it is. Commands that no angle in the range of steering
///            fits count as stop and are reported as unreachable.
/// Errors     none at run time; a command that is not finite counts as stop. @pre limits from a checked spec
/// Limits     a servo that leaves an error above `aligned` at rest never drives; wheels roll a little when they are steered
///            at the end of braking, by the lag of their motors.
/// Cost       one arc tangent per wheel and step, in steps that the steering rate limits twelve more; no allocation once lists have
///            their size.
#include <vector>

#include "controllers/four_wheel_steer/model.h"

namespace sandlot::controllers::four_wheel_steer {

struct Limits {
  double steering_lower_rad = -1.5708, steering_upper_rad = 1.5708;
  double max_steering_rate_radps = 4;
  double max_wheel_speed_radps = 20;
  double max_wheel_acceleration_radps2 = 30;
  double steer_first_rad = 0.35;
  double aligned_rad = 0.05;
  double hysteresis_rad = 0.1;
  double smallest_speed_mps = 0.005;
};

/// What the chassis does about its command at present.
enum class Phase : std::uint8_t { standing, steering, driving, braking };
inline constexpr EnumName<Phase> phase_names[] = {{"standing", Phase::standing},
                                                  {"steering", Phase::steering},
                                                  {"driving", Phase::driving},
                                                  {"braking", Phase::braking}};
constexpr std::span<const EnumName<Phase>> enum_names(Phase) { return phase_names; }

/// All that a governor keeps from step to step.
struct Setting {
  Motion motion;                       ///< that the wheels are set for
  std::vector<double> steering_rad;    ///< set point of each wheel
  std::vector<std::uint8_t> backward;  ///< each wheel rolls backward to go in its direction (1)
  Phase phase = Phase::standing;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"motion", "", "Velocity that the wheels are set for."}, s.motion);
    visit(Field{"steering", "rad", "Set point of each steering angle."}, s.steering_rad);
    visit(Field{"backward", "1", "Whether each wheel turns backward to go in its direction (1)."},
          s.backward);
    visit(Field{"phase", "", "Phase of the transition: standing, steering, driving, braking."}, s.phase);
  }
};

/// Set points of a step, and what led to them.
struct Orders {
  std::vector<double> rate_radps;  ///< set point of each wheel's rotation; steering is in the Setting
  Motion change;                   ///< derivative of the motion set for the wheels
  Mode mode = Mode::stop;          ///< of the command
  double scale = 1;                ///< part of the command that the wheels' speed allows
  double error_rad = 0;            ///< largest error of steering that was measured
  bool reachable = true;
};

/// Angle of a wheel for a direction of motion.
struct SteeringAngle {
  double rad = 0;
  bool backward = false, reachable = true;
};

class Governor {
 public:
  /// @pre 2..most_wheels wheels
  Governor(std::vector<Wheel> wheels, const Limits& limits);
  Governor() = default;

  std::span<const Wheel> wheels() const { return wheels_; }
  void set(const Limits& limits) { limits_ = limits; }
  /// Setting of wheels that stand at these angles.
  Setting start(std::span<const double> steering_rad) const;
  /// Whether a setting has the sizes and values that step() expects.
  bool fits(const Setting& setting) const;
  /// @param steering_rad  measured, of each wheel
  /// @param dt_s          since the previous step, > 0
  void step(const Motion& command, std::span<const double> steering_rad, double dt_s, Setting& setting,
            Orders& out);

 private:
  SteeringAngle angle_for(Vec2 velocity, double now_rad, bool backward) const;
  /// Sets wanted_ to the angles of a motion. @return the farthest that a set point is from its own
  double aim(const Motion& motion, const Setting& setting);
  Motion within_speed(const Motion& command, double& scale) const;
  /// Part of the way between two motions that the wheels' acceleration allows.
  double pace(const Motion& from, const Motion& to, double dt_s) const;
  void brake(double dt_s, Setting& setting) const;
  void steer(double dt_s, double farthest_rad, Setting& setting) const;
  void drive(const Motion& goal, double dt_s, Setting& setting);

  std::vector<Wheel> wheels_;
  Limits limits_;
  std::vector<SteeringAngle> wanted_;  ///< scratch of a step
};

}  // namespace sandlot::controllers::four_wheel_steer
