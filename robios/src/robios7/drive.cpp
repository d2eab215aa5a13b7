#include <cmath>

#include "../functions.h"

using namespace robios;

namespace {

double m(int mm) { return mm * 1e-3; }
double rad(int degrees_) { return degrees_ * radians_per_degree; }

int begin(const ManeuverOrder& maneuver) {
  if (!has_drive()) return failed;
  begin_maneuver(maneuver);
  return ok;
}

int done() { return machine.robot().drive == Drive::none ? -1 : maneuver_done() ? 1 : 0; }
int remain() { return to_int(last_was_turn() ? remaining_rad() / radians_per_degree : remaining_m() * 1e3); }
int wait() {
  if (!has_drive()) return failed;
  await_maneuver();
  return ok;
}

}  // namespace

extern "C" {

int VWSetSpeed(int linear, int angular) {
  enter(Call::VWSetSpeed);
  if (!has_drive()) return failed;
  set_speed(m(linear), rad(angular));
  return ok;
}

int VWGetSpeed(int* linear, int* angular) {
  enter(Call::VWGetSpeed);
  if (!has_drive()) return failed;
  set(linear, to_int(machine.senses().v_mps * 1e3));
  set(angular, to_int(machine.senses().w_radps / radians_per_degree));
  return ok;
}

int VWSetPosition(int x, int y, int phi) {
  enter(Call::VWSetPosition);
  if (!has_drive()) return failed;
  order(OrderKind::set_pose, PoseOrder{m(x), m(y), rad(phi)});
  expect_pose(m(x), m(y), wrap(rad(phi)));
  return ok;
}

int VWGetPosition(int* x, int* y, int* phi) {
  enter(Call::VWGetPosition);
  const PoseOrder pose = odometry();
  set(x, to_int(pose.x_m * 1e3));
  set(y, to_int(pose.y_m * 1e3));
  set(phi, degrees(pose.phi_rad));
  return has_drive() ? ok : failed;
}

int VWStraight(int distance, int speed) {
  enter(Call::VWStraight);
  return begin({straight, 0, m(distance), 0, 0, 0, std::abs(m(speed)), 0});
}

int VWTurn(int angle, int speed) {
  enter(Call::VWTurn);
  return begin({turn, 0, 0, rad(angle), 0, 0, 0, std::abs(rad(speed))});
}

int VWCurve(int distance, int angle, int speed) {
  enter(Call::VWCurve);
  return begin({curve, 0, m(distance), rad(angle), 0, 0, std::abs(m(speed)), 0});
}

int VWDrive(int dx, int dy, int speed) {
  enter(Call::VWDrive);
  if (std::int64_t{dx} <= std::llabs(std::int64_t{dy})) return failed;
  return begin({to_point, 0, 0, 0, m(dx), m(dy), std::abs(m(speed)), 0});
}

int VWRemain() {
  enter(Call::VWRemain);
  return remain();
}
int VWDriveRemain() {
  enter(Call::VWDriveRemain);
  return remain();
}

int VWDone() {
  enter(Call::VWDone);
  return done();
}
int VWDriveDone() {
  enter(Call::VWDriveDone);
  return done();
}

int VWWait() {
  enter(Call::VWWait);
  return wait();
}
int VWDriveWait() {
  enter(Call::VWDriveWait);
  return wait();
}

int VWStalled() {
  enter(Call::VWStalled);
  return stalled_motors() & 3;
}

int VWControl(int Vv, int Tv, int Vw, int Tw) {
  enter(Call::VWControl);
  if (!has_drive() || Vv < 0 || Tv < 0 || Vw < 0 || Tw < 0) return failed;
  order(OrderKind::control, ControlOrder{1, 0, Vv / 100.0, Tv / 100.0, Vw / 100.0, Tw / 100.0});
  return ok;
}

int VWControlOff() {
  enter(Call::VWControlOff);
  if (!has_drive()) return failed;
  order(OrderKind::control, ControlOrder{0, 0, 0, 0, 0, 0});
  return ok;
}

}  // extern "C"
