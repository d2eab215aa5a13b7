#pragma once
/// Shared memory between the simulator and a robot's RoBIOS program: what the robot senses goes in, what it orders comes out,
/// once per time slot. Both sides of it are built from this header: programs/robios and the libraries robios6 and robios7.
///
/// Turns     `turn` says whose the memory is. The simulator writes `senses`, sets it to `program` and wakes the program by a
///           futex; the program runs until its virtual time reaches `senses.slot_end_ns`, or it waits for something; it appends
///           its orders, sets `turn` to `simulator` and wakes the simulator. Neither side touches the memory in the other's turn.
/// Time      nanoseconds of simulated time. The program's clock begins at `senses.now_ns` of its first turn.
/// Orders    records of OrderHead, payload, zeros up to a multiple of 8; in the order of the calls.
/// Trust     the simulator believes nothing that it finds here: sizes, kinds and numbers are checked before use.
/// Layout    plain integers and IEEE numbers of the machine; fixed by static_assert, changed together with `protocol`.
#include <atomic>
#include <cstddef>
#include <cstdint>

namespace sandlot::robios {

inline constexpr std::uint32_t protocol = 1;
/// Environment of the program: number of the descriptor of the shared memory.
inline constexpr const char* descriptor_variable = "SANDLOT_ROBIOS_FD";

inline constexpr std::size_t most_distances = 32;  ///< psd
inline constexpr std::size_t most_beams = 3600;    ///< of the lidar
inline constexpr std::size_t most_motors = 16;     ///< with an encoder each
inline constexpr std::size_t most_servos = 32;
inline constexpr std::size_t most_bumpers = 16;
inline constexpr std::size_t most_key_presses = 16;  ///< kept
inline constexpr std::size_t most_radio_messages = 64;
inline constexpr std::size_t most_radio_bytes = 1024;
inline constexpr std::size_t most_entities = 1024;  ///< that a supervisor sees
inline constexpr std::size_t most_peers = 256;      ///< other robots with a radio
inline constexpr std::size_t most_image_bytes = 2592u * 1944u * 3u;
inline constexpr std::size_t most_order_bytes = 4u << 20;
inline constexpr std::size_t name_size = 32;  ///< with the 0 at the end

enum class Turn : std::uint32_t { simulator = 0, program = 1, ended = 2 };

enum class Drive : std::uint32_t { none, differential, ackermann, omni };

/// What does not change while the program runs.
struct Robot {
  char name[name_size];  ///< of the robot
  char type[name_size];  ///< of its model
  std::uint32_t id;      ///< from 1, in the order of the scenario; also its radio's id
  Drive drive;
  std::uint32_t motors, servos, distances, bumpers;
  std::uint32_t ticks_per_turn;  ///< of the encoders; 0: none
  std::uint32_t has_camera, has_lidar, has_radio, has_keys, has_screen, has_speaker, has_compass, has_battery;
  std::uint32_t screen_width, screen_height;
  std::uint32_t delays;      ///< 0: calls cost no virtual time
  std::uint32_t supervisor;  ///< 1: SIM... calls may look at and move the world
  double wheel_diameter_m, track_m, max_speed_mps, max_turning_rate_radps, max_motor_radps;
  double slot_s;                                   ///< T
  char distance_names[most_distances][name_size];  ///< "PSD_FRONT"
  std::int32_t distance_numbers[most_distances];   ///< as the robot's file gives them; from 1
  char motor_names[most_motors][name_size];        ///< of the joints or wheels, in the order of the drive
  char servo_names[most_servos][name_size];
  char bumper_names[most_bumpers][name_size];
};

struct KeyPress {
  std::uint32_t key;  ///< number from 1; 0: the screen was touched
  std::int32_t x, y;  ///< [px] of the touch
};

struct RadioMessage {
  std::uint32_t from;  ///< id of the sender
  std::uint32_t size;
  std::uint8_t bytes[most_radio_bytes];
};

/// A robot or object, in the world.
struct EntityPose {
  std::uint32_t id;  ///< from 1, robots and objects in one sequence
  std::uint32_t is_robot;
  double x_m, y_m, z_m, phi_rad;
};

/// What the robot senses, as of `now_ns`.
struct Senses {
  std::int64_t now_ns, slot_end_ns;
  std::int64_t wall_ns;  ///< real time since the run began; input from outside
  // Odometry and drive.
  double x_m, y_m, phi_rad, v_mps, w_radps;
  std::uint64_t maneuvers;  ///< begun so far, see DriveProgress
  std::uint32_t maneuver_done;
  std::uint32_t stalled;  ///< a bit per motor, the first is 1
  double remaining_m, remaining_rad;
  std::int64_t encoder_ticks[most_motors];
  // Sensors. A negative or infinite distance: nothing in range.
  double distance_m[most_distances];
  std::uint32_t distance_count[most_distances];  ///< samples so far
  std::uint32_t beams;                           ///< of the lidar, from the right behind counter-clockwise
  std::uint32_t lidar_count;
  double lidar_first_rad, lidar_step_rad;  ///< angle of the first beam from straight ahead, counter-clockwise
  float beam_m[most_beams];
  std::uint32_t bumper[most_bumpers];  ///< 1: touched
  double compass_rad;                  ///< heading, counter-clockwise from x of the world
  double battery_V;
  std::uint64_t key_presses;  ///< so far; the last of `key` has this number
  std::uint32_t keys;         ///< in `key`, the oldest first
  std::uint32_t speaker_busy;
  KeyPress key[most_key_presses];
  std::uint32_t peers;  ///< ids of other robots with a radio
  std::uint32_t peer[most_peers];
  std::uint32_t radio_messages;  ///< that came since the turn before
  std::uint32_t radio_dropped;   ///< of them, those that found no room here
  RadioMessage radio[most_radio_messages];
  std::uint32_t entities;  ///< only of a supervisor
  std::uint32_t reserved;
  EntityPose entity[most_entities];
  // Camera: red, green, blue, row by row from the top.
  std::uint32_t image_width, image_height;  ///< 0: none yet
  std::uint64_t image_count;                ///< pictures so far
  std::int64_t image_time_ns;
  std::uint8_t image[most_image_bytes];
};

enum class OrderKind : std::uint32_t {
  speed,       ///< SpeedOrder
  maneuver,    ///< ManeuverOrder
  set_pose,    ///< PoseOrder: of the odometry
  control,     ///< ControlOrder
  motor,       ///< MotorOrder
  servo,       ///< MotorOrder; value: position from 0 to 1
  screen,      ///< ScreenOrder, then width * height * 3 bytes
  text,        ///< ScreenText: four menu labels and the lines, each ended by a 0
  sound,       ///< SoundOrder, then the name
  radio,       ///< RadioOrder, then the bytes
  set_entity,  ///< EntityPose: a supervisor moves a robot or object
  picture,     ///< no payload: the camera shall take one
  wait,        ///< WaitOrder: the last order of a turn
  note,        ///< text for the log
  finished,    ///< std::int32_t: exit code. The program has ended
};

struct OrderHead {
  OrderKind kind;
  std::uint32_t size;  ///< of the payload, without the zeros behind it
};
struct SpeedOrder {
  double v_mps, w_radps;
};
struct ManeuverOrder {
  std::uint32_t kind, reserved;  ///< a constant of DriveManeuver
  double distance_m, angle_rad, x_m, y_m, speed_mps, turning_rate_radps;
};
struct PoseOrder {
  double x_m, y_m, phi_rad;
};
struct ControlOrder {
  std::uint32_t on, reserved;
  double vv, tv, vw, tw;
};
struct MotorOrder {
  std::uint32_t number;  ///< from 0
  std::uint32_t
      mode;  ///< 0: value is the share of the full voltage or speed, -1 to 1; 1: value is a speed in rad/s
  double value;
};
struct ScreenOrder {
  std::uint32_t x, y, width, height;
};
struct SoundOrder {
  double frequency_Hz, duration_s;
};
struct RadioOrder {
  std::uint32_t to;  ///< id; 0: all
  std::uint32_t size;
};
/// When the program wants its next turn: at a time at the latest, or as soon as one of the events has come.
struct WaitOrder {
  std::int64_t until_ns;
  std::uint32_t events;  ///< bits of WakeEvent
  std::uint32_t reserved;
};
enum WakeEvent : std::uint32_t { wake_key = 1, wake_radio = 2, wake_drive_done = 4, wake_picture = 8 };

struct Memory {
  std::uint32_t protocol;  ///< of the simulator
  std::uint32_t size;      ///< sizeof(Memory) of the simulator
  std::atomic<std::uint32_t> turn;
  std::uint32_t order_bytes;  ///< in `orders`
  Robot robot;
  Senses senses;
  alignas(8) std::byte orders[most_order_bytes];
};
static_assert(std::atomic<std::uint32_t>::is_always_lock_free);

}  // namespace sandlot::robios
