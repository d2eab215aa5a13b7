#include "eyebot.h"

#include "check.h"

int main() {
  int scan[3600], i;
  EQUAL(PSDGet(PSD_FRONT), 100);
  EQUAL(PSDGet(PSD_LEFT), 200);
  EQUAL(PSDGet(PSD_BACK), PSD_OUT_OF_RANGE); /* the fake one is infinite */
  EQUAL(PSDGet(77), PSD_OUT_OF_RANGE);
  EQUAL(PSDGet(-2000000000), PSD_OUT_OF_RANGE);
  EQUAL(PSDGetRaw(PSD_FRONT), 455); /* 1023 * 80 / 180 = 454.67 */
  EQUAL(PSDGetRaw(PSD_BACK), 0);
  /* The fake lidar's distance is 1 m + 1 mm per degree counter-clockwise from straight ahead, -180 to 179. */
  EQUAL(LIDARGet(scan), 0);
  EQUAL(scan[180], 1000);
  EQUAL(scan[90], 1090); /* left */
  EQUAL(scan[270], 910);
  EQUAL(scan[0], 820); /* behind: -180 and 180 are the same beam */
  EQUAL(LIDARSet(180, 0, 90), 0);
  for (i = 0; i < 100; i++) scan[i] = -7;
  EQUAL(SIMLaserScan(scan), 0);
  EQUAL(scan[45], 1000);
  EQUAL(scan[0], 1090);
  EQUAL(scan[89], 912);
  EQUAL(scan[90], -7);
  EQUAL(LIDARSet(361, 0, 90), 1);
  EQUAL(LIDARSet(360, 10, 90), 1);
  EQUAL(LIDARSet(360, 0, 0), 1);
  EQUAL(LIDARSet(360, 0, 100000), 1);

  EQUAL(MOTORDrive(1, 50), 0);
  EQUAL(MOTORDrive(2, -100), 0);
  EQUAL(MOTORDrive(3, 50), 1);
  EQUAL(MOTORDrive(1, 101), 1);
  EQUAL(MOTORDriveRaw(1, 25), 0);
  EQUAL(MOTORSpeed(2, 54), 0); /* 5400 ticks/s = 10 turns/s */
  EQUAL(MOTORSpeed(0, 54), 1);
  EQUAL(MOTORPID(1, 4, 5, 6), 0);
  EQUAL(MOTORPID(1, 4, 500, 6), 1);
  EQUAL(MOTORPIDOff(2), 0);
  EQUAL(MOTORPIDOff(9), 1);
  OSWait(1000);
  i = ENCODERRead(1);
  CHECK(i > 200); /* the fake turns 1000 ticks/s at 1 */
  EQUAL(ENCODERReset(1), 0);
  EQUAL(ENCODERRead(1), 0);
  EQUAL(ENCODERRead(9), 0);
  EQUAL(ENCODERReset(9), 1);

  EQUAL(SERVOSet(1, 255), 0);
  EQUAL(SERVORange(2, 51, 204), 0);
  EQUAL(SERVOSet(2, 255), 0);
  EQUAL(SERVOSet(2, 0), 0);
  EQUAL(SERVOSetRaw(2, 0), 0);
  EQUAL(SERVOSet(3, 100), 1);
  EQUAL(SERVOSet(1, 256), 1);
  EQUAL(SERVOSetRaw(1, -1), 1);
  EQUAL(SERVORange(1, 200, 100), 1);
  return failures;
}
