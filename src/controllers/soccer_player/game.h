#pragma once
/// How the game stands, from the referee's messages.
#include <string_view>

#include "controllers/soccer_player/beliefs.h"
#include "messages/messages.h"

namespace sandlot::controllers::soccer_player {

/// Takes a state of the game over. @param team  own team's name
void hear_state(Game& game, const msg::RefereeState& state, std::string_view team, Vec3 ball, double now_s);
/// Takes a command over, for links that send commands alone.
void hear_command(Game& game, const msg::RefereeCommand& command, std::string_view team, std::int32_t number,
                  Vec3 ball, double now_s);
/// Follows the ball to its spot while a set piece is prepared; the mean of many sightings is steadier than one.
void settle(Game& game, Vec3 ball);
/// Whether the ball may be played freely: play runs and the set piece is taken, by who had it, 7 s passed, or the ball moved.
bool is_open(const Game& game, Vec3 ball, double now_s);

}  // namespace sandlot::controllers::soccer_player
