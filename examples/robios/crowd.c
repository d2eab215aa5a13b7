/* Crowd: wander with open eyes. Each robot takes pictures, shows them, and turns away from what is red: crates, cans.
 *
 * Robots: any number of two-wheeled ones with a camera and a PSD in front; all run this program.
 * Result: all keep moving; the screen shows the picture and the number of pictures, and each robot prints it. KEY4 ends the program. */
#include "eyebot.h"

#define SPEED 200 /* mm/s */
#define NEAR_MM 220

static BYTE picture[QQVGA_SIZE];

/* Red pixels in the left and the right half of the picture. */
static void count_red(int *left, int *right) {
  int x, y;
  *left = *right = 0;
  for (y = 0; y < QQVGA_Y; y++) {
    for (x = 0; x < QQVGA_X; x++) {
      const BYTE *p = picture + 3 * (y * QQVGA_X + x);
      if (p[0] > 100 && p[0] > 2 * p[1] && p[0] > 2 * p[2]) ++*(x < QQVGA_X / 2 ? left : right);
    }
  }
}

int main(void) {
  int pictures = 0, left, right;
  const int side = RADIOGetID() % 2 ? 1 : -1; /* neighbours turn away from each other */
  CAMInit(QQVGA);
  LCDMenu("", "", "", "END");
  LCDImageStart(0, 32, QQVGA_X, QQVGA_Y);
  while (KEYRead() != KEY4) {
    CAMGet(picture);
    count_red(&left, &right);
    LCDImage(picture);
    LCDSetPrintf(0, 0, "picture %5d", ++pictures);
    LCDSetPrintf(1, 0, "red %5d %5d", left, right);
    if (pictures % 20 == 0) printf("%d pictures\n", pictures);
    if (PSDGet(PSD_FRONT) < NEAR_MM) {
      VWTurn(side * (100 + rand() % 60), 120);
      VWWait();
    } else {
      VWSetSpeed(SPEED, left + right > 200 ? (left > right ? -40 : 40) : 0);
    }
  }
  VWSetSpeed(0, 0);
  return 0;
}
