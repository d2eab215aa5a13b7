#include "eyebot.h"

#include "check.h"

int main() {
  int x, y, phi, v, w, count;
  EQUAL(VWGetPosition(&x, &y, &phi), 0);
  EQUAL(x, 0);
  EQUAL(VWSetPosition(1000, -500, 450), 0);
  VWGetPosition(&x, &y, &phi); /* in the same time slot */
  EQUAL(x, 1000);
  EQUAL(y, -500);
  EQUAL(phi, 90);
  EQUAL(VWStraight(-300, 200), 0);
  EQUAL(VWDone(), 0);
  EQUAL(VWRemain(), 300);
  EQUAL(VWDriveRemain(), 300);
  count = OSGetCount();
  EQUAL(VWWait(), 0);
  NEAR(OSGetCount() - count, 1500, 100); /* 300 mm at 200 mm/s, and up to two slots */
  EQUAL(VWDone(), 1);
  EQUAL(VWDriveDone(), 1);
  EQUAL(VWRemain(), 0);
  VWGetPosition(&x, &y, &phi);
  EQUAL(x, 1000);
  EQUAL(y, -800);
  EQUAL(VWTurn(-180, 90), 0);
  OSWait(1050);
  CHECK(VWRemain() > 70 && VWRemain() < 110);
  EQUAL(VWDriveWait(), 0);
  VWGetPosition(0, 0, &phi);
  EQUAL(phi, -90);
  EQUAL(VWCurve(500, 90, 250), 0); /* radius 318.3 mm: from (1000, -800) heading down to the right */
  VWWait();
  VWGetPosition(&x, &y, &phi);
  EQUAL(x, 1318);
  EQUAL(y, -1118);
  EQUAL(phi, 0);
  EQUAL(VWDrive(300, 400, 100), 1);
  EQUAL(VWDrive(300, -300, 100), 1);
  EQUAL(VWDrive(400, 0, 200), 0);
  VWWait();
  VWGetPosition(&x, &y, &phi);
  EQUAL(x, 1718);
  EQUAL(VWSetSpeed(100, 10), 0);
  EQUAL(VWDone(), 1);
  OSWait(500);
  EQUAL(VWGetSpeed(&v, &w), 0);
  EQUAL(v, 100);
  EQUAL(w, 10);
  VWStraight(1000, -100); /* of speeds the amount counts; interrupted by a turn */
  OSWait(100);
  VWTurn(90, 90);
  VWWait();
  NEAR(OSGetCount() - count, 0, 60000);
  EQUAL(VWStalled(), 2);
  EQUAL(VWControl(70, 30, 70, 10), 0);
  EQUAL(VWControl(-70, 30, 70, 10), 1);
  EQUAL(VWControlOff(), 0);
  VWSetSpeed(0, 0);
  return failures;
}
