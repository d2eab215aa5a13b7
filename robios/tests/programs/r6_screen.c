#include "eyebot.h"

#include "check.h"

static image gray;
static colimage color;
static BYTE packed[1024];

int main() {
  int row, column, i;
  EQUAL(LCDInit(), 0);
  EQUAL(LCDRelease(), 0);
  EQUAL(LCDClear(), 0);
  EQUAL(LCDPrintf("a%d\n", 12), 0);
  EQUAL(LCDPutChar('c'), 0);
  EQUAL(LCDGetPos(&row, &column), 0);
  EQUAL(row, 1);
  EQUAL(column, 1);
  EQUAL(LCDSetChar(2, 15, 'x'), 0);
  EQUAL(LCDSetChar(2, 16, 'x'), 1);
  EQUAL(LCDSetPos(3, 0), 0);
  EQUAL(LCDSetPos(7, 0), 1); /* the menu's row */
  EQUAL(LCDPutString("text "), 0);
  EQUAL(LCDPutInt(-5), 0);
  EQUAL(LCDSetString(4, 0, "hex "), 0);
  EQUAL(LCDPutHex(0xBEEF), 0);
  EQUAL(LCDPutHex1(0x1234), 0);
  EQUAL(LCDSetString(40, 0, "x"), 1);
  LCDSetPos(5, 0);
  EQUAL(LCDPutIntS(42, 5), 0);
  EQUAL(LCDPutFloat(2.5f), 0);
  EQUAL(LCDPutFloatS(3.14159f, 6, 3), 0);
  EQUAL(LCDSetPrintf(0, 10, "%d", 99), 0);
  EQUAL(LCDSetPrintf(0, 16, "x"), 1);
  EQUAL(LCDMode(NOSCROLLING), 0);
  LCDSetString(6, 0, "wrap\n");
  LCDGetPos(&row, &column);
  EQUAL(row, 0);
  EQUAL(LCDMode(SCROLLING), 0);
  EQUAL(LCDMenu("GO", "LONGER", "", "END"), 0);
  EQUAL(LCDMenuI(3, "3rd"), 0);
  EQUAL(LCDMenu(" ", " ", " ", "END"), 0); /* leaves the others */
  EQUAL(LCDMenuI(0, "x"), 1);
  OSWait(10);
  printf("text\n");

  LCDClear();
  EQUAL(LCDGetPixel(10, 20), 0);
  EQUAL(LCDSetPixel(10, 20, 1), 0);
  EQUAL(LCDGetPixel(10, 20), 1);
  EQUAL(LCDSetPixel(10, 20, 2), 0);
  EQUAL(LCDGetPixel(10, 20), 0);
  EQUAL(LCDInvertPixel(10, 20), 0);
  EQUAL(LCDGetPixel(10, 20), 1);
  EQUAL(LCDSetPixel(64, 0, 1), 1);
  EQUAL(LCDSetPixel(0, 128, 1), 1);
  EQUAL(LCDInvertPixel(-1, 0), 1);
  EQUAL(LCDGetPixel(100, 100), 0);
  EQUAL(LCDLine(0, 30, 127, 30, 1), 0);
  EQUAL(LCDGetPixel(30, 64), 1);
  EQUAL(LCDLine(60, 30, 70, 30, 2), 0);
  EQUAL(LCDGetPixel(30, 64), 0);
  EQUAL(LCDLine(0, 0, 5, 5, 9), 1);
  EQUAL(LCDArea(100, 40, 110, 50, 1), 0);
  EQUAL(LCDGetPixel(45, 105), 1);
  EQUAL(LCDArea(0, 0, 2000000000, 2000000000, 2), 0);
  EQUAL(LCDGetPixel(45, 105), 0);
  EQUAL(LCDGetPixel(0, 0), 1);

  for (i = 0; i < 62 * 82; i++) (&gray[0][0])[i] = 200;
  gray[11][21] = 10;
  EQUAL(LCDPutGraphic(&gray), 0);
  EQUAL(LCDGetPixel(10, 20), 1);
  EQUAL(LCDGetPixel(10, 21), 0);
  color[5][7][0] = 255, color[5][7][1] = 255;
  EQUAL(LCDPutColorGraphic(&color), 0);
  EQUAL(LCDGetPixel(4, 6), 0); /* 510 / 3 = 170 is bright */
  EQUAL(LCDGetPixel(4, 7), 1);
  packed[16 * 3 + 2] = 0x81;
  EQUAL(LCDPutImage(packed), 0);
  EQUAL(LCDGetPixel(3, 16), 1);
  EQUAL(LCDGetPixel(3, 17), 0);
  EQUAL(LCDGetPixel(3, 23), 1);
  return failures;
}
