/* Wander: drive ahead until something is near, go back a little, turn away, and so on.
 *
 * Robot:  two wheels, PSDs in front, on the left and on the right (LabBot, S4).
 * Result: the robot keeps moving and touches nothing; the screen counts its turns. KEY4 ends the program. */
#include "eyebot.h"

#define SPEED 250    /* mm/s */
#define SAFE_MM 250  /* room in front of the robot */
#define SIDE_MM 80   /* and beside it */
#define BACK_MM 40

int main(void) {
  int turns = 0;
  LCDMenu("", "", "", "END");
  while (KEYRead() != KEY4) {
    int front = PSDGet(PSD_FRONT), left = PSDGet(PSD_LEFT), right = PSDGet(PSD_RIGHT);
    LCDSetPrintf(0, 0, "left  %5d mm", left);
    LCDSetPrintf(1, 0, "front %5d mm", front);
    LCDSetPrintf(2, 0, "right %5d mm", right);
    LCDSetPrintf(3, 0, "turns %5d", turns);
    if (front > SAFE_MM && left > SIDE_MM && right > SIDE_MM) {
      VWSetSpeed(SPEED, 0);
    } else {
      int angle = 60 + rand() % 90; /* degrees, to the side with more room */
      VWStraight(-BACK_MM, SPEED);
      VWWait();
      VWTurn(left > right ? angle : -angle, 120);
      VWWait();
      turns++;
      printf("turn %d\n", turns);
    }
    OSWait(50);
  }
  VWSetSpeed(0, 0);
  return 0;
}
