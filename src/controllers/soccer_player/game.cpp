#include "controllers/soccer_player/game.h"

#include <utility>

namespace sandlot::controllers::soccer_player {
namespace {

constexpr std::pair<std::string_view, Piece> pieces[] = {
    {"kickoff", Piece::kickoff},          {"throw_in", Piece::throw_in},   {"corner", Piece::corner},
    {"goal_kick", Piece::goal_kick},      {"free_kick", Piece::free_kick}, {"penalty", Piece::penalty},
    {"dropped_ball", Piece::dropped_ball}};
constexpr std::pair<std::string_view, Piece> words[] = {
    {"KICKOFF", Piece::kickoff},       {"THROWIN", Piece::throw_in},   {"CORNER", Piece::corner},
    {"GOALKICK", Piece::goal_kick},    {"FREEKICK", Piece::free_kick}, {"PENALTY", Piece::penalty},
    {"DROP_BALL", Piece::dropped_ball}};

Whose whose(std::string_view of, std::string_view team) {
  if (of.empty()) return Whose::nobodys;
  return of == team ? Whose::ours : Whose::theirs;
}

void go_to(Game& game, Phase phase, Piece piece, Whose side, Vec3 ball, double now_s) {
  if (game.phase == phase && game.piece == piece && game.whose == side) return;
  // The same set piece goes on from preparing to running: the spot is where the ball was when it was allowed.
  if (game.phase != phase || phase != Phase::running) {
    game.since_s = now_s;
    game.spot = flat(ball);
  }
  game.phase = phase;
  game.piece = piece;
  game.whose = side;
}

}  // namespace

void hear_state(Game& game, const msg::RefereeState& state, std::string_view team, Vec3 ball, double now_s) {
  Phase phase = Phase::stopped;
  if (state.phase == "running") phase = Phase::running;
  else if (state.phase == "preparing") phase = Phase::preparing;
  if (state.stage == "half_time" || state.stage == "ended") phase = Phase::stopped;
  Piece piece = Piece::none;
  for (const auto& [name, each] : pieces)
    if (state.set_piece == name) piece = each;
  if (phase == Phase::running && state.in_play) piece = Piece::none;
  go_to(game, phase, piece, whose(state.team, team), ball, now_s);
  for (const msg::RefereeTeam& each : state.teams)
    if (each.name == team) game.positive = each.attacks_positive_x;
}

void hear_command(Game& game, const msg::RefereeCommand& command, std::string_view team, std::int32_t number,
                  Vec3 ball, double now_s) {
  if (command.sequence != 0 && command.sequence <= game.sequence) return;
  game.sequence = command.sequence;
  const std::string_view word = command.command;
  for (const auto& [name, piece] : words)
    if (word == name) return go_to(game, Phase::preparing, piece, whose(command.team, team), ball, now_s);
  if (word == "START") return go_to(game, Phase::running, game.piece, game.whose, ball, now_s);
  if (word == "STOP" || word == "PARK" || word == "HALF_TIME" || word == "END_PART" || word == "END_GAME")
    return go_to(game, Phase::stopped, Piece::none, Whose::nobodys, ball, now_s);
  const bool me = command.team == team && command.robot == number;
  if (me && (word == "REPAIR" || word == "RED_CARD")) game.out = true;
  if (me && word == "REPAIR_END") game.out = false;
}

void settle(Game& game, Vec3 ball) {
  if (game.phase != Phase::preparing) return;
  const Vec3 off = flat(ball) - game.spot;
  game.spot += (dot(off, off) > 0.09 ? 1.0 : 0.1) * off;
}

bool is_open(const Game& game, Vec3 ball, double now_s) {
  if (game.phase != Phase::running) return false;
  if (game.piece == Piece::none) return true;
  // Less may be an error of who sees it from far away.
  constexpr double moved_m = 0.6;
  const Vec3 moved = flat(ball) - game.spot;
  return dot(moved, moved) > moved_m * moved_m ||
         now_s - game.since_s > (game.piece == Piece::penalty ? 10 : 7);
}

}  // namespace sandlot::controllers::soccer_player
