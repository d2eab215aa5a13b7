/* Cost of calls: the program's clock before and after 100 calls of a function. Prints "cost NAME TABLE MEASURED" [us a call], with the
 * value of the table of docs/robios.md, and "native MS" for 50 million multiplications without a call. */
#include "eyebot.h"

#define CALLS 100
#define COST(name, table_us, call)                                              \
  do {                                                                          \
    int i, begin = SIMGetVirtualTime();                                         \
    for (i = 0; i < CALLS; i++) call;                                           \
    printf("cost %s %d %d\n", name, table_us, (SIMGetVirtualTime() - begin) * 1000 / CALLS); \
  } while (0)

static BYTE picture[QVGA_SIZE];

int main(void) {
  int x, y, phi, i, begin;
  double product = 1;
  CAMInit(QVGA);
  RADIOInit();
  LCDImageSize(QVGA);
  COST("OSGetCount", 10, OSGetCount());
  COST("ENCODERRead", 30, ENCODERRead(1));
  COST("VWGetPosition", 50, VWGetPosition(&x, &y, &phi));
  COST("MOTORDrive", 50, MOTORDrive(1, 0));
  COST("VWSetSpeed", 100, VWSetSpeed(0, 0));
  COST("PSDGet", 100, PSDGet(PSD_FRONT));
  COST("KEYRead", 50, KEYRead());
  COST("LCDLine", 200, LCDLine(0, 0, 99, 99, RED));
  COST("LCDSetPrintf", 500, LCDSetPrintf(0, 0, "%d", i));
  COST("RADIOSend", 2000, RADIOSend(1, "x"));
  COST("LIDARGet", 5000, { static int scan[360]; LIDARGet(scan); });
  COST("LCDImage", 10000, LCDImage(picture));
  COST("CAMGet", 20000, CAMGet(picture));
  begin = SIMGetVirtualTime();
  for (i = 0; i < 50000000; i++) product *= 1.0000001;
  printf("native %d %d\n", SIMGetVirtualTime() - begin, product > 1);
  return 0;
}
