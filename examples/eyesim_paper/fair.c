/* Fairness: four robots race, with the same calls and very different native work between them. Prints "fair CALLS WORK": calls of PSDGet
 * within ten seconds, multiplications per call. */
#include "eyebot.h"

int main(void) {
  const int work = (OSMachineID() - 1) * 20000;
  int i, calls = 0;
  volatile double product = 1;
  VWSetSpeed(200, 0);
  while (OSGetCount() < 10000) {
    for (i = 0; i < work; i++) product *= 1.0000001;
    PSDGet(PSD_FRONT);
    OSWait(5);
    calls++;
  }
  VWSetSpeed(0, 0);
  printf("fair %d %d\n", calls, work);
  return 0;
}
