#include "soccer/last_touch.h"

namespace sandlot::soccer {
namespace {

/// @return whether it is the taker's second touch
bool touch(Touches& touches, const Rules& rules, Vec3 ball_m, Who who, bool counts_taker) {
  bool again = false;
  if (counts_taker) {
    if (!touches.taker) {
      touches.taker = who;
      touches.taken_m = ball_m;
    } else if (who == touches.taker) {
      if (!touches.others && touches.taker_since_s > rules.double_touch_s) again = true;
    } else {
      touches.others = true;
    }
    if (who == touches.taker) touches.taker_since_s = 0;
  }
  if (!(touches.holder == who)) {
    touches.holder = who;
    touches.got_m = ball_m;
  }
  touches.holder_since_s = 0;
  touches.last = who;
  touches.since_s = 0;
  return again;
}

}  // namespace

void forget_touches(Touches& touches, bool keep_last) {
  const Who last = touches.last;
  touches = {};
  if (keep_last) touches.last = last;
}

bool follow_touches(Touches& touches, const Rules& rules, const Input& input, bool counts_taker) {
  touches.since_s += input.dt_s;
  touches.taker_since_s += input.dt_s;
  touches.holder_since_s += input.dt_s;
  bool again = false;
  for (const SeenRobot& each : input.robots)
    if (each.holds_ball) again = touch(touches, rules, input.ball_m, each.who, counts_taker) || again;
  for (const BallTouch& each : input.touches)
    again = touch(touches, rules, input.ball_m, each.who, counts_taker) || again;
  if (touches.holder && touches.holder_since_s > rules.touch_gap_s) touches.holder = {};
  return again;
}

}  // namespace sandlot::soccer
