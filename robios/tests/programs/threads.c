/* pthreads and semaphores: one thread at a time, the same order in every run. */
#include "eyebot.h"

#include <errno.h>
#include <sched.h>
#include <string.h>
#include <time.h>

#include "check.h"

static pthread_mutex_t m = PTHREAD_MUTEX_INITIALIZER;
static pthread_cond_t cond = PTHREAD_COND_INITIALIZER;
static sem_t sem;
static int shared = 0, turns[2];

static void *worker(void *name) {
  int i;
  for (i = 0; i < 3; i++) {
    printf("%s%d ", (char *)name, i);
    sched_yield();
  }
  return (char *)name + 1;
}
static void run_yield(void) {
  pthread_t a, b;
  void *result;
  EQUAL(pthread_create(&a, 0, worker, "a"), 0);
  EQUAL(pthread_create(&b, 0, worker, "b"), 0);
  printf("main ");
  EQUAL(pthread_join(a, &result), 0);
  EQUAL(*(char *)result, 0);
  EQUAL(pthread_join(b, 0), 0);
  EQUAL(pthread_join(pthread_self(), 0), EDEADLK);
  printf("end\n");
}

/* Two threads that hold a lock over a slow call all the time: they take turns. */
static void *greedy(void *number) {
  int i;
  for (i = 0; i < 100; i++) {
    pthread_mutex_lock(&m);
    LCDClear();
    turns[*(int *)number]++;
    if (i == 60) CHECK(turns[0] - turns[1] < 30 && turns[1] - turns[0] < 30);
    pthread_mutex_unlock(&m);
  }
  return 0;
}
/* Who waits longest gets the lock, the semaphore: a, b, c, however many give way meanwhile. */
static void *queued(void *name) {
  sem_wait(&sem);
  printf("s%s ", (char *)name);
  pthread_mutex_lock(&m);
  printf("m%s ", (char *)name);
  pthread_mutex_unlock(&m);
  return 0;
}
static void run_queue(void) {
  pthread_t t[3];
  const char *names[3] = {"a", "b", "c"};
  int i;
  sem_init(&sem, 0, 0);
  for (i = 0; i < 3; i++) {
    pthread_create(&t[i], 0, queued, (void *)names[i]);
    usleep(1000);
  }
  pthread_mutex_lock(&m);
  for (i = 0; i < 3; i++) sem_post(&sem);
  usleep(1000);
  printf("all ");
  pthread_mutex_unlock(&m);
  for (i = 0; i < 3; i++) pthread_join(t[i], 0);
  printf("end\n");
}
static void run_mutex(void) {
  int zero = 0, one = 1;
  pthread_t a, b;
  pthread_mutex_t kind;
  pthread_mutexattr_t attributes;
  struct timespec until;
  pthread_create(&a, 0, greedy, &zero);
  pthread_create(&b, 0, greedy, &one);
  pthread_join(a, 0);
  pthread_join(b, 0);
  EQUAL(turns[0] + turns[1], 200);
  pthread_mutexattr_init(&attributes);
  pthread_mutexattr_settype(&attributes, PTHREAD_MUTEX_RECURSIVE);
  pthread_mutex_init(&kind, &attributes);
  EQUAL(pthread_mutex_lock(&kind), 0);
  EQUAL(pthread_mutex_lock(&kind), 0);
  EQUAL(pthread_mutex_unlock(&kind), 0);
  EQUAL(pthread_mutex_unlock(&kind), 0);
  EQUAL(pthread_mutex_unlock(&kind), EPERM);
  EQUAL(pthread_mutex_lock(&m), 0);
  EQUAL(pthread_mutex_trylock(&m), EBUSY);
  clock_gettime(CLOCK_REALTIME, &until);
  until.tv_sec++;
  zero = OSGetCount();
  EQUAL(pthread_mutex_timedlock(&m, &until), ETIMEDOUT);
  NEAR(OSGetCount() - zero, 1000, 1);
  EQUAL(pthread_mutex_destroy(&m), EBUSY);
  EQUAL(pthread_mutex_unlock(&m), 0);
  EQUAL(pthread_mutex_destroy(&m), 0);
  printf("end\n");
}

static void *consumer(void *unused) {
  (void)unused;
  pthread_mutex_lock(&m);
  while (shared < 3) {
    pthread_cond_wait(&cond, &m);
    printf("c%d ", shared);
  }
  pthread_mutex_unlock(&m);
  sem_post(&sem);
  pthread_exit(0);
}
static void run_cond(void) {
  pthread_t a;
  struct timespec until;
  int i, start;
  EQUAL(sem_init(&sem, 0, 0), 0);
  pthread_create(&a, 0, consumer, 0);
  EQUAL(pthread_detach(a), 0);
  for (i = 0; i < 3; i++) {
    OSWait(10);
    pthread_mutex_lock(&m);
    shared++;
    printf("p%d ", shared);
    if (i == 1) {
      EQUAL(pthread_cond_broadcast(&cond), 0);
    } else {
      EQUAL(pthread_cond_signal(&cond), 0);
    }
    pthread_mutex_unlock(&m);
  }
  EQUAL(sem_wait(&sem), 0);
  EQUAL(sem_trywait(&sem), -1);
  EQUAL(errno, EAGAIN);
  clock_gettime(CLOCK_REALTIME, &until);
  until.tv_sec += 2;
  start = OSGetCount();
  EQUAL(sem_timedwait(&sem, &until), -1);
  EQUAL(errno, ETIMEDOUT);
  NEAR(OSGetCount() - start, 2000, 1);
  until.tv_sec += 1;
  pthread_mutex_lock(&m);
  EQUAL(pthread_cond_timedwait(&cond, &m, &until), ETIMEDOUT);
  pthread_mutex_unlock(&m);
  NEAR(OSGetCount() - start, 3000, 1);
  sem_post(&sem);
  sem_post(&sem);
  sem_getvalue(&sem, &i);
  EQUAL(i, 2);
  sem_destroy(&sem);
  pthread_cond_destroy(&cond);
  printf("end\n");
}

/* Slices: two threads that never wait. */
static int calls[2], last = -1;
static void *busy(void *number) {
  const int me = *(int *)number;
  for (; calls[me] < 500; calls[me]++) {
    if (last != me) {
      last = me;
      printf("%c%d ", 'a' + me, calls[me]);
    }
    LCDSetPos(0, 0); /* 20 us */
    OSGetCount();    /* 10 us */
    LCDPixel(0, 0, RED);
    KEYRead(); /* 50 us: 90 us in all */
    OSGetCount();
  }
  return 0;
}
static void run_slices(void) {
  int zero = 0, one = 1;
  pthread_t a, b;
  pthread_create(&a, 0, busy, &zero);
  pthread_create(&b, 0, busy, &one);
  pthread_join(a, 0);
  pthread_join(b, 0);
  printf("end\n");
}

static pthread_rwlock_t lock = PTHREAD_RWLOCK_INITIALIZER;
static pthread_barrier_t barrier;
static pthread_once_t once = PTHREAD_ONCE_INIT;
static pthread_spinlock_t spin;
static int firsts = 0, serial = 0;
static void first(void) {
  OSWait(20);
  firsts++;
}
static void cleanup(void *text) { printf("%s ", (char *)text); }
static void *meets(void *unused) {
  (void)unused;
  pthread_once(&once, first);
  EQUAL(firsts, 1);
  if (pthread_barrier_wait(&barrier) == PTHREAD_BARRIER_SERIAL_THREAD) serial++;
  EQUAL(pthread_rwlock_rdlock(&lock), 0);
  OSWait(10);
  pthread_rwlock_unlock(&lock);
  pthread_spin_lock(&spin);
  shared++;
  OSWait(5);
  pthread_spin_unlock(&spin);
  return 0;
}
static void *waits(void *unused) {
  (void)unused;
  pthread_cleanup_push(cleanup, "cleaned");
  OSWait(1000000);
  pthread_cleanup_pop(1);
  return 0;
}
static void run_others(void) {
  pthread_t t[3];
  int i;
  void *result = 0;
  shared = 0;
  EQUAL(pthread_barrier_init(&barrier, 0, 3), 0);
  EQUAL(pthread_spin_init(&spin, 0), 0);
  for (i = 0; i < 3; i++) pthread_create(&t[i], 0, meets, 0);
  for (i = 0; i < 3; i++) EQUAL(pthread_join(t[i], 0), 0);
  EQUAL(serial, 1);
  EQUAL(shared, 3);
  EQUAL(pthread_rwlock_wrlock(&lock), 0);
  EQUAL(pthread_rwlock_trywrlock(&lock), EBUSY);
  EQUAL(pthread_rwlock_tryrdlock(&lock), EBUSY);
  EQUAL(pthread_rwlock_unlock(&lock), 0);
  EQUAL(pthread_rwlock_tryrdlock(&lock), 0);
  EQUAL(pthread_rwlock_tryrdlock(&lock), 0);
  EQUAL(pthread_rwlock_trywrlock(&lock), EBUSY);
  EQUAL(pthread_spin_trylock(&spin), 0);
  EQUAL(pthread_spin_trylock(&spin), EBUSY);
  EQUAL(pthread_barrier_destroy(&barrier), 0);
  pthread_create(&t[0], 0, waits, 0);
  OSWait(100);
  EQUAL(pthread_cancel(t[0]), 0);
  EQUAL(pthread_join(t[0], &result), 0);
  CHECK(result == PTHREAD_CANCELED);
  EQUAL(pthread_cancel(t[0]), ESRCH);
  printf("end\n");
}

/* main ends by pthread_exit: the program when its last thread does. */
static void *late(void *unused) {
  (void)unused;
  OSWait(300);
  printf("late %d\n", OSGetCount());
  return 0;
}
static void *leaves(void *unused) {
  (void)unused;
  OSWait(50);
  exit(6);
}

int main(int argc, char **argv) {
  const char *what = argc > 1 ? argv[1] : "";
  pthread_t t;
  if (!strcmp(what, "yield")) run_yield();
  if (!strcmp(what, "mutex")) run_mutex();
  if (!strcmp(what, "queue")) run_queue();
  if (!strcmp(what, "cond")) run_cond();
  if (!strcmp(what, "slices")) run_slices();
  if (!strcmp(what, "others")) run_others();
  if (!strcmp(what, "late")) {
    pthread_create(&t, 0, late, 0);
    pthread_exit(0);
  }
  if (!strcmp(what, "exit")) {
    pthread_create(&t, 0, leaves, 0);
    for (;;) KEYRead();
  }
  if (!strcmp(what, "stuck")) {
    pthread_mutex_lock(&m);
    pthread_mutex_lock(&m);
  }
  return failures;
}
