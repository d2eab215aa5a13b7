/* Drives two ways, prints, waits for a key. */
#include "eyebot.h"

int main() {
  int x, y, phi;
  LCDMenu("GO", "", "", "END");
  LCDPrintf("Hello %d\n", 7);
  KEYWait(KEY1);
  printf("key at %d\n", OSGetCount());
  VWStraight(500, 250);
  VWWait();
  VWTurn(90, 45);
  while (!VWDone()) OSWait(100);
  VWGetPosition(&x, &y, &phi);
  printf("%d %d %d, front %d\n", x, y, phi, PSDGet(PSD_FRONT));
  LCDSetPrintf(3, 2, "x=%d", x);
  return 5;
}
