/* Radio: robot 1 sends N messages of 32 bytes, all bits known; robot 2 counts what arrives and which bits are wrong. Prints
 * "radio SENT RECEIVED WRONG_BITS UNHARMED". RoBIOS 6. */
#include "eyebot.h"

#define N 2000
#define SIZE 32
#define PATTERN 0x55

int main(void) {
  VWHandle vw = VWInit(VW_DRIVE, 1);
  BYTE message[64], from;
  int i, bit, size, received = 0, wrong = 0, unharmed = 0;
  VWSetSpeed(vw, 0, 0);
  RADIOInit();
  if (OSMachineID() == 1) {
    for (i = 0; i < SIZE; i++) message[i] = PATTERN;
    OSWait(20); /* robot 2 listens by then */
    for (i = 0; i < N; i++) RADIOSend(2, SIZE, message);
    return 0;
  }
  for (;;) {
    int harmed = 0;
    if (OSGetCount() > 700) break; /* 7 s: all have arrived, 2 ms each */
    if (RADIOCheck() == 0) {
      OSWait(1);
      continue;
    }
    RADIORecv(&from, &size, message);
    for (i = 0; i < size; i++)
      for (bit = 0; bit < 8; bit++) harmed += ((message[i] ^ PATTERN) >> bit) & 1;
    received++;
    wrong += harmed;
    unharmed += harmed == 0 && size == SIZE;
  }
  printf("radio %d %d %d %d\n", N, received, wrong, unharmed);
  return 0;
}
