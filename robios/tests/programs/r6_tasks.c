/* Tasks of RoBIOS 6; what they print is compared with a trace made by hand. */
#include "eyebot.h"

#include <string.h>

#include "check.h"

static struct tcb *a, *b, *c;
static struct sem s;
static int order = 0;

/* Cooperative: a task runs until it gives way. */
static void coop(void) {
  int i;
  for (i = 0; i < 3; i++) {
    printf("%d:%d ", OSGetUID(0), i);
    OSWait(20); /* keeps the processor */
    OSYield();
  }
}
static void sleeper(void) {
  printf("sleeps ");
  OSSleep(5);
  printf("woke ");
}
static void run_coop(void) {
  EQUAL(OSMTStatus(), NOTASK);
  EQUAL(OSMTInit(COOP), 0);
  EQUAL(OSMTInit(77), 1);
  EQUAL(OSMTStatus(), COOP);
  a = OSSpawn("a", coop, 4096, MED_PRI, 1);
  b = OSSpawn("b", coop, 4096, MED_PRI, 2);
  c = OSSpawn("c", coop, 4096, MAX_PRI, 3);
  CHECK(a && b && c);
  CHECK(OSSpawn("x", coop, 4096, MAX_PRI + 1, 3) == 0);
  CHECK(OSSpawn("x", 0, 4096, MIN_PRI, 3) == 0);
  EQUAL(OSReady(a), 0);
  EQUAL(OSReady(b), 0);
  EQUAL(OSReady(c), 0);
  EQUAL(OSGetUID(b), 2);
  EQUAL(OSGetUID(0), 0);
  EQUAL(OSGetUID((struct tcb *)&order), -1);
  OSWait(10); /* still alone */
  printf("main ");
  EQUAL(OSReschedule(), 0);
  printf("back ");
  a = OSSpawn("s", sleeper, 4096, MIN_PRI, 4);
  OSReady(a);
  OSReschedule();
  printf("end\n");
}

/* Semaphores: a producer of higher priority and a consumer. */
static void producer(void) {
  int i;
  for (i = 0; i < 3; i++) {
    printf("+%d ", i);
    EQUAL(OSSemV(&s), 0);
    if (i == 1) OSSleep(1);
  }
  printf("p. ");
}
static void consumer(void) {
  int i;
  for (i = 0; i < 3; i++) {
    EQUAL(OSSemP(&s), 0);
    printf("-%d ", i);
  }
  printf("c. ");
}
static void run_sem(int mode) {
  OSMTInit(mode);
  EQUAL(OSSemInit(&s, 0), 0);
  EQUAL(OSSemInit(&s, -1), 1);
  a = OSSpawn("consumer", consumer, 0, MAX_PRI, 1);
  b = OSSpawn("producer", producer, 0, MIN_PRI, 2);
  OSReady(a);
  OSReady(b);
  if (mode == COOP) {
    OSReschedule();
  } else {
    EQUAL(OSPermit(), 0);
  }
  printf("end\n");
}

/* Preemptive: slices of 10 ms; LCDPutChar takes 50 us, so 200 calls make a slice. */
static int calls[3];
static void busy(void) {
  const int me = OSGetUID(0);
  int i;
  for (i = 0; i < 1000; i++) {
    if (order != me) {
      order = me;
      printf("%d@%d ", me, calls[me]);
    }
    LCDPutChar('x');
    calls[me]++;
  }
}
static void run_preempt(void) {
  OSMTInit(PREEMPT);
  EQUAL(OSMTStatus(), PREEMPT);
  a = OSSpawn("a", busy, 4096, MED_PRI, 1);
  b = OSSpawn("b", busy, 4096, MED_PRI, 2);
  OSReady(a);
  OSReady(b);
  OSWait(10); /* not yet permitted */
  EQUAL(calls[1] + calls[2], 0);
  OSPermit();
  EQUAL(calls[1] + calls[2], 2000);
  printf("end\n");
}

/* A task of high priority runs when it wakes; nothing does while switches are forbidden. */
static void high(void) {
  int i;
  for (i = 0; i < 3; i++) {
    OSSleep(3);
    printf("H%d ", OSGetCount());
  }
}
static void low(void) {
  int i;
  for (i = 0; i < 10; i++) {
    if (i == 5) EQUAL(OSForbid(), 0);
    OSWait(1);
    printf("%d ", OSGetCount());
    if (i == 8) OSPermit();
  }
}
static void run_priorities(void) {
  OSMTInit(PREEMPT);
  a = OSSpawn("high", high, 4096, MAX_PRI, 1);
  b = OSSpawn("low", low, 4096, MIN_PRI, 2);
  OSReady(a);
  OSReady(b);
  OSPermit();
  printf("end\n");
}

/* Suspend, ready, run, kill, exit. */
static void endless(void) {
  for (;;) {
    printf("%d ", OSGetUID(0));
    OSYield();
  }
}
static void boss(void) {
  EQUAL(OSSuspend(a), 0);
  printf("s ");
  OSYield();
  OSYield();
  EQUAL(OSReady(a), 0);
  EQUAL(OSKill(b), 0);
  EQUAL(OSKill(b), 1);
  printf("k ");
  OSYield();
  EQUAL(OSRun(a), 0);
  printf("r ");
  OSKill(a);
  c = OSSpawn("again", endless, 4096, MIN_PRI, 5);
  OSReady(c);
  OSYield();
  OSKill(c);
  OSExit(3); /* of this task */
  printf("never ");
}
static void run_control(void) {
  struct tcb *d;
  OSMTInit(COOP);
  a = OSSpawn("a", endless, 4096, MIN_PRI, 1);
  b = OSSpawn("b", endless, 4096, MIN_PRI, 2);
  d = OSSpawn("boss", boss, 4096, MIN_PRI, 3);
  OSReady(a);
  OSReady(b);
  OSReady(d);
  OSReschedule();
  printf("end\n");
  OSExit(4); /* of the program */
}

/* main of a preemptive program goes on while the others wait. */
static void ticks(void) {
  int i;
  for (i = 0; i < 6; i++) {
    calls[1]++;
    OSWait(5);
  }
  printf("ticked ");
}
static void run_main(int waits) {
  OSMTInit(PREEMPT);
  a = OSSpawn("ticks", ticks, 4096, MIN_PRI, 1);
  OSReady(a);
  OSPermit();
  printf("main %d ", calls[1]);
  if (!waits) return; /* the task goes on to its end */
  OSWait(11);
  printf("%d ", calls[1]);
  OSForbid();
  OSWait(11);
  printf("%d ", calls[1]);
  OSPermit();
  OSWait(1);
  printf("%d\n", calls[1]);
}

static void locked(void) {
  OSSemP(&s);
  printf("never ");
}
static void panics(void) { OSPanic("no more"); }

int main(int argc, char **argv) {
  const char *what = argc > 1 ? argv[1] : "";
  if (!strcmp(what, "coop")) run_coop();
  if (!strcmp(what, "sem coop")) run_sem(COOP);
  if (!strcmp(what, "sem preempt")) run_sem(PREEMPT);
  if (!strcmp(what, "preempt")) run_preempt();
  if (!strcmp(what, "priorities")) run_priorities();
  if (!strcmp(what, "control")) run_control();
  if (!strcmp(what, "main")) run_main(1);
  if (!strcmp(what, "main returns")) run_main(0);
  if (!strcmp(what, "stuck")) { /* main goes on when the others wait for each other */
    OSMTInit(COOP);
    OSSemInit(&s, 0);
    OSReady(OSSpawn("locked", locked, 4096, MED_PRI, 1));
    OSReschedule();
    printf("back\n");
  }
  if (!strcmp(what, "panic")) {
    OSMTInit(COOP);
    OSReady(OSSpawn("panics", panics, 4096, MED_PRI, 1));
    OSReschedule();
  }
  return failures;
}
