/* Mecanum wheels: a square without a turn, then a turn on the spot, by the four motors alone.
 *
 * Robot:  four Mecanum wheels (Omni), 0.8 m of room ahead and on the left.
 * Result: the robot drives ahead, left, back and right, always with the same heading, stands where it began, and turns once around.
 *
 * Speeds of the wheels:
 *                front left   front right   back left   back right
 *     ahead          +             +            +            +
 *     left           -             +            +            -
 *     turn left      -             +            -            + */
#include "eyebot.h"

enum { FRONT_LEFT = 1, FRONT_RIGHT, BACK_LEFT, BACK_RIGHT };

/* Percent of the full speed ahead, to the left and around, for a time. */
static void drive(const char *name, int ahead, int left, int turn, int ms) {
  int x, y, phi;
  MOTORDrive(FRONT_LEFT, ahead - left - turn);
  MOTORDrive(FRONT_RIGHT, ahead + left + turn);
  MOTORDrive(BACK_LEFT, ahead + left - turn);
  MOTORDrive(BACK_RIGHT, ahead - left + turn);
  OSWait(ms);
  VWGetPosition(&x, &y, &phi);
  LCDPrintf("%-6s x%4d y%4d %4d deg\n", name, x, y, phi);
  printf("%s: x %d mm, y %d mm, %d degrees\n", name, x, y, phi);
}

int main(void) {
  drive("ahead", 30, 0, 0, 2000);
  drive("left", 0, 30, 0, 2000);
  drive("back", -30, 0, 0, 2000);
  drive("right", 0, -30, 0, 2000);
  drive("stop", 0, 0, 0, 500);
  drive("turn", 0, 0, 30, 4000);
  drive("stop", 0, 0, 0, 500);
  return 0;
}
