/* Drives to the other end of the room, around what stands in its way. */
#include "eyebot.h"

/* Nearest thing ahead [mm]: the middle value of the scan looks straight ahead. */
static int nearest(const int scan[360]) {
  int i, least = 9999;
  for (i = 150; i <= 210; i++)
    if (scan[i] > 0 && scan[i] < least) least = scan[i];
  return least;
}

int main() {
  int scan[360], x, y, phi;
  for (;;) {
    LIDARGet(scan);
    VWGetPosition(&x, &y, &phi);
    if (nearest(scan) < 700) VWSetSpeed(50, -60);   /* mm/s, degrees/s; to the right */
    else VWSetSpeed(300, phi < -5 && scan[235] > 900 ? 20 : 0);
    OSWait(100);
  }
}
