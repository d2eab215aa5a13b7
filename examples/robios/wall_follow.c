/* Follow the wall on the left at a distance of 150 mm, around inner and outer corners.
 *
 * Robot:  two wheels, PSDs in front and on the left (LabBot).
 * Result: PSD_LEFT stays between 100 and 200 mm; the screen shows it and counts corners. KEY4 ends the program.
 *
 * Along the wall the turning rate w follows the error e of the distance and its change (a PD controller):
 *     w = KP e + KD de/dt.
 * At a small angle a to the wall de/dt = -v a and da/dt = w, hence
 *     e'' = -v (KP e + KD e'),
 * an oscillator of frequency sqrt(v KP) = 1.2 rad/s and damping KD sqrt(v / KP) / 2 = 0.8: no overshoot to speak of. */
#include "eyebot.h"

#define SPEED 150    /* mm/s */
#define WANTED 150   /* mm between sensor and wall */
#define KP 0.57      /* (deg/s) / mm */
#define KD 0.75      /* (deg/s) / (mm/s) */
#define SLOT_MS 50
#define FRONT_MM 145 /* a wall ahead: an inner corner */
#define JUMP_MM 50   /* farther by so much within a slot: an outer corner */

#define SIDE 70  /* mm from the middle of the robot to PSD_LEFT, to the left ... */
#define AHEAD 40 /* ... and ahead */

static int limited(double value, int most) { return value > most ? most : value < -most ? -most : (int)lrint(value); }

int main(void) {
  int last = PSDGet(PSD_LEFT), corners = 0;
  LCDMenu("", "", "", "END");
  while (KEYRead() != KEY4) {
    int left = PSDGet(PSD_LEFT);
    if (PSDGet(PSD_FRONT) < FRONT_MM) {
      VWTurn(-90, 90);
      VWWait();
      last = PSDGet(PSD_LEFT);
      printf("inner corner %d\n", ++corners);
    } else if (left - last > JUMP_MM) {
      /* The sensor is past the corner, the middle of the robot is not yet. Then a quarter of a circle about the corner. */
      VWStraight(AHEAD, SPEED);
      VWWait();
      VWCurve((int)lrint((WANTED + SIDE) * M_PI / 2), 90, SPEED);
      VWWait();
      last = PSDGet(PSD_LEFT);
      printf("outer corner %d\n", ++corners);
    } else {
      double change = (left - last) * 1000.0 / SLOT_MS;
      VWSetSpeed(SPEED, limited(KP * (left - WANTED) + KD * change, 45));
      last = left;
    }
    LCDSetPrintf(0, 0, "wall    %4d mm", left);
    LCDSetPrintf(1, 0, "corners %4d", corners);
    OSWait(SLOT_MS);
  }
  VWSetSpeed(0, 0);
  return 0;
}
