/* Ways of the high-level driving interface: straight, turn, curve, to a point. Prints "way NAME BEGIN END": the beginnings of the time
 * slots [ms of simulated time] before the order and after the robot stands again. */
#include "eyebot.h"

static void way_ends(const char *name, int begin) {
  VWWait();
  OSWait(300);
  printf("way %s %d %d\n", name, begin, SIMGetSimulationTime());
}

int main(void) {
  int begin;
  OSWait(300);
  begin = SIMGetSimulationTime();
  VWStraight(500, 200);
  way_ends("straight", begin);
  begin = SIMGetSimulationTime();
  VWTurn(90, 60);
  way_ends("turn", begin);
  begin = SIMGetSimulationTime();
  VWCurve(500, 90, 200);
  way_ends("curve", begin);
  begin = SIMGetSimulationTime();
  VWDrive(400, 300, 200);
  way_ends("point", begin);
  return 0;
}
