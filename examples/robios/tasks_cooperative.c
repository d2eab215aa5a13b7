/* Cooperative tasks (RoBIOS 6): one drives a square, one counts its corners, one shows a distance.
 *
 * Robot:  two wheels, a PSD in front (LabBot, S4), 0.5 m of room.
 * Result: the robot stands where it began. The trace shows who runs when: OSSemV does not switch tasks, so `drive` has begun the next
 *         side before `count` sees the corner:
 *             side 1, side 2, corner 1, side 3, corner 2, side 4, corner 3, end, corner 4.
 *         tasks_preemptive.c has another order. */
#include "eyebot.h"

static struct sem corner;
static VWHandle vw;
static PSDHandle psd;
static int ended = 0;

/* Lets others run while the robot drives. VWDriveWait would keep the processor. */
static void wait_for_drive(void) {
  while (!VWDriveDone(vw)) OSReschedule();
}

static void drive(void) {
  int side;
  for (side = 1; side <= 4; side++) {
    printf("side %d\n", side);
    VWDriveStraight(vw, 0.3, 0.3);
    wait_for_drive();
    VWDriveTurn(vw, M_PI / 2, 1.5);
    wait_for_drive();
    OSSemV(&corner);
  }
  ended = 1;
  printf("end\n");
}

static void count(void) {
  int corners;
  for (corners = 1; corners <= 4; corners++) {
    OSSemP(&corner);
    printf("corner %d\n", corners);
    LCDSetPos(1, 0);
    LCDPrintf("corners %d", corners);
  }
}

static void show(void) {
  while (!ended) {
    LCDSetPos(0, 0);
    LCDPrintf("front %4d mm", PSDGet(psd));
    OSSleep(10); /* 0.1 s */
  }
}

int main(void) {
  vw = VWInit(VW_DRIVE, 1);
  VWStartControl(vw, 7, 0.3, 10, 0.1);
  psd = PSDInit(PSD_FRONT);
  PSDStart(psd, TRUE);
  OSMTInit(COOP);
  OSSemInit(&corner, 0);
  OSReady(OSSpawn("drive", drive, 4096, MED_PRI, 1));
  OSReady(OSSpawn("count", count, 4096, MED_PRI, 2));
  OSReady(OSSpawn("show", show, 4096, MED_PRI, 3));
  OSReschedule(); /* returns when all have ended */
  PSDRelease();
  VWRelease(vw);
  return 0;
}
