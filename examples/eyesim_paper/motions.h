/* Motions by motors alone, for wheels.c, mecanum.c.
 *
 * Prints "motion NAME BEGIN END PERCENT... TICKS...": the beginnings of two time slots [ms of simulated time], what each motor was
 * ordered, and the encoder ticks of each wheel in between. */
#include "eyebot.h"

#define SLOT_MS 50
#define START_MS 1000 /* until the speeds are reached */
#define MEASURED_MS 2000

static void next_slot(void) { OSWait(SLOT_MS - OSGetCount() % SLOT_MS); }

static void read_encoders(int motors, int ticks[]) {
  int i;
  for (i = 0; i < motors; i++) ticks[i] = ENCODERRead(i + 1);
}

/* Share of the full speed of each motor [percent]. */
static void motion(const char* name, int motors, const int percent[]) {
  int before[4], after[4], begin, i;
  for (i = 0; i < motors; i++) MOTORDrive(i + 1, percent[i]);
  OSWait(START_MS);
  next_slot();
  begin = SIMGetSimulationTime();
  read_encoders(motors, before);
  OSWait(MEASURED_MS);
  next_slot();
  read_encoders(motors, after);
  printf("motion %s %d %d", name, begin, SIMGetSimulationTime());
  for (i = 0; i < motors; i++) printf(" %d", percent[i]);
  for (i = 0; i < motors; i++) printf(" %d", after[i] - before[i]);
  printf("\n");
}
