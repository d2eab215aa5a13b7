/* The C library's clocks and sleeps in virtual time; random numbers. */
#include "eyebot.h"

#include <poll.h>
#include <signal.h>
#include <sys/select.h>
#include <sys/time.h>
#include <time.h>

#include "check.h"

extern int getentropy(void *buffer, size_t size);
static int rang = 0;
static void ring(int number) {
  (void)number;
  rang = OSGetCount();
}

int main() {
  struct timespec a, b, pause = {0, 250000000}, bad = {0, 2000000000};
  struct timeval t, timeout = {0, 400000};
  unsigned random_bytes = 0;
  int start = OSGetCount();
  const time_t before = time(0);
  EQUAL(before, 946684800); /* 2000-01-01 */
  clock_gettime(CLOCK_MONOTONIC, &a);
  EQUAL(sleep(2), 0);
  EQUAL(time(0), before + 2);
  EQUAL(usleep(500000), 0);
  NEAR(OSGetCount() - start, 2500, 1);
  EQUAL(nanosleep(&pause, 0), 0);
  EQUAL(nanosleep(&bad, 0), -1);
  clock_gettime(CLOCK_MONOTONIC, &b);
  NEAR((double)(b.tv_sec - a.tv_sec) + 1e-9 * (double)(b.tv_nsec - a.tv_nsec), 2.75, 0.001);
  b.tv_sec += 1;
  EQUAL(clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &b, 0), 0);
  NEAR(OSGetCount() - start, 3750, 1);
  gettimeofday(&t, 0);
  EQUAL(t.tv_sec, before + 3);
  EQUAL(poll(0, 0, 250), 0);
  NEAR(OSGetCount() - start, 4000, 1);
  EQUAL(select(0, 0, 0, 0, &timeout), 0);
  NEAR(OSGetCount() - start, 4400, 1);
  CHECK(timespec_get(&a, TIME_UTC) == TIME_UTC);
  EQUAL(a.tv_sec, before + 4);
  NEAR((double)clock() / CLOCKS_PER_SEC, 4.4, 0.01);
  /* Loops over clocks end. */
  while (time(0) < before + 5) {
  }
  NEAR(OSGetCount() - start, 5000, 1);
  signal(SIGALRM, ring);
  EQUAL(alarm(2), 0);
  OSWait(1000);
  EQUAL(alarm(2), 1);
  OSWait(5000);
  NEAR(rang - start, 8000, 2);
  getentropy(&random_bytes, sizeof(random_bytes));
  srand((unsigned)time(0));
  printf("%d %u\n", rand(), random_bytes);
  return failures;
}
