/* Two robots send each other MESSAGES equal messages, one after the other, and count what arrives: messages, bits, wrong bits. */
#include "eyebot.h"

#define MESSAGES 2500
#define BYTES 64

static int received, bits, wrong;

static void listen(void) {
  char text[2 * BYTES];
  int from, i, bit;
  while (RADIOCheck() > 0) {
    RADIOReceive(&from, text, sizeof text);
    received++;
    for (i = 0; i < BYTES; i++)
      for (bit = 0; bit < 8; bit++, bits++) wrong += ((text[i] ^ 'U') >> bit) & 1;
  }
}

int main(void) {
  char text[BYTES + 1];
  int n = 0;
  const int mine = OSMachineID();
  memset(text, 'U', BYTES);
  text[BYTES] = 0;
  RADIOInit();
  if (mine == 2)
    while (SIMGetVirtualTime() < 30000) OSWait(50), listen();
  while (n < MESSAGES) {
    RADIOSend(3 - mine, text);
    if (++n % 5 == 0) OSWait(40);
  }
  while (SIMGetVirtualTime() < 60000) OSWait(50), listen();
  printf("of %d received %d bits %d wrong %d\n", MESSAGES, received, bits, wrong);
  return 0;
}
