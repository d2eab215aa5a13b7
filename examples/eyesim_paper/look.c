/* Takes a picture once a second and shows it on the whole screen. Prints "looks" with each. */
#include "eyebot.h"

static BYTE picture[QVGA_SIZE];

int main(void) {
  CAMInit(QVGA);
  LCDImageStart(0, 0, QVGA_X, QVGA_Y);
  for (;;) {
    CAMGet(picture);
    LCDImage(picture);
    printf("looks\n");
    OSWait(1000);
  }
}
