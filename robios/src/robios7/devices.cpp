#include <algorithm>
#include <array>
#include <cmath>

#include "../functions.h"

using namespace robios;

namespace {

// LIDARGet: `points` values over `range` degrees.
int range_deg = 360, points = 360;

struct Servo {
  int low = 0, high = 255;
};
std::array<Servo, most_servos> servos;
std::array<std::int64_t, most_motors> encoder_zero{};

bool is_motor(int motor) {
  return motor >= 1 && motor <= static_cast<int>(std::min<std::size_t>(machine.robot().motors, most_motors));
}
bool is_servo(int servo) {
  return servo >= 1 && servo <= static_cast<int>(std::min<std::size_t>(machine.robot().servos, most_servos));
}

int drive(int motor, int speed) {
  if (!is_motor(motor) || speed < -100 || speed > 100) return failed;
  drive_motor(motor - 1, 0, speed / 100.0);
  return ok;
}

void move_servo(int servo, double position) {
  order(OrderKind::servo, MotorOrder{static_cast<std::uint32_t>(servo - 1), 0, position});
}

/// Distance in a direction, from straight ahead counter-clockwise.
int beam_mm(double angle_rad) {
  const Senses& s = machine.senses();
  const std::size_t beams = std::min<std::size_t>(s.beams, most_beams);
  if (beams == 0 || !(s.lidar_step_rad > 0)) return out_of_range_mm;
  double offset = std::fmod(angle_rad - s.lidar_first_rad, 2 * pi);
  if (offset < 0) offset += 2 * pi;
  auto at = static_cast<std::int64_t>(std::llround(offset / s.lidar_step_rad));
  // Behind the last beam of a full circle comes the first one; a partial scan has no more.
  const auto turn_beams = static_cast<std::int64_t>(std::llround(2 * pi / s.lidar_step_rad));
  if (turn_beams > 0) at %= turn_beams;
  if (at >= static_cast<std::int64_t>(beams)) return out_of_range_mm;
  const double m = static_cast<double>(s.beam_m[at]);
  return m >= 0 && m < out_of_range_mm * 1e-3 ? to_int(m * 1e3) : out_of_range_mm;
}

int scan(int* distance) {
  if (!distance) return failed;
  for (int i = 0; i < points; i++) {
    const double ahead = points / 2 - i;  // steps to the left
    distance[i] = beam_mm(ahead * range_deg / points * radians_per_degree);
  }
  if (machine.robot().has_lidar) return ok;
  note_once("lidar", "the program scans, and the robot has no lidar");
  return failed;
}

}  // namespace

extern "C" {

int PSDGet(int psd) {
  enter(Call::PSDGet);
  return distance_mm(distance_index(psd));
}
int PSDGetRaw(int psd) {
  enter(Call::PSDGetRaw);
  return distance_raw(distance_index(psd));
}

int LIDARGet(int distance[]) {
  enter(Call::LIDARGet);
  return scan(distance);
}
int SIMLaserScan(int distance[]) {
  enter(Call::SIMLaserScan);
  return scan(distance);
}
int LIDARSet(int range, int tilt, int number) {
  enter(Call::LIDARSet);
  if (range < 1 || range > 360 || number < 1 || number > static_cast<int>(most_beams)) return failed;
  if (tilt != 0) {
    note_once("tilt", "LIDARSet: the lidar does not tilt");
    return failed;
  }
  range_deg = range;
  points = number;
  return ok;
}

int SERVOSet(int servo, int angle) {
  enter(Call::SERVOSet);
  if (!is_servo(servo) || angle < 0 || angle > 255) return failed;
  const Servo& s = servos[static_cast<std::size_t>(servo - 1)];
  move_servo(servo, (s.low + (s.high - s.low) * angle / 255.0) / 255);
  return ok;
}
int SERVOSetRaw(int servo, int value) {
  enter(Call::SERVOSetRaw);
  if (!is_servo(servo) || value < 0 || value > 255) return failed;
  move_servo(servo, value / 255.0);
  return ok;
}
int SERVORange(int servo, int low, int high) {
  enter(Call::SERVORange);
  if (!is_servo(servo) || low < 0 || high > 255 || low > high) return failed;
  servos[static_cast<std::size_t>(servo - 1)] = {low, high};
  return ok;
}

int MOTORDrive(int motor, int speed) {
  enter(Call::MOTORDrive);
  return drive(motor, speed);
}
int MOTORDriveRaw(int motor, int speed) {
  enter(Call::MOTORDriveRaw);
  return drive(motor, speed);
}
int MOTORPID(int motor, int p, int i, int d) {
  enter(Call::MOTORPID);
  const auto fits = [](int gain) { return gain >= 0 && gain <= 255; };
  return is_motor(motor) && fits(p) && fits(i) && fits(d) ? ok : failed;
}
int MOTORPIDOff(int motor) {
  enter(Call::MOTORPIDOff);
  return is_motor(motor) ? ok : failed;
}
int MOTORSpeed(int motor, int ticks) {
  enter(Call::MOTORSpeed);
  const std::uint32_t per_turn = machine.robot().ticks_per_turn;
  if (!is_motor(motor) || per_turn == 0) return failed;
  drive_motor(motor - 1, 1, ticks * 100.0 / per_turn * 2 * pi);
  return ok;
}

int ENCODERRead(int motor) {
  enter(Call::ENCODERRead);
  if (!is_motor(motor)) return 0;
  return static_cast<int>(machine.senses().encoder_ticks[motor - 1] -
                          encoder_zero[static_cast<std::size_t>(motor - 1)]);
}
int ENCODERReset(int motor) {
  enter(Call::ENCODERReset);
  if (!is_motor(motor)) return failed;
  encoder_zero[static_cast<std::size_t>(motor - 1)] = machine.senses().encoder_ticks[motor - 1];
  return ok;
}

}  // extern "C"
