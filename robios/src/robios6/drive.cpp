#include <cmath>

#include "api.h"

using namespace robios;

namespace {

bool given = false;  // the one handle, 1

bool good(VWHandle handle) { return given && handle == 1; }

int begin(VWHandle handle, const ManeuverOrder& maneuver) {
  if (!good(handle)) return bad_handle;
  begin_maneuver(maneuver);
  return ok;
}

int done(VWHandle handle) { return good(handle) ? maneuver_done() : bad_handle; }

}  // namespace

extern "C" {

VWHandle VWInit(DeviceSemantics, int timescale) {
  enter(Call::VWInit);
  if (timescale < 1 || given || !has_drive()) return 0;
  given = true;
  return 1;
}
int VWRelease(VWHandle handle) {
  enter(Call::VWRelease);
  if (!good(handle)) return bad_handle;
  set_speed(0, 0);
  given = false;
  return ok;
}

int VWSetSpeed(VWHandle handle, meterPerSec v, radPerSec w) {
  enter(Call::VWSetSpeed);
  if (!good(handle)) return bad_handle;
  set_speed(static_cast<double>(v), static_cast<double>(w));
  return ok;
}
int VWGetSpeed(VWHandle handle, SpeedType* vw) {
  enter(Call::VWGetSpeed);
  if (!good(handle) || !vw) return bad_handle;
  vw->v = static_cast<float>(machine.senses().v_mps);
  vw->w = static_cast<float>(machine.senses().w_radps);
  return ok;
}
int VWSetPosition(VWHandle handle, meter x, meter y, radians phi) {
  enter(Call::VWSetPosition);
  if (!good(handle)) return bad_handle;
  const PoseOrder pose{static_cast<double>(x), static_cast<double>(y), wrap(static_cast<double>(phi))};
  order(OrderKind::set_pose, pose);
  expect_pose(pose.x_m, pose.y_m, pose.phi_rad);
  return ok;
}
int VWGetPosition(VWHandle handle, PositionType* position) {
  enter(Call::VWGetPosition);
  if (!good(handle) || !position) return bad_handle;
  const PoseOrder pose = odometry();
  position->x = static_cast<float>(pose.x_m);
  position->y = static_cast<float>(pose.y_m);
  position->phi = static_cast<float>(wrap(pose.phi_rad));
  return ok;
}

int VWStartControl(VWHandle handle, float Vv, float Tv, float Vw, float Tw) {
  enter(Call::VWStartControl);
  if (!good(handle)) return bad_handle;
  order(OrderKind::control, ControlOrder{1, 0, static_cast<double>(Vv), static_cast<double>(Tv),
                                         static_cast<double>(Vw), static_cast<double>(Tw)});
  return ok;
}
int VWStopControl(VWHandle handle) {
  enter(Call::VWStopControl);
  if (!good(handle)) return bad_handle;
  order(OrderKind::control, ControlOrder{0, 0, 0, 0, 0, 0});
  return ok;
}

int VWDriveStraight(VWHandle handle, meter delta, meterPerSec v) {
  enter(Call::VWDriveStraight);
  return begin(handle,
               {straight, 0, static_cast<double>(delta), 0, 0, 0, std::abs(static_cast<double>(v)), 0});
}
int VWDriveTurn(VWHandle handle, radians delta, radPerSec w) {
  enter(Call::VWDriveTurn);
  return begin(handle, {turn, 0, 0, static_cast<double>(delta), 0, 0, 0, std::abs(static_cast<double>(w))});
}
int VWDriveCurve(VWHandle handle, meter delta_l, radians delta_phi, meterPerSec v) {
  enter(Call::VWDriveCurve);
  return begin(handle, {curve, 0, static_cast<double>(delta_l), static_cast<double>(delta_phi), 0, 0,
                        std::abs(static_cast<double>(v)), 0});
}

float VWDriveRemain(VWHandle handle) {
  enter(Call::VWDriveRemain);
  if (!good(handle)) return 0;
  return static_cast<float>(last_was_turn() ? remaining_rad() : remaining_m());
}
int VWDriveDone(VWHandle handle) {
  enter(Call::VWDriveDone);
  return done(handle);
}
int VWDriveReady(VWHandle handle) {
  enter(Call::VWDriveReady);
  return done(handle);
}
int VWDriveWait(VWHandle handle) {
  enter(Call::VWDriveWait);
  if (!good(handle)) return bad_handle;
  await_maneuver();
  return ok;
}
int VWStalled(VWHandle handle) {
  enter(Call::VWStalled);
  if (!good(handle)) return bad_handle;
  return stalled_motors() != 0 ? 1 : 0;
}

}  // extern "C"
