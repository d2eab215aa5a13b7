/* Checks of a test program: main returns the number of those that failed. */
#include <stdio.h>
static int failures = 0;
#define CHECK(x)                                         \
  do {                                                   \
    if (!(x)) {                                          \
      printf("%s:%d: not %s\n", __FILE__, __LINE__, #x); \
      failures++;                                        \
    }                                                    \
  } while (0)
#define EQUAL(a, b)                                                                     \
  do {                                                                                  \
    double a_ = (double)(a), b_ = (double)(b);                                          \
    if (a_ != b_) {                                                                     \
      printf("%s:%d: %s is %.9g, not %s = %.9g\n", __FILE__, __LINE__, #a, a_, #b, b_); \
      failures++;                                                                       \
    }                                                                                   \
  } while (0)
#define NEAR(a, b, by) CHECK((double)(a) - (double)(b) <= (by) && (double)(b) - (double)(a) <= (by))
