#pragma once
/// Base of the drives with wheels of several kinds: skid, track, Ackermann, omni, Mecanum and swerve drive.
///
/// A kind brings a spec (the names of its joints), the wheels they are (kinematics/wheels.h) and what the
/// chassis cannot do.
///
/// Frame    B: the canonical link. D: the drive's own frame, axes as B, at (dx, dy) of B: see each kind.
/// Levels   `ideal` (the default): the base moves on rails at the commanded velocity with limited
///          acceleration, on every engine; wheels turn as if they rolled where the base goes. They count as
///          steered at once; their joints follow gently, since the base feels them turn. `contact`: motors
///          turn the wheels and friction decides; a wheel with rollers is one body that grips along the
///          roller's axis. `rollers` (omni and Mecanum): every roller is a body. Exactly one level is active.
///          A switch keeps pose, velocity, odometry and command.
/// Commands <device>/<level>/command: geometry_msgs/Twist, velocity of D in D; what the drive cannot do of it
/// is left out.
///          <device>/<level>/wheels/command: sensor_msgs/JointState for single wheels: `velocity` [rad/s], or
///          `effort` (a torque [Nm]; with `motor:` the share of the battery's voltage, -1 to 1), `position`
///          [rad] steers. Names of joints say whose, in any order; without names they are those of the
///          wheels, then of the steering, in the spec's order. Wheels that a message leaves out keep their
///          last command. Whatever kind of command came last counts; of two in one tick the wheels'. On level
///          `ideal` an effort has no effect.
///          <device>/maneuver/command: a piece of way, of which devices/drives/maneuver.h speaks.
/// Output   <device>/<level>: nav_msgs/Odometry of B from the joints alone, as diff_drive's.
///          <device>/<level>/wheels: sensor_msgs/JointState of wheels and steering, angles as the encoders
///          show them. With `encoder_ticks` <device>/<level>/ticks: std_msgs/Int64MultiArray. State:
///          `residual` [m] of the last step's odometry (the wheels contradict each other: slip), `power` [W]
///          and `energy` [J].
/// Motors   by default each wheel reaches its speed with at most max_wheel_effort. `motor:` limits that to
///          what winding and battery give at its speed. `control:` puts PI loops on v and w in its place
///          (RoBIOS' VWStartControl): each puts out vv (e + integral e / tv), a share of max_wheel_effort, or
///          with `motor:` of the voltage; vv and tv serve forward and sideways, vw and tw the turn. Rotor
///          inertia, friction and inductance of `motor:` count where the voltage is set: with `control:` and
///          with effort commands.
/// Power    sum of torque times speed of all joints, negative while they brake; with `motor:` plus the copper
///          losses. None on level `ideal`. From a battery the drive draws this `power` if it has a `motor:`; without one its
///          mechanical work (devices/energy.h).
/// Time     a command acts from its tick on; after `command_timeout` without a new one wheels and base stop.
///          Odometry counts in every tick, on exact arcs.
/// Limits   even ground; steering axes through the wheel's middle; no play. The twist of the odometry is from
///          exact speeds.
/// Cost     a dozen operations per wheel and sub-step, a 3 x 3 system per tick; a sine-cosine pair per
///          steered wheel. No allocation after the first messages.
/// Errors   joints that are not there, do not turn or lie wrongly; wheels without size or at one place, that
///          cannot drive; a level that engine or drive lack.
#include <array>
#include <bit>
#include <optional>

#include "devices/drives/maneuver.h"
#include "devices/kind.h"
#include "devices/motor.h"
#include "devices/pid.h"
#include "kinematics/ackermann.h"
#include "kinematics/wheels.h"
#include "messages/messages.h"

namespace sandlot::wheeled {

enum Level : std::uint32_t { ideal, contact, rollers };
inline constexpr std::size_t most_levels = 3;
/// Commands to the engine that a switch of level leaves to be given, in State::handover.
enum Handover : std::uint8_t { hand_base = 1, hand_wheels = 2 };

struct Control {
  double vv = 7, tv = 0.3, vw = 10, tw = 0.1;
  static void fields(auto& s, auto&& visit) {
    constexpr unsigned tunable = Field::tunable;
    visit(Field{"vv", "s/m", "Gain of the speed: share of the full effort per m/s.", 0, 1e6, tunable}, s.vv);
    visit(Field{"tv", "s", "Integration time of the speed.", 1e-3, 1e6, tunable}, s.tv);
    visit(Field{"vw", "s/rad", "Gain of the turning rate: share of the full effort per rad/s.", 0, 1e6,
                tunable},
          s.vw);
    visit(Field{"tw", "s", "Integration time of the turning rate.", 1e-3, 1e6, tunable}, s.tw);
  }
};

enum class Odometry : std::uint8_t { least_squares, kabsch };
inline constexpr EnumName<Odometry> odometry_names[] = {{"least_squares", Odometry::least_squares},
                                                        {"kabsch", Odometry::kabsch}};
constexpr std::span<const EnumName<Odometry>> enum_names(Odometry) { return odometry_names; }

/// The keys that every drive has; a kind's Spec derives from it.
struct Common {
  std::optional<double> wheel_radius_m;
  double max_linear_speed_mps = 1, max_angular_speed_radps = 3;
  double max_linear_acceleration_mps2 = 2, max_angular_acceleration_radps2 = 10;
  double max_wheel_effort_Nm = 5;
  double max_steering_speed_radps = 10, max_steering_effort_Nm = 10;  ///< of drives that steer
  double command_timeout_s = 0;
  std::optional<Control> control;
  std::optional<MotorSpec> motor;
  int encoder_ticks = 0;
  Odometry odometry = Odometry::least_squares;
  double rate_hz = 50;

  static void fields(auto& s, auto&& visit) {
    constexpr unsigned tunable = Field::tunable;
    visit(Field{"wheel_radius", "m",
                "Radius of the wheels; not given: that of their rollers or collision shapes.", 1e-4, 100},
          s.wheel_radius_m);
    visit(Field{"max_linear_speed", "m/s", "Largest speed; faster commands are cut.", 0, 1e9, tunable},
          s.max_linear_speed_mps);
    visit(Field{"max_angular_speed", "rad/s", "Largest turning rate; faster commands are cut.", 0, 1e9,
                tunable},
          s.max_angular_speed_radps);
    visit(Field{"max_linear_acceleration", "m/s^2", "Largest acceleration, speeding up and braking.", 0, 1e9,
                tunable},
          s.max_linear_acceleration_mps2);
    visit(Field{"max_angular_acceleration", "rad/s^2",
                "Largest angular acceleration, speeding up and braking.", 0, 1e9, tunable},
          s.max_angular_acceleration_radps2);
    visit(Field{"max_wheel_effort", "Nm", "Largest effort of each wheel's motor.", 0, 1e9, tunable},
          s.max_wheel_effort_Nm);
    visit(Field{"command_timeout", "s", "Time without a command after which the robot stops; 0: never.", 0,
                1e6, tunable},
          s.command_timeout_s);
    visit(Field{"control", "",
                "PI loops on v and w, as RoBIOS has them; not given: each wheel keeps its speed."},
          s.control);
    visit(Field{"motor", "",
                "DC motor of each wheel, on one battery; not given: max_wheel_effort at any speed."},
          s.motor);
    visit(Field{"encoder_ticks", "1",
                "Encoder ticks of the odometry per turn of a wheel; 0: the exact angle.", 0, 1e8},
          s.encoder_ticks);
    visit(Field{"odometry", "", "Reconciliation of wheels that contradict each other."}, s.odometry);
    visit(Field{"rate", "Hz", "Odometry messages per second; 0: one in every tick.", 0, 1e5}, s.rate_hz);
  }
  static void steering_fields(auto& s, auto&& visit) {
    constexpr unsigned tunable = Field::tunable;
    visit(Field{"max_steering_speed", "rad/s", "Largest speed of the steering motors.", 0, 1e4, tunable},
          s.max_steering_speed_radps);
    visit(Field{"max_steering_effort", "Nm", "Largest effort of each steering motor.", 0, 1e9, tunable},
          s.max_steering_effort_Nm);
  }
};

/// Per wheel.
struct WheelState {
  double command = 0;                         ///< speed or effort commanded for this wheel alone
  std::uint8_t by_effort = 0;                 ///< 1: its last command was an effort
  double counted_rad = 0;                     ///< angle that the odometry has counted
  double virtual_rad = 0, virtual_radps = 0;  ///< of a wheel without a joint
  double current_A = 0;                       ///< in its motor
  static void fields(auto& s, auto&& visit) {
    visit(Field{"told", "", "Command of this wheel alone."}, s.command);
    visit(Field{"by_effort", "1", "Whether the wheel's own command is an effort (1)."}, s.by_effort);
    visit(Field{"counted", "rad", "Angle counted by the odometry."}, s.counted_rad);
    visit(Field{"virtual_angle", "rad", "Angle of a wheel without a joint."}, s.virtual_rad);
    visit(Field{"virtual_speed", "rad/s", "Speed of a wheel without a joint."}, s.virtual_radps);
    visit(Field{"current", "A", "Current in the wheel's motor."}, s.current_A);
  }
};
/// Per steering joint.
struct PivotState {
  double target_rad = 0;      ///< commanded steering angle
  double counted_rad = 0;     ///< angle at the odometry's last step
  std::uint8_t backward = 0;  ///< 1: its wheels turn backward to roll in the requested direction
  static void fields(auto& s, auto&& visit) {
    visit(Field{"told", "rad", "Commanded steering angle."}, s.target_rad);
    visit(Field{"counted", "rad", "Angle at the odometry's last step."}, s.counted_rad);
    visit(Field{"backward", "1", "Whether the wheels turn backward to roll forward (1)."}, s.backward);
  }
};

struct State {
  std::array<std::uint64_t, most_levels> taken{}, taken_wheels{};
  std::uint8_t by_wheels = 0;  ///< 1: the wheels' own commands count
  kinematics::PlanarMotion command, setpoint;
  Time command_time;
  double curvature = 0;  ///< of a car, requested while it moved last
  std::uint8_t handover = 0;
  std::vector<WheelState> wheels;
  std::vector<PivotState> pivots;
  Pid loop_x, loop_y, loop_turn;
  kinematics::PlanarPose X_OD;
  double residual_m = 0, power_W = 0, energy_J = 0;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"taken", "1", "Number of velocity commands seen per level."}, s.taken);
    visit(Field{"taken_wheels", "1", "Number of wheel commands seen per level."}, s.taken_wheels);
    visit(Field{"by_wheels", "1", "Whether the wheels' own commands are in force (1)."}, s.by_wheels);
    visit(Field{"command", "", "Velocity command in force."}, s.command);
    visit(Field{"setpoint", "", "Velocity requested from the wheels, on its way to the command."},
          s.setpoint);
    visit(Field{"command_time", "ns", "Time of the last command."}, s.command_time);
    visit(Field{"curvature", "1/m", "Curvature requested while the robot last moved; cars only."},
          s.curvature);
    visit(Field{"handover", "1", "Pending message to the engine after a switch of levels."}, s.handover);
    visit(Field{"wheels", "", "States of the wheels."}, s.wheels);
    visit(Field{"pivots", "", "States of the steering joints."}, s.pivots);
    visit(Field{"loop_x", "1", "PI loop of the speed forward."}, s.loop_x);
    visit(Field{"loop_y", "1", "PI loop of the speed sideways."}, s.loop_y);
    visit(Field{"loop_turn", "1", "PI loop of the turning rate."}, s.loop_turn);
    visit(Field{"odometry", "m", "Odometry of the drive's centre D."}, s.X_OD);
    visit(Field{"residual", "m", "Contradiction between the wheels in the last step."}, s.residual_m);
    visit(Field{"power", "W", "Electrical power drawn now."}, s.power_W);
    visit(Field{"energy", "J", "Electrical energy drawn so far."}, s.energy_J);
  }
};

/// One wheel: its joint, which way round it turns, and who steers it.
struct Wheel {
  JointId joint;
  bool has_joint = true;  ///< false: it is there in thought, on level ideal alone
  bool driven = true;     ///< false: it has no motor and rolls along
  double sign = 1;        ///< +1: a positive angle rolls along its heading
  double max_effort = 1e16, max_speed = 1e16;
  int pivot = -1;          ///< index of the steering joint, -1: fixed
  double heading_rad = 0;  ///< at steering angle 0
  bool has_rollers = false;
  std::string name;
};
struct Pivot {
  JointId joint;
  double sign = 1;                                                          ///< +1: counter-clockwise
  double lower = -1e16, upper = 1e16, max_effort = 1e16, max_speed = 1e16;  ///< counter-clockwise
  double x_m = 0, y_m = 0;                                                  ///< in B
  std::uint32_t link = 0;                                                   ///< that it turns
  std::string name;
};

/// Results of create(), and scratch that every call fills before it reads.
struct Base {
  const char* noun = "";  ///< "a Mecanum drive", for errors
  BodyId body;
  EnergyMeter* energy = nullptr;
  Capabilities engine;
  double dx_m = 0, dy_m = 0;  ///< D in B
  std::vector<Wheel> wheels;
  std::vector<kinematics::Wheel> geometry;  ///< of each, in D; `along` follows the steering
  std::vector<Pivot> pivots;
  std::optional<double> pivot_x_m;           ///< skid steering: see kinematics/wheels.h
  std::optional<kinematics::Ackermann> car;  ///< limits of a car
  std::array<Topic<msg::Twist>*, most_levels> command{};
  std::array<Topic<msg::JointState>*, most_levels> wheel_command{}, wheel_message{};
  maneuver::Topics maneuver;
  std::array<Topic<msg::Odometry>*, most_levels> odometry{};
  std::array<Topic<msg::Int64MultiArray>*, most_levels> ticks{};
  struct Running {
    Winding winding;
    bool on_voltage = false;  ///< the engine integrates the motor; else its command was a speed or a torque
  };
  std::vector<double> turns;
  std::vector<Running> running;
};

// --- building (wheeled_build.cpp) ---

/// Reads one joint, or the joints, that a spec names as steering: their axes stand upright.
Status add_pivots(Base& base, const DeviceBuild& build, std::span<const std::string> names, const char* key);
struct WheelOptions {
  bool driven = true;
  bool across = true;                     ///< the axis must lie across the robot; false: level is enough
  bool ordinary = true;                   ///< it holds across its heading, too
  std::optional<double> roller_rad = {};  ///< of wheels with rollers, where the model has none
};
/// Reads wheels. Those that hang on a pivot are steered by it. Their places are in B until put_frame().
Status add_wheels(Base& base, const DeviceBuild& build, const Common& spec,
                  std::span<const std::string> names, const char* key, const WheelOptions& options);
/// Puts D at this place of B.
void put_frame(Base& base, double x_m, double y_m);
void put_frame_in_the_middle(Base& base);
/// The two sides of a drive that turns by skidding; one without joints is there in thought, at +-track / 2.
struct Sides {
  std::span<const std::string> left_joint, right_joint;
  std::optional<double> track_m, track_ratio;
};
Result<Base> skid_base(const char* noun, const DeviceBuild& build, const Common& spec, const Sides& sides);
/// Checks the geometry and the level, makes topics and the first state.
Status finish(Base& base, State& state, const DeviceBuild& build, const Common& spec, bool has_rollers);
bool fits(const Base& base, const State& state);

// --- running (wheeled_base.cpp, wheeled_power.cpp) ---

/// The only one of the active levels.
inline Level active(std::uint32_t levels) { return static_cast<Level>(std::countr_zero(levels)); }

struct Drive {
  const Common& spec;
  State& state;
  Boxed<maneuver::Late>& late;
  Base& base;
};
void actuate(Drive drive, std::uint32_t levels, const Context& context);
void pre_substep(Drive drive, std::uint32_t levels, const Context& context, double h_s);
void post_substep(Drive drive, std::uint32_t levels, const Context& context, double h_s);
void sense(Drive drive, std::uint32_t levels, const Context& context);
void release(Drive drive, const Context& context);
Status switch_level(Drive drive, std::uint32_t before, std::uint32_t after, const Context& context);
Status check_levels(const Base& base, std::uint32_t levels);

}  // namespace sandlot::wheeled
