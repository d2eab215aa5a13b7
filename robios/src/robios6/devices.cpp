#include <algorithm>
#include <array>
#include <cmath>

#include "api.h"

using namespace robios;

namespace {

// Distance sensors: a bit each; 31 at most.
unsigned distances_given = 0, distances_on = 0;
bool repeats = false;
std::array<std::uint32_t, most_distances> count_at_start{};

unsigned motors_given = 0, encoders_given = 0, servos_given = 0, bumpers_given = 0;
std::array<std::int64_t, most_motors> zero{}, way_zero{};

/// Index of a handle that was given out; -1: it was not.
int index_of_handle(unsigned given, int handle) {
  return handle >= 1 && handle <= 32 && (given >> (handle - 1) & 1) ? handle - 1 : -1;
}
int give(unsigned& given, int index) {
  if (index < 0 || index > 31) return 0;
  given |= 1u << index;
  return index + 1;
}
int release(unsigned& given, int handle) {
  const int index = index_of_handle(given, handle);
  if (index < 0) return bad_handle;
  given &= ~(1u << index);
  return ok;
}

int psd_index(PSDHandle handle) {
  const auto bits = static_cast<unsigned>(handle);
  if (bits == 0 || (bits & (bits - 1)) || !(bits & distances_given)) return -1;
  int index = 0;
  while (!(bits >> index & 1)) index++;
  return index;
}

bool all_measured() {
  for (std::size_t i = 0; i < 31; i++) {
    if ((distances_on >> i & 1) && machine.senses().distance_count[i] == count_at_start[i]) return false;
  }
  return true;
}

enum class Compass { none, off, once, cycle } compass = Compass::none;

double ticks(int index) { return static_cast<double>(machine.senses().encoder_ticks[index]); }

}  // namespace

extern "C" {

// Distances

PSDHandle PSDInit(DeviceSemantics semantics) {
  enter(Call::PSDInit);
  const int index = find_distance(semantics);
  if (index < 0 || index > 30) return 0;
  distances_given |= 1u << index;
  return 1 << index;
}
int PSDRelease() {
  enter(Call::PSDRelease);
  distances_given = distances_on = 0;
  return ok;
}
int PSDStart(PSDHandle handles, BOOL cycle) {
  enter(Call::PSDStart);
  const auto bits = static_cast<unsigned>(handles);
  if (bits == 0 || (bits & ~distances_given)) return bad_handle;
  if (distances_on != 0 && !repeats && !all_measured()) return 1;
  distances_on = bits;
  repeats = cycle != 0;
  std::copy_n(machine.senses().distance_count, most_distances, count_at_start.begin());
  return ok;
}
int PSDStop() {
  enter(Call::PSDStop);
  distances_on = 0;
  return ok;
}
BOOL PSDCheck() {
  enter(Call::PSDCheck);
  return distances_on != 0 && all_measured();
}
int PSDGet(PSDHandle handle) {
  enter(Call::PSDGet);
  const int index = psd_index(handle);
  if (index < 0) return PSD_OUT_OF_RANGE;
  // Nothing yet: the first measurement that was started is under way.
  if (machine.senses().distance_count[index] == 0 && (distances_on >> index & 1)) return 0;
  return distance_mm(index);
}
int PSDGetRaw(PSDHandle handle) {
  enter(Call::PSDGetRaw);
  return distance_raw(psd_index(handle));
}

// Motors, encoders, servos

MotorHandle MOTORInit(DeviceSemantics semantics) {
  enter(Call::MOTORInit);
  return give(motors_given, find_motor(semantics));
}
int MOTORDrive(MotorHandle handle, int speed) {
  enter(Call::MOTORDrive);
  const int index = index_of_handle(motors_given, handle);
  if (index < 0 || speed < -100 || speed > 100) return bad_handle;
  drive_motor(index, 0, speed / 100.0);
  return ok;
}
int MOTORRelease(MotorHandle handle) {
  enter(Call::MOTORRelease);
  const int index = index_of_handle(motors_given, handle);
  if (index < 0) return bad_handle;
  drive_motor(index, 0, 0);
  return release(motors_given, handle);
}

QuadHandle QUADInit(DeviceSemantics semantics) {
  enter(Call::QUADInit);
  const int index = machine.robot().ticks_per_turn > 0 ? find_motor(semantics) : -1;
  if (index >= 0) {
    zero[static_cast<std::size_t>(index)] = way_zero[static_cast<std::size_t>(index)] =
        machine.senses().encoder_ticks[index];
  }
  return give(encoders_given, index);
}
int QUADRead(QuadHandle handle) {
  enter(Call::QUADRead);
  const int index = index_of_handle(encoders_given, handle);
  if (index < 0) return 0;
  return static_cast<int>(machine.senses().encoder_ticks[index] - zero[static_cast<std::size_t>(index)]);
}
int QUADReset(QuadHandle handle) {
  enter(Call::QUADReset);
  const int index = index_of_handle(encoders_given, handle);
  if (index < 0) return bad_handle;
  zero[static_cast<std::size_t>(index)] = machine.senses().encoder_ticks[index];
  return ok;
}
int QUADRelease(QuadHandle handle) {
  enter(Call::QUADRelease);
  return release(encoders_given, handle);
}
DeviceSemantics QUADGetMotor(DeviceSemantics semantics) {
  enter(Call::QUADGetMotor);
  if (semantics > QUAD_RIGHT || semantics < QUAD_BACKRIGHT) return 0;
  return semantics + MOTOR_RIGHT - QUAD_RIGHT;
}
float QUADODORead(QuadHandle handle) {
  enter(Call::QUADODORead);
  const int index = index_of_handle(encoders_given, handle);
  const Robot& r = machine.robot();
  if (index < 0 || r.ticks_per_turn == 0) return 0;
  const double turns = (ticks(index) - static_cast<double>(way_zero[static_cast<std::size_t>(index)])) /
                       r.ticks_per_turn;
  return static_cast<float>(turns * pi * r.wheel_diameter_m);
}
int QUADODOReset(QuadHandle handle) {
  enter(Call::QUADODOReset);
  const int index = index_of_handle(encoders_given, handle);
  if (index < 0) return bad_handle;
  way_zero[static_cast<std::size_t>(index)] = machine.senses().encoder_ticks[index];
  return ok;
}

ServoHandle SERVOInit(DeviceSemantics semantics) {
  enter(Call::SERVOInit);
  return give(servos_given, find_servo(semantics));
}
int SERVOSet(ServoHandle handle, int angle) {
  enter(Call::SERVOSet);
  const int index = index_of_handle(servos_given, handle);
  if (index < 0 || angle < 0 || angle > 255) return bad_handle;
  order(OrderKind::servo, MotorOrder{static_cast<std::uint32_t>(index), 0, angle / 255.0});
  return ok;
}
int SERVORelease(ServoHandle handle) {
  enter(Call::SERVORelease);
  return release(servos_given, handle);
}

// Bumpers, infrared switches, compass

BumpHandle BUMPInit(DeviceSemantics semantics) {
  enter(Call::BUMPInit);
  return give(bumpers_given, find_bumper(semantics));
}
int BUMPCheck(BumpHandle handle, int* timestamp) {
  enter(Call::BUMPCheck);
  const int index = index_of_handle(bumpers_given, handle);
  if (index < 0 || !machine.senses().bumper[index]) return -1;
  set(timestamp, static_cast<int>((machine.senses().now_ns - machine.start_ns) / (10 * millisecond)));
  return 0;
}
int BUMPRelease(BumpHandle handle) {
  enter(Call::BUMPRelease);
  return release(bumpers_given, handle);
}
IRHandle IRInit(DeviceSemantics semantics) {
  enter(Call::IRInit);
  return give(bumpers_given, find_bumper(semantics));
}
int IRRead(IRHandle handle) {
  enter(Call::IRRead);
  const int index = index_of_handle(bumpers_given, handle);
  if (index < 0) return -1;
  return machine.senses().bumper[index] ? 1 : 0;
}
int IRRelease(IRHandle handle) {
  enter(Call::IRRelease);
  return release(bumpers_given, handle);
}

int COMPASSInit(DeviceSemantics) {
  enter(Call::COMPASSInit);
  if (!machine.robot().has_compass) return failed;
  compass = Compass::off;
  return ok;
}
int COMPASSStart(BOOL cycle) {
  enter(Call::COMPASSStart);
  if (compass == Compass::none || compass == Compass::cycle) return failed;
  compass = cycle ? Compass::cycle : Compass::once;
  return ok;
}
int COMPASSCheck() {
  enter(Call::COMPASSCheck);
  return compass == Compass::once || compass == Compass::cycle ? 1 : 0;
}
int COMPASSStop() {
  enter(Call::COMPASSStop);
  if (compass == Compass::none) return failed;
  compass = Compass::off;
  return ok;
}
int COMPASSRelease() {
  enter(Call::COMPASSRelease);
  if (compass == Compass::none) return failed;
  compass = Compass::none;
  return ok;
}
int COMPASSGet() {
  enter(Call::COMPASSGet);
  if (compass != Compass::once && compass != Compass::cycle) return -1;
  return ((360 - degrees(machine.senses().compass_rad)) % 360 + 360) % 360;
}
int COMPASSCalibrate(int) {
  enter(Call::COMPASSCalibrate);
  return compass == Compass::none ? failed : ok;
}

}  // extern "C"
