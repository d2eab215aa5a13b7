#include <fmt/format.h>

#include "validation/world.h"

namespace sandlot::validation {
namespace {

/// Gravity on an incline, seen from the incline: down the slope along (cos a, sin a).
Vec3 tilted(double slope_rad, double direction_rad) {
  const double down = g_mps2 * math::sin(slope_rad);
  return {down * math::cos(direction_rad), down * math::sin(direction_rad), -g_mps2 * math::cos(slope_rad)};
}

/// Speed of a block of friction 0.5 after a second on a slope.
double speed_after_1s(double slope_rad, double direction_rad, double h_s) {
  test::World w = world("rigid", tilted(slope_rad, direction_rad));
  w.add(test::ground(surface(0.5)));
  const InstanceId id = w.add(
      test::body_of("block", Box{{0.3, 0.3, 0.1}}, 2, {{0, 0, 0.05}, {}}, surface(0.5), true));
  w.run(static_cast<int>(std::lround(1 / h_s)), h_s);
  return norm(w.state(id).V_WB.linear);
}

void inclines(Section& s) {
  Figure figure{"incline",
                "A block on a slope, friction 0.5: speed after 1 s",
                {"tangent of the slope", "along an edge", "diagonally", "closed form"},
                {"1", "m/s", "m/s", "m/s"},
                {{}, {}, {}, {}}};
  for (double tangent = 0.4; tangent < 0.8; tangent += 0.02) {
    const double slope = math::atan2(tangent, 1);
    figure.columns[0].push_back(tangent);
    figure.columns[1].push_back(speed_after_1s(slope, 0, 0.002));
    figure.columns[2].push_back(speed_after_1s(slope, math::pi / 4, 0.002));
    figure.columns[3].push_back(std::max(0.0, g_mps2 * (math::sin(slope) - 0.5 * math::cos(slope))));
  }
  s.figures.push_back(figure);
  for (const auto& [name, direction] : {std::pair{"along an edge", 0.0}, {"diagonally", math::pi / 4}}) {
    double holds = 0.3, slides = 0.8;
    while (slides - holds > 1e-4) {
      const double middle = 0.5 * (holds + slides);
      (speed_after_1s(math::atan2(middle, 1), direction, 0.002) > 0.03 ? slides : holds) = middle;
    }
    // 0.03 m/s after 1 s are reached a little above the limit: tan a - mu = 0.03 / (g cos a).
    const double cosine = math::cos(math::atan2(0.5, 1));
    s.rows.push_back({fmt::format("block on a slope, friction 0.5, {}: tangent at which it slides", name),
                      "rigid, 2 ms", "1", slides, 0.5 + 0.03 / (g_mps2 * cosine), 0.002});
    const double steep = math::atan2(0.7, 1);
    s.rows.push_back({fmt::format("the same at tangent 0.7, {}: speed after 1 s", name), "rigid, 2 ms", "m/s",
                      speed_after_1s(steep, direction, 0.002),
                      g_mps2 * (math::sin(steep) - 0.5 * math::cos(steep)), 0.005});
  }
  const double gentle = math::atan2(0.4, 1);
  s.rows.push_back({"at 80 % of the limit: creep", "rigid, 2 ms", "mm/s",
                    1000 * speed_after_1s(gentle, math::pi / 4, 0.002), 0, 0.01, false});
  // A ball that rolls down: a = 5/7 g sin.
  test::World w = world("rigid", tilted(0.2, 0));
  w.add(test::ground(surface(0.5)));
  const InstanceId id = w.add(test::body_of("ball", Sphere{0.1}, 1, {{0, 0, 0.1}, {}}, surface(0.5), true));
  w.run(500, 0.002);
  s.rows.push_back({"ball rolling down a slope of 0.2 rad: speed after 1 s", "rigid, 2 ms", "m/s",
                    w.state(id).V_WB.linear.x, 5.0 / 7 * g_mps2 * math::sin(0.2), 0.002});
}

void sliding(Section& s) {
  for (const char* engine : engine_names) {
    constexpr double h_s = 0.002, mu = 0.4, v_mps = 2;
    const std::string where = fmt::format("{}, 2 ms", engine);
    const auto block = [&](test::World& w) {
      w.add(test::ground(surface(mu)));
      return w.add(test::body_of("block", Box{{0.3, 0.3, 0.1}}, 2, {{0, 0, 0.05}, {}}, surface(mu)));
    };
    test::World w = world(engine);
    const InstanceId id = block(w);
    w.run(1, h_s);
    kick(w, id, 2, {v_mps, 0, 0}, h_s);
    w.run(1000, h_s);
    // The kick is a force against which friction works already: mu g h of the speed is gone.
    const double start_mps = v_mps - mu * g_mps2 * h_s;
    s.rows.push_back({"block kicked to 2 m/s, friction 0.4: way to rest", where, "m", w.state(id).X_WB.p.x,
                      start_mps * start_mps / (2 * mu * g_mps2) + start_mps * h_s / 2, 0.01});
    test::World pushed = world(engine);
    const InstanceId box = block(pushed);
    for (int i = 0; i < 500; ++i) {
      pushed.push(box, {1.5 * mu * 2 * g_mps2, 0, 0});
      pushed.run(1, h_s);
    }
    s.rows.push_back({"block pushed with 1.5 mu m g for 1 s: speed", where, "m/s",
                      pushed.state(box).V_WB.linear.x, 0.5 * mu * g_mps2, 0.01});
    test::World held = world(engine);
    const InstanceId stays = block(held);
    for (int i = 0; i < 500; ++i) {
      held.push(stays, {0.9 * mu * 2 * g_mps2 * std::sqrt(0.5), 0.9 * mu * 2 * g_mps2 * std::sqrt(0.5), 0});
      held.run(1, h_s);
    }
    s.rows.push_back({"block pushed obliquely with 0.9 mu m g for 1 s: way", where, "mm",
                      1000 * norm(held.state(stays).X_WB.p - Vec3{0, 0, held.state(stays).X_WB.p.z}), 0, 0.05,
                      false});
  }
}

void at_rest(Section& s) {
  constexpr double h_s = 0.004, edge_m = 0.2;
  test::World w = world("rigid");
  w.add(test::ground(surface(0.5)));
  std::vector<InstanceId> boxes;
  for (int i = 0; i < 10; ++i)
    boxes.push_back(w.add(test::body_of(fmt::format("box{}", i), Box{{edge_m, edge_m, edge_m}}, 1,
                                        {{0, 0, edge_m * (i + 0.5)}, {}}, surface(0.5))));
  w.run(2500, h_s);
  double moved_mm = 0;
  for (std::size_t i = 0; i < boxes.size(); ++i)
    moved_mm = std::max(moved_mm, 1000 * norm(w.state(boxes[i]).X_WB.p -
                                              Vec3{0, 0, edge_m * (static_cast<double>(i) + 0.5)}));
  s.rows.push_back(
      {"ten boxes on each other for 10 s: farthest move", "rigid, 4 ms", "mm", moved_mm, 0, 1, false});
}

}  // namespace

Section friction() {
  Section s{"friction",
            "Friction and rest",
            "Coulomb's law: a block on a slope holds up to the tangent mu whatever way it points (ODE's own "
            "pyramid of "
            "friction would hold up to 1.41 mu on the diagonal), slides with g (sin - mu cos), and a ball "
            "rolls with "
            "5/7 g sin. On flat ground a kicked block slides v^2 / (2 mu g).",
            {},
            {}};
  inclines(s);
  sliding(s);
  at_rest(s);
  return s;
}

}  // namespace sandlot::validation
