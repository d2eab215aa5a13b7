/* Pictures of a robot that drives by: no picture shows it where it will be. Robot 1 looks, robot 2 drives across its view.
 * Robot 1 prints "picture BEFORE AFTER COLUMN": its clock before and after the call [ms], and the column of the middle of what has
 * changed against the empty view; without a robot in it nothing is printed. */
#include "eyebot.h"

static BYTE empty[QVGA_SIZE], picture[QVGA_SIZE];

int main(void) {
  int i, n;
  if (OSMachineID() == 2) {
    OSWait(1500);
    VWSetSpeed(300, 0);
    for (;;) OSWait(1000);
  }
  CAMInit(QVGA);
  OSWait(500);
  CAMGet(empty);
  for (n = 0; n < 120; n++) {
    int before = SIMGetVirtualTime(), after, changed = 0, edge = 0;
    double sum = 0;
    CAMGet(picture);
    after = SIMGetVirtualTime();
    for (i = 0; i < QVGA_PIXELS; i++) {
      const BYTE *a = empty + 3 * i, *b = picture + 3 * i;
      if (abs(a[0] - b[0]) + abs(a[1] - b[1]) + abs(a[2] - b[2]) > 40) {
        int column = i % QVGA_X;
        sum += column;
        changed++;
        if (column < 3 || column > QVGA_X - 4) edge = 1;
      }
    }
    if (changed > 50 && !edge) printf("picture %d %d %.2f\n", before, after, sum / changed);
    OSWait(rand() % 40);
  }
  return 0;
}
