/* Mecanum drive by its four motors: each alone, which measures the columns of the matrix, and all. Front left, front right, back
 * left, back right. */
#include "motions.h"

int main(void) {
  static const int alone[4][4] = {{20, 0, 0, 0}, {0, 20, 0, 0}, {0, 0, 20, 0}, {0, 0, 0, 20}};
  static const int ahead[] = {20, 20, 20, 20}, left[] = {-20, 20, 20, -20}, turn[] = {-20, 20, -20, 20}, mixed[] = {5, 30, 15, 20};
  motion("FL_alone", 4, alone[0]);
  motion("FR_alone", 4, alone[1]);
  motion("BL_alone", 4, alone[2]);
  motion("BR_alone", 4, alone[3]);
  motion("straight", 4, ahead);
  motion("sideways", 4, left);
  motion("turn", 4, turn);
  motion("mixed", 4, mixed);
  return 0;
}
