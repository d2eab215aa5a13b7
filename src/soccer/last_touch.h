#pragma once
/// Last touch: who touched the ball last, who took the set piece, and who keeps the ball.
#include "soccer/set_pieces.h"

namespace sandlot::soccer {

/// Begins anew at a restart.
/// @param keep_last  whether who touched last is still known
void forget_touches(Touches& touches, bool keep_last);

/// Takes over the touches of a tick.
/// @param taking  the ball may only be played by `team` now, whose first touch makes it the taker; any robot's at a dropped ball
/// @return whether the taker touched again although nobody else did in between
bool follow_touches(Touches& touches, const Rules& rules, const Input& input, bool counts_taker);

}  // namespace sandlot::soccer
