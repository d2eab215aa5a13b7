/* Time slots: calls of many costs, and the two clocks after each of them. Prints "slot VIRTUAL SIMULATION" [ms], 300 times. */
#include "eyebot.h"

int main(void) {
  int i, virtual_ms[300], simulation_ms[300];
  for (i = 0; i < 300; i++) {
    int kind = rand() % 4;
    if (kind == 0) PSDGet(PSD_FRONT);
    if (kind == 1) LCDSetPrintf(0, 0, "%d", i);
    if (kind == 2) RADIOSend(0, "x");
    if (kind == 3) OSWait(rand() % 30);
    virtual_ms[i] = SIMGetVirtualTime();
    simulation_ms[i] = SIMGetSimulationTime();
  }
  for (i = 0; i < 300; i++) {
    printf("slot %d %d\n", virtual_ms[i], simulation_ms[i]);
    if (i % 100 == 99) OSWait(100); /* at most 200 lines in a time slot are kept */
  }
  return 0;
}
