/* Ackermann drive: constant speeds and turning rates; the steering angle follows from both. Prints "motion NAME BEGIN END". */
#include "eyebot.h"

#define SLOT_MS 50

static void next_slot(void) { OSWait(SLOT_MS - OSGetCount() % SLOT_MS); }

static void motion(const char *name, int mm_per_s, int degrees_per_s) {
  int begin;
  VWSetSpeed(mm_per_s, degrees_per_s);
  OSWait(2000); /* until wheels and steering are there */
  next_slot();
  begin = SIMGetSimulationTime();
  OSWait(2000);
  next_slot();
  printf("motion %s %d %d\n", name, begin, SIMGetSimulationTime());
}

int main(void) {
  motion("straight", 200, 0);
  motion("wide_left", 200, 20);
  motion("narrow_left", 200, 30);
  motion("right", 300, -30);
  motion("back_left", -200, 20);
  VWSetSpeed(0, 0);
  return 0;
}
