/* Straight ahead at a constant speed. Prints "drives" when it begins. */
#include "eyebot.h"

int main(void) {
  printf("drives\n");
  VWSetSpeed(200, 0);
  for (;;) OSWait(1000);
}
