/* Curves: a figure of eight, a square, and an arc to a point and back to it.
 *
 * Robot:  two wheels (LabBot, S4), 1.4 m of room all around.
 * Result: after each figure the robot stands where it began; the screen shows how far off it is. */
#include "eyebot.h"

#define RADIUS 300 /* mm */
#define SPEED 300  /* mm/s */

static void show(const char *figure) {
  int x, y, phi;
  VWGetPosition(&x, &y, &phi);
  LCDPrintf("%-8s x%4d y%4d %4d deg\n", figure, x, y, phi);
  printf("%s: x %d mm, y %d mm, %d degrees\n", figure, x, y, phi);
}

int main(void) {
  const int around = (int)lrint(2 * M_PI * RADIUS); /* 1885 mm */
  int side;
  VWSetPosition(0, 0, 0);

  VWCurve(around, 360, SPEED); /* to the left, counter-clockwise */
  VWWait();
  VWCurve(around, -360, SPEED);
  VWWait();
  show("eight");

  for (side = 0; side < 4; side++) {
    VWStraight(RADIUS, SPEED);
    VWWait();
    VWTurn(90, 90);
    VWWait();
  }
  show("square");

  VWDrive(400, 300, SPEED); /* 400 mm ahead, 300 mm to the left */
  VWWait();
  show("point");
  VWTurn(180, 90);
  VWWait();
  VWDrive(400, -300, SPEED); /* the same arc, from its other end */
  VWWait();
  show("back");
  return 0;
}
