/* What must not hurt anybody else. */
#include "eyebot.h"

#include <string.h>
#include <sys/wait.h>

static int deep(int n) {
  volatile char room[1000];
  room[0] = (char)n;
  return deep(n + 1) + room[0];
}
static void *nothing(void *unused) { return unused; }
static void *thread_exit(void *unused) {
  (void)unused;
  OSWait(10);
  exit(9);
}

static void late(void) { OSWait(1000); }
__attribute__((destructor)) static void later(void) {
  for (;;) OSWait(1000);
}

int main(int argc, char **argv) {
  const char *what = argc > 1 ? argv[1] : "";
  static char text[5000];
  int i, id;
  pthread_t t;
  if (!strcmp(what, "recursion")) return deep(0);
  if (!strcmp(what, "null")) *(volatile int *)0 = 1;
  if (!strcmp(what, "abort")) abort();
  if (!strcmp(what, "zero")) return 100 / (argc - 2);
  if (!strcmp(what, "exit in thread")) {
    pthread_create(&t, 0, thread_exit, 0);
    pthread_join(t, 0);
  }
  if (!strcmp(what, "orders")) {
    for (i = 0; i < 100000; i++) VWSetSpeed(i % 100, 0);
    RADIOInit();
    memset(text, 'x', 1000);
    for (i = 0; i < 10000; i++) RADIOSend(0, text);
  }
  if (!strcmp(what, "lcd")) {
    memset(text, 'x', sizeof(text) - 1);
    LCDPrintf("%s", text);
    LCDSetPrintf(2147483647, -2147483647, "%s", text);
    LCDLine(-2147483647 - 1, -2147483647 - 1, 2147483647, 2147483647, RED);
    LCDLine(2147483647, -5, -2147483647 - 1, 2147483647, RED);
    LCDArea(-2147483647 - 1, 0, 2147483647, 2147483647, RED, 1);
    LCDCircle(2147483647, -2147483647 - 1, 2147483647, RED, 1);
    LCDMenu(text, text, 0, 0);
    for (i = -1000; i < 1000; i++) LCDPixel(i, -i * 100000, GREEN);
    LCDPrintf(0);
    for (i = 0; i < 256; i++) LCDPrintf("%c", i);
    LCDGetPos(0, 0);
    LCDGetSize(0, 0);
    VWGetPosition(0, 0, 0);
    SIMGetRobot(1, 0, 0, 0, 0);
    OSGetTime(0, 0, 0, 0);
    printf("survived\n");
  }
  if (!strcmp(what, "fork")) {
    id = fork();
    if (id == 0) {
      VWSetSpeed(100, 100);
      _exit(0); /* not reached: a fork has no robot */
    }
    waitpid(id, &i, 0);
    printf("child %d\n", WEXITSTATUS(i));
    OSWait(100);
  }
  if (!strcmp(what, "threads")) {
    for (i = 0; i < 1000; i++) {
      if (pthread_create(&t, 0, thread_exit, 0) != 0) break;
    }
    printf("%d threads\n", i);
  }
  if (!strcmp(what, "many")) { /* one after the other */
    for (i = 0; i < 5000; i++) {
      if (pthread_create(&t, 0, nothing, 0) != 0 || pthread_join(t, 0) != 0) break;
    }
    for (i = 0; i < 5000; i++) {
      if (pthread_create(&t, 0, nothing, 0) != 0 || pthread_detach(t) != 0) break;
      OSWait(1);
    }
    printf("%d threads\n", i);
  }
  if (!strcmp(what, "late")) {
    atexit(late);
    printf("ends\n");
    return 7;
  }
  if (!strcmp(what, "double free")) {
    char *volatile p = malloc(100);
    free(p);
    free(p);
  }
  if (!strcmp(what, "busy")) {
    for (;;) VWDone();
  }
  return 0;
}
