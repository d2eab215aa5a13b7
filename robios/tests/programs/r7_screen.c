#include "eyebot.h"

#include "check.h"

static BYTE picture[40 * 30 * 3], gray[40 * 30], bits[40 * 30], large[QQVGA_SIZE];

int main() {
  int x, y, row, column, i;
  EQUAL(LCDGetSize(&x, &y), 0);
  EQUAL(x, 320);
  EQUAL(y, 480);
  EQUAL(LCDSetColor(RED, BLUE), 0);
  EQUAL(LCDInit(), 0);
  EQUAL(LCDRelease(), 0);
  EQUAL(LCDClear(), 0);
  EQUAL(LCDGetPixel(5, 5), BLUE);
  /* Text: cells of 8 x 16. '|' has ink in the middle of its cell: column 1 + 2. */
  EQUAL(LCDSetPos(2, 10), 0);
  EQUAL(LCDPrintf("|%s", "a"), 0);
  EQUAL(LCDGetPixel(83, 33), RED);
  EQUAL(LCDGetPixel(82, 33), BLUE);
  EQUAL(LCDGetPos(&row, &column), 0);
  EQUAL(row, 2);
  EQUAL(column, 12);
  EQUAL(LCDSetPrintf(4, 0, "n = %d\nnext", 42), 0);
  LCDGetPos(&row, &column);
  EQUAL(row, 5);
  EQUAL(column, 4);
  EQUAL(LCDSetPos(29, 0), 1); /* the menu's */
  EQUAL(LCDSetPos(0, 40), 1);
  EQUAL(LCDSetPos(-1, 0), 1);
  EQUAL(LCDSetPrintf(100, 0, "x"), 1);
  /* Bold is one pixel wider. */
  EQUAL(LCDSetFont(HELVETICA, BOLD), 0);
  LCDSetPrintf(6, 0, "|");
  EQUAL(LCDGetPixel(3, 97), RED);
  EQUAL(LCDGetPixel(4, 97), RED);
  EQUAL(LCDSetFont(7, 0), 1);
  EQUAL(LCDSetFont(TIMES, NORMAL), 0);
  /* Large: cells of 18 x 24, glyphs tripled, 1 + 2 * 3 on. */
  EQUAL(LCDSetFontSize(24), 0);
  LCDSetPrintf(6, 1, "|");
  EQUAL(LCDGetPixel(18 + 1 + 6, 145), RED);
  EQUAL(LCDGetPixel(18 + 1 + 8, 145), RED);
  EQUAL(LCDGetPixel(18 + 1 + 9, 145), BLUE);
  EQUAL(LCDSetFontSize(13), 1);
  /* A row that large characters have not. */
  LCDSetFontSize(8);
  EQUAL(LCDSetPos(50, 0), 0);
  LCDSetFontSize(24);
  LCDGetPos(&row, &column);
  EQUAL(row, 18); /* 464 / 24 rows */
  EQUAL(LCDSetFontSize(12), 0);
  /* Without scrolling the first row follows the last. */
  LCDSetPos(10, 0);
  LCDSetMode(NOLINEFEED);
  LCDPrintf("a\nb");
  LCDGetPos(&row, &column);
  EQUAL(row, 10);
  EQUAL(column, 2);
  LCDSetMode(LINEFEED);
  EQUAL(LCDSetMode(NOSCROLLING), 0);
  LCDSetPrintf(28, 0, "last\n");
  LCDGetPos(&row, &column);
  EQUAL(row, 0);
  LCDSetMode(SCROLLING);
  LCDSetPrintf(28, 0, "last\n");
  LCDGetPos(&row, &column);
  EQUAL(row, 28);

  EQUAL(LCDPixel(7, 300, GREEN), 0);
  EQUAL(LCDGetPixel(7, 300), GREEN);
  EQUAL(LCDPixel(320, 0, GREEN), 1);
  EQUAL(LCDPixel(0, -1, GREEN), 1);
  EQUAL(LCDGetPixel(1000, 1000), 0);
  EQUAL(LCDLine(10, 200, 13, 206, WHITE), 0);
  EQUAL(LCDGetPixel(10, 200), WHITE);
  EQUAL(LCDGetPixel(13, 206), WHITE);
  EQUAL(LCDGetPixel(11, 202), WHITE);
  EQUAL(LCDGetPixel(13, 200), BLUE);
  EQUAL(LCDLine(-2000000000, 210, 2000000000, 210, WHITE), 0);
  EQUAL(LCDGetPixel(0, 210), WHITE);
  EQUAL(LCDGetPixel(319, 210), WHITE);
  EQUAL(LCDArea(100, 200, 110, 205, YELLOW, 0), 0);
  EQUAL(LCDGetPixel(100, 203), YELLOW);
  EQUAL(LCDGetPixel(101, 203), BLUE);
  EQUAL(LCDArea(110, 205, 100, 200, OLIVE, 1), 0);
  EQUAL(LCDGetPixel(101, 203), OLIVE);
  EQUAL(LCDArea(-2147483647, 400, 2147483647, 401, NAVY, 1), 0);
  EQUAL(LCDGetPixel(160, 400), NAVY);
  EQUAL(LCDCircle(200, 300, 10, CYAN, 0), 0);
  EQUAL(LCDGetPixel(210, 300), CYAN);
  EQUAL(LCDGetPixel(211, 300), BLUE);
  EQUAL(LCDGetPixel(200, 300), BLUE);
  EQUAL(LCDCircle(200, 300, 10, TEAL, 1), 0);
  EQUAL(LCDGetPixel(200, 300), TEAL);
  EQUAL(LCDCircle(0, 0, 2000000000, MAROON, 0), 0);
  EQUAL(LCDCircle(0, 0, -1, MAROON, 0), 1);

  for (i = 0; i < 1200; i++) {
    picture[3 * i] = (BYTE)(i % 40);
    picture[3 * i + 1] = (BYTE)(i / 40);
    picture[3 * i + 2] = 9;
    gray[i] = (BYTE)(i % 40);
    bits[i] = i % 2;
  }
  EQUAL(LCDImageStart(10, 350, 40, 30), 0);
  EQUAL(LCDImage(picture), 0);
  EQUAL(LCDGetPixel(10 + 3, 350 + 2), 3 << 16 | 2 << 8 | 9);
  EQUAL(LCDImageStart(60, 350, 40, 30), 0);
  EQUAL(LCDImageGray(gray), 0);
  EQUAL(LCDGetPixel(60 + 3, 350 + 2), 0x030303);
  EQUAL(LCDImageStart(110, 350, 40, 30), 0);
  EQUAL(LCDImageBinary(bits), 0);
  EQUAL(LCDGetPixel(110, 350), BLACK);
  EQUAL(LCDGetPixel(111, 350), WHITE);
  EQUAL(LCDImageStart(310, 470, 40, 30), 0); /* half outside */
  EQUAL(LCDImage(picture), 0);
  EQUAL(LCDGetPixel(319, 479), 9 << 16 | 9 << 8 | 9);
  EQUAL(LCDImageStart(0, 0, -4, 30), 1);
  EQUAL(LCDImageSize(QQVGA), 0);
  large[0] = 200;
  EQUAL(LCDImage(large), 0);
  EQUAL(LCDGetPixel(0, 0), 200 << 16); /* in the corner */
  EQUAL(LCDImageSize(99), 1);

  EQUAL(LCDMenu("ONE", "TWO", "", "FOUR"), 0);
  EQUAL(LCDMenu(" ", " ", "THREE", " "), 0);
  EQUAL(LCDMenuI(2, "2", WHITE, RED), 0);
  EQUAL(LCDGetPixel(81, 479), RED);
  EQUAL(LCDMenuI(5, "5", WHITE, RED), 1);
  /* What is drawn without refreshing appears with LCDRefresh. */
  OSWait(100);
  LCDSetMode(NOAUTOREFRESH);
  LCDPixel(0, 0, WHITE);
  OSWait(100);
  printf("drawn\n");
  OSWait(200);
  EQUAL(LCDRefresh(), 0);
  OSWait(100);
  return failures;
}
