/* Differential drive by its two motors: each alone, which measures the columns of the matrix, and both. */
#include "motions.h"

int main(void) {
  static const int left[] = {20, 0}, right[] = {0, 20}, ahead[] = {20, 20}, turn[] = {-15, 15}, arc[] = {10, 25};
  motion("left_alone", 2, left);
  motion("right_alone", 2, right);
  motion("straight", 2, ahead);
  motion("turn", 2, turn);
  motion("arc", 2, arc);
  return 0;
}
