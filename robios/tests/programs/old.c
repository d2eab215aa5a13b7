/* Old C, without headers for what it calls. */
#include "eyebot.h"
#include <time.h>
int limit;
show(n, name)
int n;
char *name;
{
  LCDPrintf("%s %d\n", name, n);
  return n;
}
main() {
  int k, n = 0;
  srand(time(0));
  LCDMenu("A", "B", "C", "END");
  limit = 10;
  do {
    k = KEYRead();
    n++;
    if (n < limit) show(n, "loop");
  } while (k != KEY4);
  printf("%d loops\n", n > 1000);
  sleep(1);
  printf("no newline");
  return rand() % 1 + helper(2);
}
helper(x) { return x * 2; }
