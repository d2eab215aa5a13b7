#pragma once
/// Devices of the robot in SI units, as both generations of RoBIOS use them.
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "machine.h"

namespace robios {

inline constexpr double pi = 3.14159265358979323846;
inline constexpr double radians_per_degree = pi / 180;
inline constexpr int out_of_range_mm = 9999;

/// Nearest int; the largest or smallest of them for what is beyond, 0 for what is no number.
int to_int(double value);
/// Angle in (-pi, pi].
double wrap(double angle_rad);
/// Angle in degrees, in [-180, 180].
int degrees(double angle_rad);

// Keys: bits, the first key is 1.
std::uint32_t take_key();
std::uint32_t await_key(std::uint32_t mask);
std::optional<KeyPress> take_touch();
KeyPress await_touch();

// Drive.
bool has_drive();
void set_speed(double v_mps, double w_radps);
/// Pose of the odometry, as set in this turn or measured.
PoseOrder odometry();
void expect_pose(double x_m, double y_m, double phi_rad);
void begin_maneuver(const ManeuverOrder& maneuver);
bool maneuver_done();
void await_maneuver();
double remaining_m();    ///< without a sign
double remaining_rad();  ///< without a sign
bool last_was_turn();
/// Kinds of maneuvers, as DriveManeuver has them.
inline constexpr std::uint32_t straight = 0, turn = 1, curve = 2, to_point = 3;

// Sensors and motors, by index. Reading none: out of range, 0.
int distance_mm(int index);
int distance_raw(int index);
int distance_index(int number);
int index_of(const char (*names)[name_size], std::size_t count, std::string_view name);
void drive_motor(int index, std::uint32_t mode, double value);
int stalled_motors();  ///< bits
double battery_V();
int battery_level();  ///< of a converter of 10 bits, 1023 for 12 V

// Camera: width and height of the picture that a program wants; false: there is none.
bool take_picture();
/// The latest picture, scaled (box filter when smaller, nearest pixel when larger) to width x height, red, green, blue.
void copy_picture(std::uint8_t* rgb, int width, int height);

// Sound.
void play(double frequency_Hz, double duration_s, std::string_view name);
bool silent();

// Radio.
bool send_message(std::uint32_t to, const void* bytes, std::size_t size);
Message await_message();

/// Entities: the robots or the others, by number; nullptr: none.
const EntityPose* entity(int id, bool robot);
int entities(bool robots);

}  // namespace robios
