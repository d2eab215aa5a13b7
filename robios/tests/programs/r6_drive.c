#include "eyebot.h"

#include "check.h"

int main() {
  PositionType p;
  SpeedType v;
  VWHandle vw;
  int start;
  EQUAL(VWDriveStraight(1, 0.5, 0.2), -1); /* nothing initialised */
  EQUAL(VWInit(VW_DRIVE, 0), 0);
  vw = VWInit(VW_DRIVE, 1);
  CHECK(vw != 0);
  EQUAL(VWInit(VW_DRIVE, 1), 0); /* only one */
  EQUAL(VWStartControl(vw, 7, 0.3, 10, 0.1), 0);
  EQUAL(VWSetPosition(vw, 1, 2, M_PI / 2), 0);
  EQUAL(VWGetPosition(vw, &p), 0);
  EQUAL(p.x, 1);
  NEAR(p.phi, M_PI / 2, 1e-6);
  start = OSGetCount();
  EQUAL(VWDriveStraight(vw, 0.5, 0.25), 0);
  EQUAL(VWDriveDone(vw), 0);
  EQUAL(VWDriveReady(vw), 0);
  EQUAL(VWDriveRemain(vw), 0.5);
  OSWait(105);
  NEAR(VWDriveRemain(vw), 0.25, 0.02);
  EQUAL(VWDriveWait(vw), 0);
  EQUAL(VWDriveDone(vw), 1);
  EQUAL(VWDriveReady(vw), 1);
  NEAR(OSGetCount() - start, 200, 10);
  VWGetPosition(vw, &p);
  NEAR(p.y, 2.5, 1e-5);
  EQUAL(VWDriveTurn(vw, -M_PI / 2, 1), 0);
  NEAR(VWDriveRemain(vw), M_PI / 2, 1e-5);
  VWDriveWait(vw);
  VWGetPosition(vw, &p);
  NEAR(p.phi, 0, 1e-5);
  EQUAL(VWDriveCurve(vw, M_PI / 2, M_PI / 2, 0.5), 0); /* radius 1 */
  VWDriveWait(vw);
  VWGetPosition(vw, &p);
  NEAR(p.x, 2, 1e-5);
  NEAR(p.y, 3.5, 1e-5);
  EQUAL(VWSetSpeed(vw, 0.1, -0.2), 0);
  OSWait(20);
  EQUAL(VWGetSpeed(vw, &v), 0);
  NEAR(v.v, 0.1, 1e-6);
  NEAR(v.w, -0.2, 1e-6);
  EQUAL(VWStalled(vw), 1);
  EQUAL(VWStalled(7), -1);
  EQUAL(VWStopControl(vw), 0);
  EQUAL(VWRelease(vw), 0);
  EQUAL(VWRelease(vw), -1);
  EQUAL(VWDriveDone(vw), -1);
  EQUAL(VWDriveWait(vw), -1);
  EQUAL(VWSetSpeed(vw, 0.1, 0), -1);
  return failures;
}
