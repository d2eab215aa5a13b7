#pragma once
/// The packet by which players of a team tell each other what they believe: 32 bytes, little endian.
///
///   'S' 'P' version number role flags | at, target, ball: x y each, velocity, ball velocity: x y each, in steps of 2 mm and 2 mm/s as int16 |
///   ball's standard deviation [cm], ball's age [10 ms], cost [10 ms], clamped to 0..65535 | heading is not told
///
/// Errors   what has another size, version or a number outside 1..99 is no packet.
/// Limits   fields longer than 65 m do not fit: places are clamped.
#include <optional>
#include <span>

#include "controllers/soccer_player/beliefs.h"

namespace sandlot::controllers::soccer_player {

/// Fills `out` anew. @param now_s  ages are told, not times
void write_packet(std::vector<std::uint8_t>& out, const Mate& self, double now_s);
std::optional<Mate> read_packet(std::span<const std::uint8_t> bytes, double now_s);

}  // namespace sandlot::controllers::soccer_player
