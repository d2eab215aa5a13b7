/* Distance sensor: the robot stands in front of a wall and takes N readings, one in each time slot. Prints "psd N MEAN DEVIATION", and
 * "bin MM COUNT" for each value. */
#include "eyebot.h"

#define N 1000
#define MOST 2000

static int count[MOST];

int main(void) {
  int i;
  double mean = 0, squares = 0;
  OSWait(200);
  for (i = 1; i <= N; i++) {
    int mm = PSDGet(PSD_FRONT);
    double apart = mm - mean;
    if (mm < 0 || mm >= MOST) return 1;
    count[mm]++;
    mean += apart / i;
    squares += apart * (mm - mean);
    OSWait(50);
  }
  printf("psd %d %.6f %.6f\n", N, mean, sqrt(squares / (N - 1)));
  for (i = 0; i < MOST; i++)
    if (count[i] > 0) printf("bin %d %d\n", i, count[i]);
  return 0;
}
