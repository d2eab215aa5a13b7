#include "controllers/soccer_player/roles.h"

#include <algorithm>
#include <array>

#include "controllers/soccer_player/aims.h"
#include "controllers/soccer_player/tracking.h"

namespace sandlot::controllers::soccer_player {
namespace {

constexpr double keeps_role_s = 0.5, keeps_role_at_piece_s = 4;
constexpr double keeps_place_m2 = 1, keeps_place_at_piece_m2 = 9;

constexpr double no_second_touch_s = 8;
/// Who has passed leaves the ball to the receiver for a while.
constexpr double after_pass_s = 1.5, after_pass_cost_s = 1.5;
/// A ball that comes is awaited: this long before it is there the player is.
constexpr double early_s = 0.2;

/// Places of those that do not have the ball, the most urgent first.
std::array<Vec3, 3> places(const Scene& scene) {
  const double gx = scene.goal_x(), wy = 0.5 * scene.field.width_m;
  const Vec3 ball = scene.ball, goal{-gx, 0, 0};
  const double side = scene.side;
  Vec3 support{std::clamp(ball.x + (ball.x > 0.45 * gx ? -0.5 : 2.5), -1.5, gx - 3.0),
               std::clamp(ball.y + 4.0 * side, 1.2 - wy, wy - 1.2), 0};
  Vec3 cover = goal + scene.style.line * (ball - goal);
  cover.x = std::max(cover.x, -gx + 1.3);
  Vec3 back = goal + 0.7 * scene.style.line * (ball - goal);
  back.y = 0.3 * back.y + 1.9 * side;
  back.x = std::clamp(back.x, -gx + scene.field.penalty_area_depth_m + 0.6, 0.2 * gx);
  if (scene.style.pressers > 0 && ball.x > -0.2 * gx)  // a second one stays near, goal side
    cover = ball + 1.3 * normalised(goal - ball);
  if (!scene.style.places) {  // where they began, about
    support = {-1.5, 3.0 * side, 0};
    cover = {-0.5 * gx, -1.5, 0};
    back = {-0.5 * gx, 1.5, 0};
  }
  return {support, cover, back};
}

}  // namespace

double time_for(const Keys& keys, double way_m, double speed_mps) {
  const double v = keys.speed_mps, a = keys.acceleration_mps2, u = std::clamp(speed_mps, -v, v);
  const double fast = way_m - (v * v - u * u) / (2 * a);
  if (fast > 0) return (v - u) / a + fast / v;
  return (std::sqrt(u * u + 2 * a * std::max(0.0, way_m)) - u) / a;
}

Meeting meet(const Scene& scene) {
  const auto time_to = [&](Vec3 at) {
    const Vec3 off = flat(at - scene.me);
    return time_for(*scene.keys, norm(off) - scene.keys->front_m, dot(scene.velocity, normalised(off)));
  };
  Vec3 at = scene.ball;
  for (int k = 0; k <= 24; ++k) {
    const double t = 0.125 * k;
    at = ball_after(scene.ball, scene.ball_velocity, t);
    if (time_to(at) <= std::max(0.05, t - early_s)) return {at, t};
    if (dot(scene.ball_velocity, scene.ball_velocity) < 0.01) break;
  }
  return {at, time_to(at)};
}

double cost_of(const Scene& scene, const Memory& memory) {
  if (!scene.ball_known) return 50;
  if (scene.holds) return 0;
  if (scene.game.piece != Piece::none && !scene.open)
    return time_for(*scene.keys, norm(scene.ball - scene.me), 0) + (memory.taken ? no_second_touch_s : 0);
  const Meeting meeting = meet(scene);
  const Vec3 goal{scene.goal_x(), 0, 0};
  const Vec3 to_goal = normalised(goal - meeting.at), from_me = normalised(meeting.at - scene.me);
  double cost = meeting.after_s + 0.5 * (1 - dot(to_goal, from_me));
  if (memory.taken) cost += no_second_touch_s;
  if (scene.now_s - memory.passed_s < after_pass_s) cost += after_pass_cost_s;
  return cost;
}

Task task_of(const Scene& scene, const Memory& memory, double own_cost_s) {
  Task task;
  if (scene.is_keeper()) {
    task.role = Role::keeper;
    return task;
  }
  // Field players by number; the own one is among them.
  struct Player {
    std::int32_t number;
    Vec3 at;
    double cost_s;
    Role role;
  };
  const bool piece = scene.game.piece != Piece::none && !scene.open;
  const double keeps_s = piece ? keeps_role_at_piece_s : keeps_role_s,
               keeps_m2 = piece ? keeps_place_at_piece_m2 : keeps_place_m2;
  std::array<Player, most_mates + 1> players{};
  std::size_t count = 0;
  players[count++] = {scene.number, scene.me,
                      own_cost_s - (memory.role == Role::attacker && !memory.taken ? keeps_s : 0),
                      memory.role};
  for (const Mate& mate : scene.mates)
    if (mate.number != scene.keys->keeper && mate.number != scene.number && count < players.size())
      players[count++] = {mate.number, mate.at, mate.cost_s - (mate.role == Role::attacker ? keeps_s : 0),
                          mate.role};
  std::sort(players.begin(), players.begin() + static_cast<std::ptrdiff_t>(count),
            [](const Player& a, const Player& b) {
              return a.cost_s != b.cost_s ? a.cost_s < b.cost_s : a.number < b.number;
            });
  if (players[0].number == scene.number) {
    task.role = Role::attacker;
    task.target = scene.ball;
    return task;
  }
  constexpr std::array<Role, 3> roles{Role::supporter, Role::defender, Role::sweeper};
  const std::array<Vec3, 3> spots = places(scene);
  // The others, by number, so that all solve the same.
  std::sort(players.begin() + 1, players.begin() + static_cast<std::ptrdiff_t>(count),
            [](const Player& a, const Player& b) { return a.number < b.number; });
  const std::size_t others = std::min<std::size_t>(count - 1, spots.size());
  std::array<std::size_t, 3> order{0, 1, 2}, best = order;
  double least = 1e18;
  do {
    double sum = 0;
    for (std::size_t i = 0; i < others; ++i) {
      const Vec3 off = players[1 + i].at - spots[order[i]];
      sum += dot(off, off) + (order[i] >= others ? 1e6 : 0);  // places in their order of urgency
      if (players[1 + i].role == roles[order[i]]) sum -= keeps_m2;
    }
    if (sum < least - 1e-9) least = sum, best = order;
  } while (std::next_permutation(order.begin(), order.end()));
  for (std::size_t i = 0; i < count - 1; ++i)
    if (players[1 + i].number == scene.number) {
      task.place = i < others ? static_cast<int>(best[i]) + 1 : 3;
      task.role = roles[static_cast<std::size_t>(task.place - 1)];
      task.target = spots[static_cast<std::size_t>(task.place - 1)];
      if (task.place == 1 && scene.style.offers && !piece) task.target = free_place(scene, task.target);
      if (i >= others) task.target.y -= 1.5 * static_cast<double>(i - others + 1);
    }
  return task;
}

Vec3 legal(const Scene& scene, Vec3 place, const Task& task, double room_m) {
  const double gx = scene.goal_x(), wy = 0.5 * scene.field.width_m;
  const auto& f = scene.field;
  if (room_m > 0) {
    const Vec3 off = flat(place - scene.ball);
    const double distance = norm(off);
    if (distance < room_m) {
      const Vec3 home = normalised(Vec3{-gx, 0, 0} - scene.ball);
      place = scene.ball + room_m * (distance > 0.2 ? (1 / distance) * off : home);
      // Not beyond a line: along it instead.
      if (std::abs(place.y) > wy || std::abs(place.x) > gx) place = scene.ball + room_m * home;
    }
  }
  place.x = std::clamp(place.x, 0.3 - gx, gx - 0.3);
  place.y = std::clamp(place.y, 0.2 - wy, wy - 0.2);
  constexpr double margin = 0.4;
  const auto out_of = [&](double side, double depth, double half_width) {
    const double inner = gx - depth - margin;
    if (side * place.x > inner && std::abs(place.y) < half_width + margin) place.x = side * inner;
  };
  const bool may_own = task.place == 2, may_theirs = task.role == Role::attacker;
  out_of(-1, may_own || task.role == Role::attacker ? f.goal_area_depth_m : f.penalty_area_depth_m,
         0.5 * (may_own || task.role == Role::attacker ? f.goal_area_width_m : f.penalty_area_width_m));
  out_of(1, may_theirs ? f.goal_area_depth_m : f.penalty_area_depth_m,
         0.5 * (may_theirs ? f.goal_area_width_m : f.penalty_area_width_m));
  return place;
}

}  // namespace sandlot::controllers::soccer_player
