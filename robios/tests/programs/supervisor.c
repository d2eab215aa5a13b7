#include "eyebot.h"

#include "check.h"

int main() {
  int x = 1, y = 1, z = 1, phi = 1, start;
  EQUAL(SIMGetRobotCount(), 2);
  EQUAL(SIMGetObjectCount(), 1);
  SIMGetRobot(0, &x, &y, &z, &phi); /* itself, number 3 */
  EQUAL(x, 1000);
  EQUAL(y, 2000);
  EQUAL(z, 0);
  EQUAL(phi, 90);
  SIMGetRobot(1, &x, &y, &z, &phi);
  EQUAL(x, -1);
  SIMGetObject(2, &x, &y, &z, &phi);
  EQUAL(x, 5000);
  SIMGetObject(3, &x, &y, &z, &phi); /* a robot */
  EQUAL(x, 0);
  SIMSetRobot(1, 100, 200, 0, 45);
  SIMSetObject(2, 300, 400, 0, -90);
  SIMSetObject(77, 300, 400, 0, -90);
  start = SIMGetVirtualTime();
#ifdef ROBIOS7_EYEBOT_H
  OSWait(120);
#else
  OSWait(12);
#endif
  NEAR(SIMGetVirtualTime(), start + 120, 1);
  EQUAL(SIMGetSimulationTime() % 50, 0);
  CHECK(SIMGetVirtualTime() - SIMGetSimulationTime() < 50);
  EQUAL(SIMGetRealTime(), 2 * SIMGetSimulationTime());
  return failures;
}
