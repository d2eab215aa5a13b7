#include "eyebot.h"

#include "check.h"

static BYTE rgb[QVGA_SIZE + 8], other[QVGA_SIZE + 8], a[QVGA_PIXELS], b[QVGA_PIXELS], c[QVGA_PIXELS];

int main() {
  BYTE h, s, i, r, g, bl;
  int k;
  COLOR color;
  EQUAL(CAMInit(42), 1);
  EQUAL(CAMInit(QVGA), 0);
  EQUAL(CAMWIDTH, 320);
  EQUAL(CAMSIZE, 230400);
  EQUAL(IP_PIXELS, 76800);
  rgb[QVGA_SIZE] = 77;
  k = OSGetCount();
  EQUAL(CAMGet(rgb), 0);
  CHECK(OSGetCount() >= k + 20);
  /* The fake picture is 640 x 480, red = column / 4, green = row / 4, blue = 7. */
  EQUAL(rgb[0], 0);
  EQUAL(rgb[(100 * 320 + 200) * 3], 100);
  EQUAL(rgb[(100 * 320 + 200) * 3 + 1], 50);
  EQUAL(rgb[(100 * 320 + 200) * 3 + 2], 7);
  EQUAL(rgb[QVGA_SIZE], 77);
  EQUAL(CAMGetGray(a), 0);
  EQUAL(a[100 * 320 + 200], (100 + 50 + 7) / 3);
  EQUAL(CAMGet(0), 1);

  EQUAL(CAMInit(QQVGA), 0);
  EQUAL(CAMGet(rgb), 0);
  EQUAL(rgb[(50 * 160 + 100) * 3], 100); /* mean of columns 400 to 403 */
  EQUAL(LCDImage(rgb), 0); /* CAMInit has set its size */
  EQUAL(LCDGetPixel(100, 50), 100 << 16 | 50 << 8 | 7);
  EQUAL(IPSetSize(QQVGA), 0);
  EQUAL(IPSetSize(-1), 1);
  EQUAL(IP_WIDTH, 160);

  IPCol2Gray(rgb, a);
  EQUAL(a[50 * 160 + 100], (100 + 50 + 7) / 3);
  memset(a, 0, QQVGA_PIXELS);
  a[10 * 160 + 20] = 10;
  IPLaplace(a, b);
  EQUAL(b[10 * 160 + 20], 40);
  EQUAL(b[10 * 160 + 21], 10);
  EQUAL(b[11 * 160 + 21], 0);
  IPSobel(a, b);
  EQUAL(b[10 * 160 + 20], 0);
  EQUAL(b[10 * 160 + 21], 20);
  EQUAL(b[11 * 160 + 21], 20); /* |1| + |1| times 10 */
  EQUAL(b[11 * 160 + 20], 20);
  IPLaplace(a, a); /* into itself */
  EQUAL(a[10 * 160 + 19], 10);
  a[5] = 33;
  IPGray2Col(a, rgb);
  EQUAL(rgb[15], 33);
  EQUAL(rgb[17], 33);
  a[0] = 1, b[0] = 2, c[0] = 3;
  IPRGB2Col(a, b, c, rgb);
  EQUAL(rgb[0], 1);
  EQUAL(rgb[1], 2);
  EQUAL(rgb[2], 3);
  memset(rgb, 0, QQVGA_SIZE);
  rgb[0] = 200; /* red */
  rgb[4] = 100; /* green */
  IPCol2HSI(rgb, a, b, c);
  EQUAL(a[0], 0);
  EQUAL(b[0], 255);
  EQUAL(c[0], 66);
  EQUAL(a[1], 85);
  EQUAL(a[2], 0);
  memset(other, 0, QQVGA_SIZE);
  other[5] = 9;
  rgb[3] = 1;
  IPOverlay(rgb, other, rgb);
  EQUAL(rgb[0], 200);
  EQUAL(rgb[3], 0);
  EQUAL(rgb[5], 9);
  memset(a, 50, QQVGA_PIXELS);
  memset(b, 0, QQVGA_PIXELS);
  b[3] = 1;
  IPOverlayGray(a, b, ORANGE, rgb);
  EQUAL(rgb[6], 50);
  EQUAL(rgb[9], 0xFF);
  EQUAL(rgb[10], 0xA5);
  EQUAL(rgb[11], 0);

  color = IPPRGB2Col(1, 2, 3);
  EQUAL(color, 0x010203);
  IPPCol2RGB(color, &r, &g, &bl);
  EQUAL(r, 1);
  EQUAL(g, 2);
  EQUAL(bl, 3);
  IPPCol2HSI(BLUE, &h, &s, &i);
  EQUAL(h, 171); /* 240 degrees * 256 / 360 = 170.67 */
  EQUAL(s, 255);
  EQUAL(i, 85);
  EQUAL(IPPRGB2Hue(100, 100, 100), 0);
  EQUAL(IPPRGB2Hue(255, 255, 0), 43); /* 60 degrees */
  IPPRGB2HSI(100, 100, 100, &h, &s, &i);
  EQUAL(s, 0);
  EQUAL(i, 100);

  EQUAL(IPWriteFile("test.ppm", rgb), 0);
  EQUAL(IPReadFile("test.ppm", other), 3);
  CHECK(memcmp(rgb, other, QQVGA_SIZE) == 0);
  EQUAL(IPWriteFileGray("test.pgm", a), 0);
  EQUAL(IPReadFile("test.pgm", b), 2);
  CHECK(memcmp(a, b, QQVGA_PIXELS) == 0);
  EQUAL(IPWriteFile("no/such/folder/x.ppm", rgb), 1);
  EQUAL(IPReadFile("nothing.pgm", b), -1);
  IPSetSize(QVGA);
  EQUAL(IPReadFile("test.pgm", b), 2); /* filled to 320 x 240 */
  EQUAL(b[100 * 320 + 159], 50);
  EQUAL(b[100 * 320 + 160], 0);
  EQUAL(b[120 * 320], 0);
  IPSetSize(QQVGA);
  {
    FILE *f = fopen("test.pbm", "w");
    fprintf(f, "P1 # comment\n160 120\n");
    for (k = 0; k < QQVGA_PIXELS; k++) fputs(k == 2 ? "1 " : "0 ", f);
    fclose(f);
    EQUAL(IPReadFile("test.pbm", b), 1);
    EQUAL(b[2], 0);
    EQUAL(b[3], 1);
    f = fopen("test.pbm", "w");
    fprintf(f, "P5\n160 120\n255\nshort");
    fclose(f);
    EQUAL(IPReadFile("test.pbm", b), -1);
    f = fopen("test.pbm", "w");
    fprintf(f, "P2\n160 120\n100\n");
    for (k = 0; k < QQVGA_PIXELS; k++) fputs(k == 2 ? "50 " : "100 ", f);
    fclose(f);
    EQUAL(IPReadFile("test.pbm", b), 2);
    EQUAL(b[2], 127); /* of 255 */
    EQUAL(b[3], 255);
  }
  remove("test.ppm");
  remove("test.pgm");
  remove("test.pbm");
  EQUAL(CAMRelease(), 0);
  EQUAL(CAMRelease(), 1);
  return failures;
}
