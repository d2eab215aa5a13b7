/* Search a ball by its colour and drive up to it.
 *
 * Robot:  two wheels, a camera, a PSD in front (LabBot).
 * Result: the robot stands in front of the ball, 60 mm away, looks at it, beeps and prints "found". The screen shows what the camera sees, and
 *         below it the histogram: the number of ball pixels in each column. */
#include "eyebot.h"

#define WIDTH QQVGA_X
#define HEIGHT QQVGA_Y
#define BOTTOM 220       /* row of the screen where the histogram stands */
#define BALL_HUE 17     /* orange: 24 degrees; 256 are a whole turn */
#define TOLERANCE 8
#define ENOUGH 2        /* pixels in a column */
#define STOP_MM 60
#define SLOW_MM 400
#define FIELD_OF_VIEW 60 /* degrees across the picture */

static BYTE picture[QQVGA_SIZE], hue[QQVGA_PIXELS], saturation[QQVGA_PIXELS], intensity[QQVGA_PIXELS];

/* Ball pixels in each column. Returns the column in the middle of them, or -1 without a ball. */
static int find_ball(int histogram[WIDTH]) {
  int x, y, sum = 0, moment = 0;
  IPCol2HSI(picture, hue, saturation, intensity);
  for (x = 0; x < WIDTH; x++) {
    histogram[x] = 0;
    for (y = 0; y < HEIGHT; y++) {
      int i = y * WIDTH + x;
      if (abs(hue[i] - BALL_HUE) <= TOLERANCE && saturation[i] > 180 && intensity[i] > 50) histogram[x]++;
    }
    if (histogram[x] >= ENOUGH) {
      sum += histogram[x];
      moment += histogram[x] * x;
    }
  }
  return sum > 0 ? moment / sum : -1;
}

static void show(const int histogram[WIDTH], int column) {
  int x;
  LCDImage(picture);
  LCDArea(0, HEIGHT, WIDTH - 1, BOTTOM, BLACK, 1);
  for (x = 0; x < WIDTH; x++) LCDLine(x, BOTTOM, x, BOTTOM - histogram[x], ORANGE);
  if (column >= 0) LCDLine(column, 0, column, BOTTOM, WHITE);
}

int main(void) {
  int histogram[WIDTH], column, front, seen = 0;
  CAMInit(QQVGA);
  LCDImageSize(QQVGA);
  for (;;) {
    CAMGet(picture);
    column = find_ball(histogram);
    show(histogram, column);
    front = PSDGet(PSD_FRONT);
    if (column < 0) {
      VWSetSpeed(0, 40); /* look around */
      LCDSetPrintf(0, 21, "search           ");
      continue;
    }
    if (!seen++) printf("seen\n");
    /* The ball is at this angle, to the left if positive; turn towards it within about half a second. */
    int angle = (WIDTH / 2 - column) * FIELD_OF_VIEW / WIDTH;
    int facing = abs(angle) < 8;
    LCDSetPrintf(0, 21, "%4d deg %4d mm", angle, front);
    if (facing && front <= STOP_MM + 10) break;
    VWSetSpeed(!facing ? 0 : front < SLOW_MM ? 20 + (front - STOP_MM) / 2 : 200, 2 * angle);
  }
  VWSetSpeed(0, 0);
  AUBeep();
  printf("found, %d mm ahead\n", PSDGet(PSD_FRONT));
  return 0;
}
