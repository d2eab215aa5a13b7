/* Preemptive tasks (RoBIOS 6): one drives a square, one of higher priority counts its corners, two add to the same number all the time.
 *
 * Robot:  two wheels (LabBot, S4), 0.5 m of room.
 * Result: the robot stands where it began. `count` runs as soon as it can:
 *             side 1, corner 1, side 2, corner 2, side 3, corner 3, side 4, corner 4, end.
 *         Both adders have had their turns (slices of 10 ms), and no addition is lost: "sum 4000 of 4000". Compiled with -DNO_LOCK some are:
 *         a task that is interrupted between reading and writing overwrites what the other one has added. */
#include "eyebot.h"

#define ADDITIONS 2000 /* of each adder */

static struct sem corner, lock;
static VWHandle vw;
static int sum = 0;

static void drive(void) {
  int side;
  for (side = 1; side <= 4; side++) {
    printf("side %d\n", side);
    VWDriveStraight(vw, 0.3, 0.3);
    VWDriveWait(vw); /* the others run in the meantime */
    VWDriveTurn(vw, M_PI / 2, 1.5);
    VWDriveWait(vw);
    OSSemV(&corner);
  }
  printf("end\n");
}

static void count(void) {
  int corners;
  for (corners = 1; corners <= 4; corners++) {
    OSSemP(&corner);
    printf("corner %d\n", corners);
  }
}

static void add(void) {
  int i, read;
  for (i = 0; i < ADDITIONS; i++) {
#ifndef NO_LOCK
    OSSemP(&lock);
#endif
    read = sum;
    LCDSetPos(0, 0); /* takes time: here the other one may interrupt */
    LCDPrintf("sum %5d", read);
    sum = read + 1;
#ifndef NO_LOCK
    OSSemV(&lock);
#endif
  }
  printf("adder %d has ended\n", OSGetUID(0));
}

int main(void) {
  struct tcb *adder1, *adder2;
  vw = VWInit(VW_DRIVE, 1);
  VWStartControl(vw, 7, 0.3, 10, 0.1);
  OSMTInit(PREEMPT);
  OSSemInit(&corner, 0);
  OSSemInit(&lock, 1);
  adder1 = OSSpawn("adder1", add, 4096, MIN_PRI, 1);
  adder2 = OSSpawn("adder2", add, 4096, MIN_PRI, 2);
  OSReady(OSSpawn("count", count, 4096, MAX_PRI, 3));
  OSReady(OSSpawn("drive", drive, 4096, MED_PRI, 4));
  OSReady(adder1);
  OSReady(adder2);
  OSPermit(); /* main goes on when all others wait or have ended */
  OSWait(1500); /* 15 s */
  printf("sum %d of %d\n", sum, 2 * ADDITIONS);
  VWRelease(vw);
  return 0;
}
