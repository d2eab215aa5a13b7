#include "eyebot.h"

#include "check.h"

static image a, b, c;
static colimage color;
static BYTE flat[80 * 60 * 3 + 1];

int main() {
  int x, y, z, i;
  EQUAL(CAMGetFrame(&a), 1); /* not initialised */
  EQUAL(CAMInit(9), INITERROR);
  CHECK(CAMInit(NORMAL) >= 16);
  /* The fake picture is 640 x 480, red = column / 4, green = row / 4, blue = 7; 8 x 8 of it make a pixel. */
  EQUAL(CAMGetColFrame(&color, 0), 0);
  EQUAL(color[1 + 30][1 + 50][0], 101); /* columns 400 to 407: mean 100.5 */
  EQUAL(color[1 + 30][1 + 50][1], 61);
  EQUAL(color[1 + 30][1 + 50][2], 7);
  EQUAL(color[0][5][0], 0);
  EQUAL(CAMGetFrame(&a), 0);
  EQUAL(a[1 + 30][1 + 50], (101 + 61 + 7) / 3);
  EQUAL(a[61][81], 0);
  EQUAL(CAMGetColFrame((colimage *)&b, 1), 0);
  EQUAL(b[31][51], a[31][51]);
  flat[80 * 60 * 3] = 99;
  EQUAL(CAMGetFrameRGB(flat), 0);
  EQUAL(flat[(30 * 80 + 50) * 3], 101);
  EQUAL(flat[80 * 60 * 3], 99);
  EQUAL(CAMGetFrameMono(flat), 0);
  EQUAL(flat[30 * 80 + 50], 56);
  EQUAL(CAMGetFrameBayer(flat), 0);
  EQUAL(flat[30 * 80 + 50], 61);  /* green */
  EQUAL(flat[30 * 80 + 51], 103); /* red of the next column: 408 to 415, 102.5 */
  EQUAL(flat[31 * 80 + 50], 7);   /* blue */
  EQUAL(CAMSet(1, 2, 3), 0);
  EQUAL(CAMGet(&x, &y, &z), 0);
  EQUAL(x * 100 + y * 10 + z, 123);
  EQUAL(CAMMode(NOAUTOBRIGHTNESS), 0);
  EQUAL(CAMMode(55), 1);
  EQUAL(CAMRelease(), 0);
  EQUAL(CAMRelease(), 1);

  for (i = 0; i < 62 * 82; i++) (&a[0][0])[i] = 0;
  a[30][40] = 10;
  EQUAL(IPLaplace(&a, &b), 0);
  EQUAL(b[30][40], 40);
  EQUAL(b[31][40], 10);
  EQUAL(IPSobel(&a, &b), 0);
  EQUAL(b[30][41], 20);
  EQUAL(b[0][0], 0);
  EQUAL(IPDiffer(&a, &b, &c), 0);
  EQUAL(c[30][41], 20);
  EQUAL(c[30][40], 10);
  a[2][2] = 120, a[2][3] = 120, a[3][2] = 120, a[3][3] = 120; /* two of four thresholds are below */
  EQUAL(IPDither(&a, &b), 0);
  EQUAL(b[2][2], 255);
  EQUAL(b[2][3], 0);
  EQUAL(b[3][2], 0);
  EQUAL(b[3][3], 255);
  EQUAL(IPColor2Grey(&color, &a), 0);
  EQUAL(a[31][51], 56);
  return failures;
}
