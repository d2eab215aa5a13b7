/* Ping-pong by radio: a number goes back and forth between robots 1 and 2, one more each time.
 *
 * Robots: two of any kind, with radio; both run this program.
 * Result: both screens count up to 100. Then both print how long a way took; 50 ms is the time slot, and no message is faster. */
#include "eyebot.h"

#define LAST 100

int main(void) {
  const int me = RADIOGetID(), other = 3 - me;
  char text[32];
  int ball = 0, from, begin;
  RADIOInit();
  if (me == 1) {
    OSWait(200); /* robot 2 listens by then */
    RADIOSend(other, "1");
  }
  begin = OSGetCount();
  while (ball < LAST) {
    RADIOReceive(&from, text, sizeof(text));
    ball = atoi(text);
    LCDSetPrintf(0, 0, "robot %d: ball %3d", me, ball);
    if (ball < LAST) {
      sprintf(text, "%d", ++ball);
      RADIOSend(from, text);
    }
  }
  printf("ball %d, %d ms a way\n", ball, (OSGetCount() - begin) / LAST);
  AUBeep();
  return 0;
}
