/* DistBug (Kamon and Rivlin 1997): to a goal at a known place, around obstacles at unknown places.
 *
 * Robot:  two wheels and a laser scanner (S4, LabBot).
 * Result: the robot stands at the goal, 3 m ahead of the start, and prints "at the goal"; or it has gone all around what encloses
 *         the goal, and prints "cannot be reached". The screen shows the scan and what the robot does.
 *
 * Drive at the goal. Where something is in the way, follow it, on the left hand. Leave it when the free way towards the goal leads nearer to
 * the goal than the robot ever was: d - F <= d_min - STEP. Where the robot meets its way again, there is no way. */
#include "eyebot.h"

#ifndef GOAL_X
#define GOAL_X 3000 /* mm ahead of the start */
#define GOAL_Y 0    /* and to the left */
#endif
#define AT_GOAL 40    /* mm */
#define HALF_WIDTH 110 /* mm on both sides that the robot needs */
#define HIT 220       /* mm ahead: this is in the way */
#define KEEP 190      /* mm to what it follows */
#define STEP 320      /* mm nearer, so that it does not come back to the same place; more than HIT */

enum { SEEK, FOLLOW };

static int scan[360]; /* mm; 0 is behind, 90 left, 180 ahead */

static int limited(double value, int most) { return value > most ? most : value < -most ? -most : (int)lrint(value); }
static double wrapped(double degrees) { return remainder(degrees, 360); }

/* Length of the free way in a direction [degrees, to the left], as wide as the robot. */
static double free_way(double angle) {
  double shortest = 9999;
  int i;
  for (i = 0; i < 360; i++) {
    double a = (180 - i - angle) * M_PI / 180;
    double along = scan[i] * cos(a), across = scan[i] * sin(a);
    if (along > 0 && fabs(across) < HALF_WIDTH && along < shortest) shortest = along;
  }
  return shortest;
}

static void show(const char *what, double d, double d_min) {
  int i;
  LCDSetPrintf(0, 0, "%-8s", what);
  LCDSetPrintf(1, 0, "goal %5.0f, was %5.0f", d, d_min);
  LCDArea(0, 32, 319, 223, BLACK, 1);
  for (i = 0; i < 360; i += 4)
    if (scan[i] < 1600) { /* 18 mm a pixel */
      double a = (180 - i) * M_PI / 180;
      int column = 160 - (int)(scan[i] * sin(a) / 18), row = 128 - (int)(scan[i] * cos(a) / 18);
      LCDArea(column, row, column + 2, row + 2, GREEN, 1);
    }
  LCDCircle(160, 128, 5, RED, 1);
}

int main(void) {
  int state = SEEK, x, y, phi, hit_x = 0, hit_y = 0, i, was_away = 0;
  double d = 0, d_min = 0;
  VWSetPosition(0, 0, 0);
  for (;;) {
    VWGetPosition(&x, &y, &phi);
    LIDARGet(scan);
    d = hypot(GOAL_X - x, GOAL_Y - y);
    double angle = wrapped(atan2(GOAL_Y - y, GOAL_X - x) * 180 / M_PI - phi); /* of the goal */
    double way = free_way(angle);
    if (d < AT_GOAL) break;

    if (state == SEEK) {
      if (fabs(angle) < 30 && free_way(0) < HIT && way < d) {
        state = FOLLOW;
        hit_x = x;
        hit_y = y;
        d_min = d;
        was_away = 0;
        printf("follows what is in the way at %d %d\n", x, y);
      } else {
        VWSetSpeed(limited(fabs(angle) < 60 ? d : 0, 200), limited(2 * angle, 80));
      }
    }
    if (state == FOLLOW) {
      int nearest = 180; /* of the beams to the left and ahead: what is on the right is another obstacle */
      for (i = 20; i <= 220; i++)
        if (scan[i] < scan[nearest]) nearest = i;
      double aside = wrapped(180 - nearest - 90); /* 0: it is exactly on the left */
      double ahead = 150 * cos(aside * M_PI / 180);
      VWSetSpeed(ahead > 0 ? (int)ahead : 0, limited(1.2 * aside + 0.3 * (scan[nearest] - KEEP), 80));
      if (d < d_min) d_min = d;
      double home = hypot(x - hit_x, y - hit_y);
      if (home > 400) was_away = 1;
      if (was_away && home < 100) {
        VWSetSpeed(0, 0);
        printf("cannot be reached\n");
        return 0;
      }
      if (d - way <= d_min - STEP) {
        state = SEEK;
        printf("leaves it at %d %d\n", x, y);
      }
    }
    show(state == SEEK ? "seek" : "follow", d, d_min);
    OSWait(40);
  }
  VWSetSpeed(0, 0);
  AUBeep();
  printf("at the goal\n");
  return 0;
}
