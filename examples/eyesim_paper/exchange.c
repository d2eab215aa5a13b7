/* Random exchanges: each of four robots sends its clock to a random other one, about ten times in a time slot, and compares the clocks
 * that arrive with its own. Prints "exchange SENT RECEIVED FUTURE LEAST_MS MEAN_US MOST_MS". */
#include "eyebot.h"

#define SEND_UNTIL_MS 130000
#define END_MS 131000

int main(void) {
  const int me = RADIOGetID();
  char text[32];
  int id, sent = 0, received = 0, future = 0, least = 1 << 30, most = 0;
  double sum = 0;
  RADIOInit();
  OSWait(100);
  srand(me);
  while (OSGetCount() < END_MS) {
    while (RADIOCheck() > 0) {
      int age;
      RADIOReceive(&id, text, sizeof(text));
      age = SIMGetVirtualTime() - atoi(text);
      future += age < 0;
      if (age < least) least = age;
      if (age > most) most = age;
      sum += age;
      received++;
    }
    if (OSGetCount() < SEND_UNTIL_MS) {
      sprintf(text, "%d", SIMGetVirtualTime());
      RADIOSend(1 + (me - 1 + 1 + rand() % 3) % 4, text);
      sent++;
      OSWait(rand() % 4);
    } else {
      OSWait(20);
    }
  }
  printf("exchange %d %d %d %d %d %d\n", sent, received, future, least, (int)(1000 * sum / received), most);
  return 0;
}
