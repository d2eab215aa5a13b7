#include "base/math.h"

#include <sleef.h>

namespace sandlot::math {

double sin(double rad) { return Sleef_cinz_sind1_u10purec(rad); }
double cos(double rad) { return Sleef_cinz_cosd1_u10purec(rad); }
SinCos sincos(double rad) {
  const Sleef_double_2 r = Sleef_cinz_sincosd1_u10purec(rad);
  return {r.x, r.y};
}
double tan(double rad) { return Sleef_cinz_tand1_u10purec(rad); }
double asin(double x) { return Sleef_cinz_asind1_u10purec(x); }
double acos(double x) { return Sleef_cinz_acosd1_u10purec(x); }
double atan(double x) { return Sleef_cinz_atand1_u10purec(x); }
double atan2(double y, double x) { return Sleef_cinz_atan2d1_u10purec(y, x); }
double exp(double x) { return Sleef_cinz_expd1_u10purec(x); }
double log(double x) { return Sleef_cinz_logd1_u10purec(x); }
double pow(double x, double y) { return Sleef_cinz_powd1_u10purec(x, y); }
double hypot(double x, double y) { return Sleef_cinz_hypotd1_u05purec(x, y); }
double tanh(double x) { return Sleef_cinz_tanhd1_u10purec(x); }
double fmod(double x, double y) { return Sleef_cinz_fmodd1_purec(x, y); }

double wrap_angle(double rad) {
  if (rad > -pi && rad <= pi) return rad;
  double r = fmod(rad, tau);
  if (r > pi) r -= tau;
  if (r <= -pi) r += tau;
  return r;
}

}  // namespace sandlot::math
